#include "io/lists/list_arrays.h"

#include <cmath>

namespace crumple::io {

ArrayChecker::ArrayChecker(const Source& source, const ListArray& array, ArrayNumbers& to)
    : source_(source), array_(array), to_(to) {
    to_ = {};
}

void ArrayChecker::add(double number) {
    if (!array_.has_ids()) {
        to_.numbers.push_back(number);
    } else if (number >= 0 && number <= INT32_MAX && number == std::floor(number)) {
        to_.ids.push_back(static_cast<std::int32_t>(number));
    } else {
        fail(row_name(array_, count_ / array_.width) +
             (array_.row_noun.empty() ? ": this is not a valid " : " names no ") +
             std::string(array_.nouns[count_ % array_.width]));
    }
    ++count_;
}

void ArrayChecker::fail(const std::string& what) const { throw Error(ErrorCode::format, source_.name() + ": " + what); }

std::string row_name(const ListArray& array, std::size_t row) {
    if (!array.row_noun.empty()) return std::string(array.row_noun) + ' ' + std::to_string(row);
    return "row " + std::to_string(row) + " of \"" + array.name + '"';
}

}  // namespace crumple::io
