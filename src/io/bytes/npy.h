#pragma once

// NumPy's .npy: "\x93NUMPY", a version, the length of a header, the header (a Python dictionary of type, order and
// shape), and the array's bytes.

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/bytes.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// Sequential reader of a .npy file.
class NpyFile {
   public:
    explicit NpyFile(const Source& source) : source_(source), place_(source.begin()) {}

    std::string read(std::size_t size) {
        if (size > static_cast<std::size_t>(source_.end() - place_))
            throw Error(ErrorCode::format, source_.name() + ": the array is truncated");
        place_ += size;
        return {place_ - size, size};
    }
    bool at_end() const { return place_ == source_.end(); }

   private:
    const Source& source_;
    const char* place_;
};

struct NpyHeader {
    std::endian byte_order;
    std::string kind;  ///< type of an item: "i4", "f8", ...; another text if items are not plain numbers
    bool by_column;    ///< true if the array is in Fortran order: the first index varies fastest
    std::vector<std::int64_t> shape;

    /// Returns the number of items, or nothing if it exceeds int64.
    std::optional<std::int64_t> items() const {
        std::int64_t product = 1;
        for (const std::int64_t size : shape)
            if (__builtin_mul_overflow(product, size, &product)) return std::nullopt;
        return product;
    }
};

/// Returns the text after a key, such as "'shape':", in the header; empty if the key is missing.
inline std::string_view npy_value(std::string_view header, std::string_view key) {
    const std::size_t place = header.find(key);
    if (place == header.npos) return {};
    header.remove_prefix(place + key.size());
    return header.substr(std::min(header.find_first_not_of(' '), header.size()));
}

/// Parses a shape such as "(3, 4)", "(5,)" or "()"; returns nothing for any other text.
inline std::optional<std::vector<std::int64_t>> npy_shape(std::string_view text) {
    std::vector<std::int64_t> shape;
    if (!text.starts_with('(')) return std::nullopt;
    for (text.remove_prefix(1); !text.starts_with(')');) {
        std::int64_t size = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
        if (error != std::errc() || size < 0) return std::nullopt;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        shape.push_back(size);
        if (text.starts_with(','))
            text.remove_prefix(text.starts_with(", ") ? 2 : 1);
        else if (!text.starts_with(')'))
            return std::nullopt;
    }
    return shape;
}

/// Reads the header, and stops before the array's first byte. Returns nothing if this is not a NumPy array. Fields that
/// the file's header lacks are empty in the result. `npy` is an NpyFile or an NpzReader::Entry.
template <class Npy>
std::optional<NpyHeader> read_npy_header(Npy& npy) {
    const std::string prologue = npy.read(8);
    if (!prologue.starts_with("\x93NUMPY") || prologue[6] < 1 || prologue[6] > 3) return std::nullopt;
    const std::size_t length = prologue[6] == 1
                                   ? std::size_t{load<std::uint16_t>(npy.read(2).data(), std::endian::little)}
                                   : std::size_t{load<std::uint32_t>(npy.read(4).data(), std::endian::little)};
    const std::string header = npy.read(length);
    const std::string_view type = npy_value(header, "'descr':");  // begins with "'<f8'", for example
    const std::size_t end = std::min(type.find('\'', 1), type.size());
    return NpyHeader{type.starts_with("'>") ? std::endian::big : std::endian::little,
                     std::string(type.substr(std::min<std::size_t>(2, end), end < 2 ? 0 : end - 2)),
                     npy_value(header, "'fortran_order':").starts_with("True"),
                     npy_shape(npy_value(header, "'shape':")).value_or(std::vector<std::int64_t>())};
}

}  // namespace crumple::io
