// Writes and reads arrays as members of one JSON object. Reads by SAX events: a JSON document in memory would take some
// 100 bytes per number.

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/bytes/json.h"
#include "io/lists/list_arrays.h"

namespace crumple::io {
namespace {

template <class Number>
void write_number(Sink& sink, Number number) {
    if constexpr (std::is_integral_v<Number>)
        sink << std::int64_t{number};
    else
        std::isfinite(number) ? sink << number : sink << "null";  // JSON has neither infinity nor NaN
}

void write_array(Sink& sink, const ListMember& array) {
    with_number_of(array.type, [&]<class Number>(Number) {
        const auto* number = static_cast<const char*>(array.data);
        write_json_array(sink, array.rows, [&](std::size_t) {
            if (array.width > 1) sink << '[';
            for (std::size_t i = 0; i < array.width; ++i, number += sizeof(Number)) {
                if (i > 0) sink << ',';
                write_number(sink, load<Number>(number, std::endian::native));
            }
            if (array.width > 1) sink << ']';
        });
    });
}

/// SAX handler that reads arrays that are members of the outermost object.
class ArraysHandler : public nlohmann::json_sax<nlohmann::json> {
   public:
    ArraysHandler(const Source& source, std::span<const ListArray> arrays) : source_(source), arrays_(arrays) {}

    NumbersByName take() { return std::move(found_); }

    bool null() override {
        using Limits = std::numeric_limits<double>;
        return number(inside_ && inside_->array().may_be_nan ? Limits::quiet_NaN() : Limits::infinity());
    }
    bool boolean(bool value) override { return number(value, false); }
    bool number_float(double value, const std::string&) override { return number(value, false); }
    bool number_integer(std::int64_t value) override { return number(static_cast<double>(value)); }
    bool number_unsigned(std::uint64_t value) override { return number(static_cast<double>(value)); }
    bool string(std::string&) override { return other(); }
    bool binary(nlohmann::json::binary_t&) override { return other(); }

    bool start_object(std::size_t) override { return other() && ++depth_; }
    bool end_object() override { return depth_--; }
    bool key(std::string& name) override {
        const auto is_named = [&](const ListArray& array) { return array.name == name; };
        const auto found = std::find_if(arrays_.begin(), arrays_.end(), is_named);
        named_ = depth_ == 1 && found != arrays_.end() ? &*found : nullptr;
        return true;
    }
    bool start_array(std::size_t) override {
        if (inside_ && (depth_ != 2 || width() == 1)) fail();
        row_end_ = inside_ ? inside_->count() + width() : 0;
        if (!inside_ && named_) inside_.emplace(source_, *named_, found_[named_->name]);
        named_ = nullptr;
        return ++depth_;
    }
    bool end_array() override {
        --depth_;
        if (inside_ && depth_ == 2 && inside_->count() != row_end_) fail();
        if (depth_ == 1) inside_.reset();
        row_end_ = 0;
        return true;
    }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception&) override {
        const std::size_t size = source_.text().size();
        source_.fail_at_byte(source_.begin() + std::min(position ? position - 1 : 0, size), "this is not JSON");
    }

   private:
    std::size_t width() const { return inside_->array().width; }
    bool number(double value, bool integer = true) {
        if (!inside_ || (!integer && inside_->array().integers_only)) return other();
        if (width() == 1 ? depth_ != 2 : depth_ != 3 || inside_->count() == row_end_) fail();
        inside_->add(value);
        return true;
    }
    /// Handles a value that this class does not read: fails if it is inside an array that is being read, and ignores it
    /// elsewhere.
    bool other() {
        if (inside_) fail();
        named_ = nullptr;
        return true;
    }
    [[noreturn]] void fail() const {
        const std::size_t row = row_end_ ? row_end_ / width() - 1 : inside_->count() / width();
        const std::string numbers = (width() == 2 ? "two" : std::to_string(width())) + " numbers";
        inside_->fail(row_name(inside_->array(), row) + " is not " +
                      (width() == 1 ? "a number" : "an array of " + numbers));
    }

    const Source& source_;
    std::span<const ListArray> arrays_;
    NumbersByName found_;
    std::size_t depth_ = 0;
    std::size_t row_end_ = 0;             ///< count of numbers when the current row will be complete; 0 outside rows
    const ListArray* named_ = nullptr;    ///< array whose name was the last key, or null
    std::optional<ArrayChecker> inside_;  ///< checks the numbers of the array that has begun
};

}  // namespace

void write_list_json(std::ostream& out, std::span<const ListMember> members) {
    Sink sink(out);
    bool first = true;
    for (const ListMember& member : members) {
        if (!member.in_json) continue;
        sink << (first ? "{\n\"" : ",\n\"") << member.name << "\": ";
        first = false;
        member.write_json ? member.write_json(sink) : write_array(sink, member);
    }
    sink << "\n}\n";
}

NumbersByName read_list_json(const Source& source, std::span<const ListArray> arrays) {
    ArraysHandler handler(source, arrays);
    nlohmann::json::sax_parse(source.begin(), source.end(), &handler);
    return handler.take();
}

}  // namespace crumple::io
