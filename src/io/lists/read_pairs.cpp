// Pairs from text and CSV; the format by extension.

#include <algorithm>

#include "base/float_environment.h"
#include "io/bytes/text.h"
#include "io/formats.h"
#include "io/lists/pairs.h"

namespace crumple::io {

namespace {

std::vector<Pair> read_txt(const Source& source) {
    Scanner in(source, {.lines = true, .comments = true});
    const auto read_index = [&] {
        in.finished();
        const char* const place = in.position();
        const std::int64_t written = in.leading_integer("a triangle");
        const auto index = triangle_index(written);
        if (!index) in.fail(place, std::to_string(written) + " names no triangle");
        return *index;
    };
    std::vector<Pair> pairs;
    for (; in.next_line_with_items(); in.skip_line()) {
        const std::int32_t a = read_index();
        if (!in.skip(',')) in.end_word();
        const std::int32_t b = read_index();
        if (!in.skip(',')) in.end_word();
        pairs.push_back({a, b});
    }
    return pairs;
}

/// Fields of one line, from the left.
class CsvLine {
   public:
    CsvLine(const Source& source, std::string_view line) : source_(source), line_(line), rest_(line) {}

    std::int32_t read_index() {
        const std::string_view field = next_field();
        std::int64_t written = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), written);
        const auto index = triangle_index(written);
        if (error != std::errc() || end != field.data() + field.size() || !index) {
            source_.fail_at_line(line_.data(), in_quotes(field) + " names no triangle");
        }
        return *index;
    }

   private:
    std::string_view next_field() {
        if (ended_) source_.fail_at_line(line_.data(), "a triangle is missing");
        const std::size_t comma = rest_.find(',');
        std::string_view field = rest_.substr(0, comma);
        ended_ = comma == rest_.npos;
        rest_.remove_prefix(ended_ ? rest_.size() : comma + 1);
        constexpr std::string_view blanks = " \t\r";
        field.remove_prefix(std::min(field.find_first_not_of(blanks), field.size()));
        return field.substr(0, field.find_last_not_of(blanks) + 1);
    }

    const Source& source_;
    std::string_view line_, rest_;
    bool ended_ = false;
};

std::vector<Pair> read_csv(const Source& source) {
    std::vector<Pair> pairs;
    for (const char* begin = source.text_begin(); begin != source.end();) {
        const char* const end = std::find(begin, source.end(), '\n');
        const std::string_view line(begin, static_cast<std::size_t>(end - begin));
        const std::size_t first = line.find_first_not_of(" \t\r");
        const bool names = begin == source.text_begin() && first != line.find_first_of("+-0123456789");
        if (!names && first != line.npos) {
            CsvLine fields(source, line);
            const std::int32_t a = fields.read_index();
            pairs.push_back({a, fields.read_index()});
        }
        begin = end == source.end() ? end : end + 1;
    }
    return pairs;
}

std::vector<Pair> read(const Source& source) {
    const FloatEnvironment environment;
    const std::string extension = extension_of(source.name());
    try {
        if (extension == ".csv") return read_csv(source);
        if (extension == ".json") return read_pairs_json(source);
        if (extension == ".npy") return read_pairs_npy(source);
        if (extension == ".npz") return read_pairs_npz(source);
        return read_txt(source);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its pairs do not fit in memory");
    }
}

}  // namespace

std::vector<Pair> read_pairs(const std::filesystem::path& path) { return read(Source(path)); }

std::vector<Pair> read_pairs(std::istream& in, const std::string& name) { return read(Source(in, name)); }

}  // namespace crumple::io
