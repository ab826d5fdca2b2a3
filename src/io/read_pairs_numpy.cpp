// Pairs from NumPy: a .npy file, or the array `pairs` of a .npz, a zip archive of .npy files, stored or compressed.

#include <zip.h>

#include <memory>
#include <optional>

#include "io/bytes.h"
#include "io/formats.h"
#include "io/npy.h"
#include "io/pairs.h"

namespace crumple::io {

namespace {

[[noreturn]] void fail(const Source& source, const std::string& what) {
    throw Error(ErrorCode::format, source.name() + ": " + what);
}

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

/// `entry` is an NpyFile or an Entry.
template <class Npy>
std::vector<Pair> read_npy(const Source& source, Npy entry) {
    const std::optional<NpyHeader> header = read_npy_header(entry);
    if (!header) fail(source, "'pairs' is no array of NumPy");
    const auto& [order, kind, by_column, shape] = *header;
    if (shape.size() != 2 || shape[1] != 2 || shape[0] > INT64_MAX / 16)
        fail(source, "the array 'pairs' is not of shape (n, 2)");
    const std::size_t size = kind == "i4" || kind == "u4" ? 4 : kind == "i8" || kind == "u8" ? 8 : 0;
    if (!size) fail(source, "the array 'pairs' does not hold integers of 32 or 64 bits");

    const std::string bytes = entry.read(static_cast<std::size_t>(shape[0]) * 2 * size);
    if (!entry.at_end()) fail(source, "the array 'pairs' is longer than its header says");
    if (kind == "i4") return pairs_from<std::int32_t>(source, bytes, order, by_column);
    if (kind == "u4") return pairs_from<std::uint32_t>(source, bytes, order, by_column);
    if (kind == "i8") return pairs_from<std::int64_t>(source, bytes, order, by_column);
    return pairs_from<std::uint64_t>(source, bytes, order, by_column);
}

}  // namespace

std::vector<Pair> read_pairs_npy(const Source& source) { return read_npy(source, NpyFile(source)); }

std::vector<Pair> read_pairs_npz(const Source& source) { return read_npy(source, Entry(source)); }

}  // namespace crumple::io
