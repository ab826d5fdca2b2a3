// Pairs from JSON: the member `pairs` of the outermost object, an array of arrays of two. Events are read as they come:
// a document would take some 100 bytes a number.

#include <nlohmann/json.hpp>

#include "io/formats.h"
#include "io/lists/pairs.h"

namespace crumple::io {

namespace {

class PairsHandler : public nlohmann::json_sax<nlohmann::json> {
   public:
    explicit PairsHandler(const Source& source) : source_(source) {}

    std::vector<Pair> take() {
        if (!found_) throw Error(ErrorCode::format, source_.name() + ": the outermost object has no array \"pairs\"");
        return std::move(pairs_);
    }

    bool null() override { return other(); }
    bool boolean(bool) override { return other(); }
    bool number_float(double, const std::string&) override { return other(); }
    bool string(std::string&) override { return other(); }
    bool binary(nlohmann::json::binary_t&) override { return other(); }
    bool number_integer(std::int64_t value) override { return number(value); }
    bool number_unsigned(std::uint64_t value) override { return number(value); }

    bool start_object(std::size_t) override {
        other();
        ++depth_;
        return true;
    }
    bool key(std::string& name) override {
        named_ = depth_ == 1 && name == "pairs";
        return true;
    }
    bool end_object() override {
        --depth_;
        return true;
    }
    bool start_array(std::size_t) override {
        if (inside_ && depth_ != 2) fail();
        inside_ = inside_ || named_;
        named_ = false;
        found_ = found_ || inside_;
        ++depth_;
        count_ = 0;
        return true;
    }
    bool end_array() override {
        --depth_;
        if (inside_ && depth_ == 2) {
            if (count_ != 2) fail();
            pairs_.push_back({ids_[0], ids_[1]});
        }
        if (depth_ == 1) inside_ = false;
        return true;
    }
    bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception&) override {
        const std::size_t size = source_.text().size();
        source_.fail_at_byte(source_.begin() + std::min(position ? position - 1 : 0, size), "this is not JSON");
    }

   private:
    template <class Integer>
    bool number(Integer value) {
        if (!inside_) return other();
        const auto index = triangle_index(value);
        if (depth_ != 3 || count_ == 2 || !index) fail();
        ids_[count_++] = *index;
        return true;
    }
    /// What is no number: none of it belongs into a pair.
    bool other() {
        if (inside_) fail();
        named_ = false;
        return true;
    }
    [[noreturn]] void fail() const {
        throw Error(ErrorCode::format,
                    source_.name() + ": pair " + std::to_string(pairs_.size()) + " is not an array of two triangles");
    }

    const Source& source_;
    std::vector<Pair> pairs_;
    std::array<std::int32_t, 2> ids_{};
    std::size_t depth_ = 0, count_ = 0;
    bool named_ = false;   ///< the next value is that of "pairs"
    bool inside_ = false;  ///< of that value, an array
    bool found_ = false;
};

}  // namespace

std::vector<Pair> read_pairs_json(const Source& source) {
    PairsHandler handler(source);
    nlohmann::json::sax_parse(source.begin(), source.end(), &handler);
    return handler.take();
}

}  // namespace crumple::io
