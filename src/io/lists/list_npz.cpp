// Writes and reads arrays of NumPy: a zip archive of .npy files, or one such file.

#include <optional>

#include "io/bytes/bytes.h"
#include "io/bytes/npy.h"
#include "io/bytes/npz.h"
#include "io/lists/list_arrays.h"

namespace crumple::io {
namespace {

template <class T>
void read_numbers(const std::string& bytes, const NpyHeader& header, ArrayChecker& to) {
    const std::size_t count = bytes.size() / sizeof(T), width = to.array().width, rows = count / width;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t place = header.by_column ? i % width * rows + i / width : i;
        to.add(static_cast<double>(load<T>(bytes.data() + place * sizeof(T), header.byte_order)));
    }
}

/// Reads an array. `npy` is an NpyFile or an NpzReader::Entry.
template <class Npy>
void read_array(Npy& npy, ArrayChecker& to) {
    const std::size_t width = to.array().width;
    const auto fail = [&](const std::string& what) { to.fail("the array '" + to.array().name + "' " + what); };
    const std::optional<NpyHeader> header = read_npy_header(npy);
    if (!header) return fail("is not a NumPy array");
    const std::string& kind = header->kind;
    const std::vector<std::int64_t>& shape = header->shape;
    const bool fits =
        width == 1 ? shape.size() == 1 : shape.size() == 2 && shape[1] == static_cast<std::int64_t>(width);
    if (!fits || shape[0] > INT64_MAX / 16)
        return fail("is not of shape (n," + (width == 1 ? "" : ' ' + std::to_string(width)) + ')');
    const auto take = [&]<class Number>(Number) {
        const std::string bytes = npy.read(static_cast<std::size_t>(shape[0]) * width * sizeof(Number));
        if (!npy.at_end()) fail("is longer than its header says");
        read_numbers<Number>(bytes, *header, to);
    };
    if (kind == "i4") return take(std::int32_t{});
    if (kind == "u4") return take(std::uint32_t{});
    if (kind == "i8") return take(std::int64_t{});
    if (kind == "u8") return take(std::uint64_t{});
    if (to.array().integers_only) return fail("does not hold integers of 32 or 64 bits");
    if (kind == "f4") return take(float{});
    if (kind == "f8") return take(double{});
    if (kind == "u1" || kind == "b1") return take(std::uint8_t{});
    fail("does not hold plain numbers");
}

}  // namespace

void write_list_npz(std::ostream& out, std::span<const ListMember> members) {
    NpzWriter archive;
    for (const ListMember& member : members) {
        if (member.write_json) continue;
        with_number_of(member.type, [&]<class Number>(Number) {
            archive.add<Number>(member.name.c_str(), member.data, member.rows, member.width == 1 ? 0 : member.width);
        });
    }
    archive.write(out);
}

NumbersByName read_list_npz(const Source& source, std::span<const ListArray> arrays) {
    NpzReader archive(source);
    NumbersByName found;
    for (const ListArray& array : arrays) {
        NpzReader::Entry entry(archive, array.name);
        if (!entry) continue;
        ArrayChecker to(source, array, found[array.name]);
        read_array(entry, to);
    }
    return found;
}

NumbersByName read_list_npy(const Source& source, const ListArray& array) {
    NpyFile file(source);
    NumbersByName found;
    ArrayChecker to(source, array, found[array.name]);
    read_array(file, to);
    return found;
}

}  // namespace crumple::io
