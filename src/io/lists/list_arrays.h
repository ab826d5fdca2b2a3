#pragma once

// Lists of results as .json and .npz hold them: named arrays, whose rows all have the same number of values.
//
//     name              type      width   ids
//     vertex_faces      int32     2       vertex, face
//     vertex_face_toi   float64   1
//     edges             int32     2       vertex, vertex

#include <array>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/sink.h"
#include "io/bytes/source.h"

namespace crumple::io {

enum class NumberType : std::uint8_t { int32, int64, float64, uint8 };

/// Calls use(zero), with a zero of the C++ type for `type`.
template <class Use>
void with_number_of(NumberType type, Use use) {
    if (type == NumberType::int32) return use(std::int32_t{});
    if (type == NumberType::int64) return use(std::int64_t{});
    if (type == NumberType::float64) return use(double{});
    use(std::uint8_t{});
}

/// Description of one array. Integers of 32 and 64 bits are ids, at most two per row; readers refuse ids below 0 or
/// above INT32_MAX.
struct ListArray {
    std::string name;
    NumberType type = NumberType::int32;
    std::size_t width = 1;                       ///< numbers per row
    std::array<std::string_view, 2> nouns = {};  ///< name the ids of a row in messages
    std::string_view row_noun = {};              ///< names a row in messages: "pair"
    bool integers_only = false;                  ///< ids that are not stored as integers are refused
    bool may_be_nan = false;                     ///< null in .json means NaN if true, infinity if false

    bool has_ids() const { return type == NumberType::int32 || type == NumberType::int64; }
};

/// Array to be written, or another member of a .json file.
struct ListMember : ListArray {
    const void* data = nullptr;
    std::size_t rows = 0;
    bool in_json = true;
    std::function<void(Sink&)> write_json = {};  ///< writes the value of a member of .json only
    std::shared_ptr<const void> owner = {};      ///< keeps `data` alive if it was made for writing
};

/// Returns the array with `rows` as its data, which are not copied: they must outlive the array.
template <class Row>
ListMember with_rows(ListArray array, std::span<const Row> rows, bool in_json = true) {
    return {std::move(array), rows.data(), rows.size(), in_json};
}
inline ListMember json_member(std::string name, std::function<void(Sink&)> write) {
    return {{std::move(name)}, nullptr, 0, true, std::move(write)};
}

void write_list_json(std::ostream& out, std::span<const ListMember> members);
void write_list_npz(std::ostream& out, std::span<const ListMember> members);

/// Contents of an array that was read: ids, or other numbers.
struct ArrayNumbers {
    std::vector<std::int32_t> ids;
    std::vector<double> numbers;
};
using NumbersByName = std::map<std::string, ArrayNumbers, std::less<>>;

/// Read the arrays of `arrays` that the file has, and ignore all others. Throw Error (format) if values are of another
/// type or shape, or if ids are out of range; the message names the array and the row, or the byte.
NumbersByName read_list_json(const Source& source, std::span<const ListArray> arrays);
NumbersByName read_list_npz(const Source& source, std::span<const ListArray> arrays);
/// Reads a .npy file, which holds one array. `array` describes it.
NumbersByName read_list_npy(const Source& source, const ListArray& array);

/// Checks and stores the numbers of an array, one by one.
class ArrayChecker {
   public:
    /// All arguments must outlive the checker.
    ArrayChecker(const Source& source, const ListArray& array, ArrayNumbers& to);

    void add(double number);
    /// Returns how many numbers have been added.
    std::size_t count() const { return count_; }
    const ListArray& array() const { return array_; }
    /// Throws Error (format) that names the source.
    [[noreturn]] void fail(const std::string& what) const;

   private:
    const Source& source_;
    const ListArray& array_;
    ArrayNumbers& to_;
    std::size_t count_ = 0;
};

/// Names a row in messages: `row 7 of "edges"`, `pair 7`.
std::string row_name(const ListArray& array, std::size_t row);

}  // namespace crumple::io
