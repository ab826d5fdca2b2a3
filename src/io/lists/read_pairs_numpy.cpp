// Pairs from NumPy: a .npy file, or the array `pairs` of a .npz, a zip archive of .npy files, stored or compressed.

#include <optional>

#include "io/bytes/bytes.h"
#include "io/bytes/npy.h"
#include "io/bytes/npz.h"
#include "io/formats.h"
#include "io/lists/pairs.h"

namespace crumple::io {

namespace {

[[noreturn]] void fail(const Source& source, const std::string& what) {
    throw Error(ErrorCode::format, source.name() + ": " + what);
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

/// `entry` is an NpyFile or an NpzReader::Entry.
template <class Npy>
std::vector<Pair> read_npy(const Source& source, Npy& entry) {
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

std::vector<Pair> read_pairs_npy(const Source& source) {
    NpyFile file(source);
    return read_npy(source, file);
}

std::vector<Pair> read_pairs_npz(const Source& source) {
    NpzReader archive(source);
    NpzReader::Entry entry(archive, "pairs");
    if (!entry) fail(source, "the archive has no array 'pairs' that can be read");
    return read_npy(source, entry);
}

}  // namespace crumple::io
