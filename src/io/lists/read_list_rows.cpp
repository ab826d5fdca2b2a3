#include <algorithm>
#include <charconv>
#include <deque>
#include <limits>
#include <utility>

#include "io/bytes/text.h"
#include "io/lists/list_rows.h"

namespace crumple::io {
namespace {

constexpr std::string_view csv_blanks = " \t\r";

/// Removes the integer at the start of a word and returns it; returns nothing if the word starts with no integer.
std::optional<std::int32_t> read_index(std::string_view& word) {
    std::int32_t index = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
    if (error != std::errc() || index < 0) return std::nullopt;
    word.remove_prefix(static_cast<std::size_t>(end - word.data()));
    return index;
}

std::optional<ListId> id_of(std::string_view word, bool may_have_body) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    const auto first = read_index(word);
    if (first && word.empty()) return ListId{*first};
    if (!first || !may_have_body || !word.starts_with(':')) return std::nullopt;
    word.remove_prefix(1);
    const auto second = read_index(word);
    return second && word.empty() ? std::optional(ListId{*second, first}) : std::nullopt;
}

class RowReader {
   public:
    RowReader(const Source& source, const RowTable& table, const ConsumeRow& take)
        : source_(source), table_(table), take_(take) {}

    void read_txt() {
        Scanner in(source_, {.lines = true, .comments = true});
        for (; in.next_line_with_items(); in.skip_line()) {
            line_ = in.position();
            words_.clear();
            while (!in.finished()) {
                std::string_view word = in.rest_of_word();
                if (table_.may_have_more) word = word.substr(0, word.find(','));
                words_.push_back(word);
                in.skip_characters(word.size());
                if (table_.may_have_more) in.skip(',');
            }
            const std::size_t section = section_of(words_[0]);
            take(section, std::span(words_).subspan(has_keywords() ? 1 : 0));
        }
    }

    void read_csv() {
        for (line_ = source_.text_begin(); line_ != source_.end();) {
            const char* const end = end_of_record();
            const std::string_view line(line_, static_cast<std::size_t>(end - line_));
            split(line);
            const bool heading = line_ == source_.text_begin() && is_heading();
            if (!heading && line.find_first_not_of(csv_blanks) != line.npos) parse_csv_row();
            line_ = end == source_.end() ? end : end + 1;
        }
    }

   private:
    [[noreturn]] void fail(const std::string& what) const { source_.fail_at_line(line_, what); }
    bool has_keywords() const { return !table_.sections[0].keyword.empty(); }

    bool is_heading() const {
        if (has_keywords()) return words_[0] == table_.columns[0];
        if (table_.sections[0].fields[0].type == FieldType::word)
            return words_.size() <= table_.columns.size() &&
                   std::equal(words_.begin(), words_.end(), table_.columns.begin());
        return words_[0].find_first_of("+-0123456789") != 0;
    }

    /// Returns the end of the record that begins at the current line. A record whose quoted words contain line ends
    /// continues on later lines.
    const char* end_of_record() const {
        const char *begin = line_, *end = line_;
        for (bool within_quotes = false;; begin = end++) {
            end = std::find(end, source_.end(), '\n');
            within_quotes ^= std::count(begin, end, '"') % 2 == 1;
            if (!within_quotes || end == source_.end()) return end;
        }
    }

    void split(std::string_view line) {
        words_.clear();
        unquoted_.clear();
        for (bool ended = false; !ended;) {
            line.remove_prefix(std::min(line.find_first_not_of(csv_blanks), line.size()));
            const bool quoted = line.starts_with('"');
            if (quoted) read_quoted(line);
            const std::size_t comma = line.find(',');
            std::string_view word = line.substr(0, comma);
            word = word.substr(0, word.find_last_not_of(csv_blanks) + 1);
            if (quoted && !word.empty()) fail(in_quotes(word) + " follows a word in quotes");
            words_.push_back(quoted ? std::string_view(unquoted_.back()) : word);
            ended = comma == line.npos;
            line.remove_prefix(ended ? line.size() : comma + 1);
        }
    }

    /// Removes the quoted word at the start of the line, and appends its text to `unquoted_`. Within the quotes, two
    /// quotes stand for one.
    void read_quoted(std::string_view& line) {
        std::string& word = unquoted_.emplace_back();
        for (line.remove_prefix(1);;) {
            const std::size_t quote = line.find('"');
            if (quote == line.npos) fail("a quote is not closed");
            word += line.substr(0, quote);
            line.remove_prefix(quote + 1);
            if (!line.starts_with('"')) return;
            word += '"';
            line.remove_prefix(1);
        }
    }

    std::size_t section_of(std::string_view word) const {
        if (!has_keywords()) return 0;
        const auto& sections = table_.sections;
        std::string names;
        for (std::size_t i = 0; i < sections.size(); ++i) {
            if (word == sections[i].keyword) return i;
            names += i == 0 ? "" : i + 1 == sections.size() ? " or " : ", ";
            names += sections[i].keyword;
        }
        fail(in_quotes(word) + " is not " + names);
    }

    /// Picks from all columns the words that belong to fields of the row's section, and consumes the row. Words in
    /// other columns are errors.
    void parse_csv_row() {
        const std::size_t section = section_of(words_[0]), most = table_.columns.size();
        const std::size_t least = most - table_.may_lack;
        if (!table_.may_have_more && (words_.size() < least || words_.size() > most))
            fail("the row has " + std::to_string(words_.size()) + " columns instead of " + std::to_string(most));
        picked_.clear();
        for (const ListField& field : table_.sections[section].fields) {
            if (field.column >= words_.size()) break;
            picked_.push_back(std::exchange(words_[field.column], {}));
        }
        for (std::size_t i = has_keywords() ? 1 : 0; i < std::min(most, words_.size()); ++i)
            if (!words_[i].empty()) fail(in_quotes(words_[i]) + " is in a column that this kind does not use");
        take(section, picked_);
    }

    void take(std::size_t section, std::span<const std::string_view> words) {
        const auto& fields = table_.sections[section].fields;
        if (words.size() + table_.may_lack < fields.size()) fail_too_short(section, words.size());
        values_.clear();
        for (std::size_t i = 0; i < std::min(words.size(), fields.size()); ++i)
            values_.push_back(value_of(words[i], fields[i]));
        if (words.size() > fields.size() && !table_.may_have_more)
            fail("unexpected " + in_quotes(words[fields.size()]) + " after the last value");
        const std::string mistake = take_(section, values_);
        if (!mistake.empty()) fail(mistake);
    }

    [[noreturn]] void fail_too_short(std::size_t section, std::size_t words) const {
        const auto& [keyword, fields] = table_.sections[section];
        if (keyword.empty()) fail("a " + std::string(fields[words].noun) + " is missing");
        const auto ids =
            std::count_if(fields.begin(), fields.end(), [](const ListField& f) { return !f.noun.empty(); });
        const bool more = static_cast<std::size_t>(ids) < fields.size();
        fail("`" + std::string(keyword) + "` must be followed by " + std::to_string(ids) + " ids" +
             (more ? " and a number" : ""));
    }

    ListValue value_of(std::string_view word, const ListField& field) const {
        switch (field.type) {
            case FieldType::number:
                if (word.empty() && field.may_be_nan) return std::numeric_limits<double>::quiet_NaN();
                if (const auto number = number_of(word)) return *number;
                fail(in_quotes(word) + " is not a number");
            case FieldType::flag:
                if (word == "0" || word == "1") return word == "1";
                fail(in_quotes(word) + " is neither 0 nor 1");
            case FieldType::word:
                return word;
            case FieldType::id:
            case FieldType::id_of_body:
                break;
        }
        if (const auto id = id_of(word, field.type == FieldType::id_of_body)) return *id;
        fail(in_quotes(word) + " names no " + std::string(field.noun));
    }

    const Source& source_;
    const RowTable& table_;
    const ConsumeRow& take_;
    const char* line_ = nullptr;
    std::vector<std::string_view> words_, picked_;
    std::deque<std::string> unquoted_;  ///< words that stood in quotes
    std::vector<ListValue> values_;
};

}  // namespace

void read_txt_rows(const Source& source, const RowTable& table, const ConsumeRow& take) {
    RowReader(source, table, take).read_txt();
}
void read_csv_rows(const Source& source, const RowTable& table, const ConsumeRow& take) {
    RowReader(source, table, take).read_csv();
}

}  // namespace crumple::io
