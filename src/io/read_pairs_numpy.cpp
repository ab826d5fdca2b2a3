// Pairs from NumPy: a .npy file, or the array `pairs` of a .npz, a zip archive of .npy files, stored or compressed. A
// .npy file is "\x93NUMPY", a version, the length of a header, the header (a Python dictionary of type, order and
// shape), and the array's bytes.

#include <zip.h>

#include <charconv>
#include <memory>

#include "io/bytes.h"
#include "io/formats.h"
#include "io/pairs.h"

namespace crumple::io {

namespace {

[[noreturn]] void fail(const Source& source, const std::string& what) {
    throw Error(ErrorCode::format, source.name() + ": " + what);
}

/// A .npy file, from the left.
class File {
   public:
    explicit File(const Source& source) : source_(source), place_(source.begin()) {}

    std::string read(std::size_t size) {
        if (size > static_cast<std::size_t>(source_.end() - place_)) fail(source_, "the array is truncated");
        place_ += size;
        return {place_ - size, size};
    }
    bool at_end() const { return place_ == source_.end(); }

   private:
    const Source& source_;
    const char* place_;
};

/// The archive's file `pairs.npy`, from the left.
class Entry {
   public:
    explicit Entry(const Source& source) : source_(source) {
        zip_source_t* const content =
            zip_source_buffer_create(source.begin(), static_cast<zip_uint64_t>(source.text().size()), 0, nullptr);
        if (content) archive_.reset(zip_open_from_source(content, ZIP_RDONLY, nullptr));
        if (!archive_) {
            zip_source_free(content);
            fail(source, "this is not a .npz archive");
        }
        file_.reset(zip_fopen(archive_.get(), "pairs.npy", 0));
        if (!file_) fail(source, "the archive has no array 'pairs' that can be read");
    }

    /// The next `size` bytes. Grows as they come: what the file says of its size may be a lie.
    std::string read(std::size_t size) {
        constexpr std::size_t block = 1 << 20;
        std::string bytes;
        while (bytes.size() < size) {
            const std::size_t before = bytes.size();
            bytes.resize(before + std::min(block, size - before));
            const zip_int64_t got = zip_fread(file_.get(), bytes.data() + before, bytes.size() - before);
            if (got <= 0) fail(source_, "the array 'pairs' is truncated or damaged");
            bytes.resize(before + static_cast<std::size_t>(got));
        }
        return bytes;
    }
    bool at_end() {
        char byte;
        return zip_fread(file_.get(), &byte, 1) == 0;
    }

   private:
    struct Close {
        void operator()(zip_t* archive) const { zip_discard(archive); }
        void operator()(zip_file_t* file) const { zip_fclose(file); }
    };
    const Source& source_;
    std::unique_ptr<zip_t, Close> archive_;
    std::unique_ptr<zip_file_t, Close> file_;
};

/// What follows a key, as "'shape':", in the header.
std::string_view value_of(std::string_view header, std::string_view key) {
    const std::size_t place = header.find(key);
    if (place == header.npos) return {};
    header.remove_prefix(place + key.size());
    return header.substr(std::min(header.find_first_not_of(' '), header.size()));
}

/// Rows of an array of shape (rows, 2); nothing for other shapes.
std::optional<std::size_t> rows_of(std::string_view shape) {
    std::size_t rows = 0;
    const auto [end, error] = std::from_chars(shape.data() + 1, shape.data() + shape.size(), rows);
    const std::string_view rest = shape.substr(static_cast<std::size_t>(end - shape.data()));
    if (error != std::errc() || rows > INT64_MAX / 16 || (!rest.starts_with(", 2)") && !rest.starts_with(",2)")))
        return std::nullopt;
    return rows;
}

template <class Integer>
std::vector<Pair> pairs_from(const Source& source, const std::string& bytes, std::endian order, bool by_column) {
    const std::size_t rows = bytes.size() / (2 * sizeof(Integer));
    const auto read = [&](std::size_t row, std::size_t column) {
        const std::size_t place = by_column ? column * rows + row : 2 * row + column;
        const auto index = triangle_index(load<Integer>(bytes.data() + place * sizeof(Integer), order));
        if (!index) fail(source, "pair " + std::to_string(row) + " names no triangle");
        return *index;
    };
    std::vector<Pair> pairs;
    pairs.reserve(rows);
    for (std::size_t row = 0; row < rows; ++row) pairs.push_back({read(row, 0), read(row, 1)});
    return pairs;
}

/// `entry` is a File or an Entry.
template <class Npy>
std::vector<Pair> read_npy(const Source& source, Npy entry) {
    const std::string prologue = entry.read(8);
    if (!prologue.starts_with("\x93NUMPY") || prologue[6] < 1 || prologue[6] > 3)
        fail(source, "'pairs' is no array of NumPy");
    const std::size_t length = prologue[6] == 1
                                   ? std::size_t{load<std::uint16_t>(entry.read(2).data(), std::endian::little)}
                                   : std::size_t{load<std::uint32_t>(entry.read(4).data(), std::endian::little)};
    const std::string header = entry.read(length);

    const std::string_view type = value_of(header, "'descr':"), shape = value_of(header, "'shape':");
    const std::optional<std::size_t> rows = shape.starts_with('(') ? rows_of(shape) : std::nullopt;
    if (!rows) fail(source, "the array 'pairs' is not of shape (n, 2)");
    const std::endian order = type.starts_with("'>") ? std::endian::big : std::endian::little;
    const std::string_view kind = type.substr(std::min<std::size_t>(2, type.size()), 3);
    const bool by_column = value_of(header, "'fortran_order':").starts_with("True");
    const std::size_t size = kind == "i4'" || kind == "u4'" ? 4 : kind == "i8'" || kind == "u8'" ? 8 : 0;
    if (!size) fail(source, "the array 'pairs' does not hold integers of 32 or 64 bits");

    const std::string bytes = entry.read(*rows * 2 * size);
    if (!entry.at_end()) fail(source, "the array 'pairs' is longer than its header says");
    if (kind == "i4'") return pairs_from<std::int32_t>(source, bytes, order, by_column);
    if (kind == "u4'") return pairs_from<std::uint32_t>(source, bytes, order, by_column);
    if (kind == "i8'") return pairs_from<std::int64_t>(source, bytes, order, by_column);
    return pairs_from<std::uint64_t>(source, bytes, order, by_column);
}

}  // namespace

std::vector<Pair> read_pairs_npy(const Source& source) { return read_npy(source, File(source)); }

std::vector<Pair> read_pairs_npz(const Source& source) { return read_npy(source, Entry(source)); }

}  // namespace crumple::io
