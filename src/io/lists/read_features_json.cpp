// Impacts, near pairs and candidates from JSON: arrays of numbers, or of rows of two, that are members of the outermost
// object. Events are read as they come: a document would take some 100 bytes a number.

#include <limits>
#include <nlohmann/json.hpp>

#include "io/lists/read_features.h"

namespace crumple::io {

namespace {

class ArraysHandler : public nlohmann::json_sax<nlohmann::json> {
   public:
    ArraysHandler(const Source& source, std::vector<ArrayName> names)
        : source_(source), names_(std::move(names)), arrays_(names_.size()) {}

    const NumberArrays& arrays() const { return arrays_; }

    bool null() override { return number(std::numeric_limits<double>::infinity()); }
    bool boolean(bool value) override { return number(value); }
    bool number_float(double value, const std::string&) override { return number(value); }
    bool number_integer(std::int64_t value) override { return number(static_cast<double>(value)); }
    bool number_unsigned(std::uint64_t value) override { return number(static_cast<double>(value)); }
    bool string(std::string&) override { return other(); }
    bool binary(nlohmann::json::binary_t&) override { return other(); }

    bool start_object(std::size_t) override {
        other();
        ++depth_;
        return true;
    }
    bool key(std::string& name) override {
        named_ = none;
        for (std::size_t i = 0; i < names_.size() && depth_ == 1; ++i)
            if (names_[i].wanted && names_[i].name == name) named_ = i;
        return true;
    }
    bool end_object() override {
        --depth_;
        return true;
    }
    bool start_array(std::size_t) override {
        if (inside_ != none && (depth_ != 2 || names_[inside_].columns == 1)) fail();
        if (inside_ == none && named_ != none) {
            inside_ = std::exchange(named_, none);
            arrays_[inside_].emplace();
        }
        ++depth_;
        count_ = 0;
        return true;
    }
    bool end_array() override {
        --depth_;
        if (inside_ != none && depth_ == 2 && count_ != names_[inside_].columns) fail();
        count_ = 0;
        if (depth_ == 1) inside_ = none;
        return true;
    }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception&) override {
        const std::size_t size = source_.text().size();
        source_.fail_at_byte(source_.begin() + std::min(position ? position - 1 : 0, size), "this is not JSON");
    }

   private:
    static constexpr std::size_t none = SIZE_MAX;

    bool number(double value) {
        if (inside_ == none) return other();
        const std::size_t columns = names_[inside_].columns;
        if (columns == 1 ? depth_ != 2 : depth_ != 3 || count_ == columns) fail();
        arrays_[inside_]->push_back(value);
        ++count_;
        return true;
    }
    /// What is no number: none of it belongs into an array of numbers.
    bool other() {
        if (inside_ != none) fail();
        named_ = none;
        return true;
    }
    [[noreturn]] void fail() const {
        const std::string& name = names_[inside_].name;
        const std::size_t columns = names_[inside_].columns;
        const std::size_t begun = columns == 1 ? 0 : count_;
        const std::size_t row = (arrays_[inside_]->size() - begun) / columns;
        throw Error(ErrorCode::format, source_.name() + ": row " + std::to_string(row) + " of \"" + name + "\" is no " +
                                           (columns == 1 ? "number" : "array of two numbers"));
    }

    const Source& source_;
    std::vector<ArrayName> names_;
    NumberArrays arrays_;
    std::size_t depth_ = 0;
    std::size_t count_ = 0;      ///< numbers of the row
    std::size_t named_ = none;   ///< the next value is that array's
    std::size_t inside_ = none;  ///< of that array
};

}  // namespace

void read_features_json(const Source& source, FeatureRows& rows) {
    ArraysHandler handler(source, arrays_of(rows.words()));
    nlohmann::json::sax_parse(source.begin(), source.end(), &handler);
    add_rows(source, handler.arrays(), rows);
}

}  // namespace crumple::io
