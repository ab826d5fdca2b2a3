#include "io/lists/list_rows.h"

#include <cmath>

namespace crumple::io {
namespace {

void write_value(Sink& sink, const ListId& id, bool) {
    if (id.body) sink << *id.body << ':';
    sink << id.index;
}
void write_value(Sink& sink, double number, bool csv) {
    if (!csv || !std::isnan(number)) sink << number;
}
void write_value(Sink& sink, bool flag, bool) { sink << (flag ? '1' : '0'); }
void write_value(Sink& sink, std::string_view word, bool csv) { csv ? sink << csv_cell(word) : sink << word; }

}  // namespace

std::string csv_cell(std::string_view text) {
    constexpr std::string_view blanks = " \t";
    const bool has_blank_end =
        !text.empty() && (blanks.find(text.front()) != blanks.npos || blanks.find(text.back()) != blanks.npos);
    if (!has_blank_end && text.find_first_of(",\"\n\r") == text.npos) return std::string(text);
    std::string cell = "\"";
    for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
    return cell + '"';
}

void RowWriter::write_heading() {
    if (!csv_) return;
    for (std::size_t i = 0; i < table_.columns.size(); ++i) {
        if (i > 0) sink_ << ',';
        sink_ << table_.columns[i];
    }
    sink_ << '\n';
}

void RowWriter::add(std::size_t section, std::span<const ListValue> values) {
    const auto& [keyword, fields] = table_.sections[section];
    cells_.assign(csv_ ? table_.columns.size() : 0, nullptr);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (csv_)
            cells_[fields[i].column] = &values[i];
        else if (fields[i].is_written_as_text)
            cells_.push_back(&values[i]);
    }
    sink_ << keyword;
    bool first = keyword.empty();
    for (const ListValue* const cell : std::span(cells_).subspan(csv_ && !first ? 1 : 0)) {
        if (!first) sink_ << (csv_ ? ',' : ' ');
        if (cell) std::visit([&](const auto& value) { write_value(sink_, value, csv_); }, *cell);
        first = false;
    }
    sink_ << '\n';
}

}  // namespace crumple::io
