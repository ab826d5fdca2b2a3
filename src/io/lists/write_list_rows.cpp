#include "io/lists/list_rows.h"

namespace crumple::io {
namespace {

void write_value(Sink& sink, const ListId& id) {
    if (id.body) sink << *id.body << ':';
    sink << id.index;
}
void write_value(Sink& sink, double number) { sink << number; }
void write_value(Sink& sink, bool flag) { sink << (flag ? '1' : '0'); }
void write_value(Sink& sink, std::string_view word) { sink << word; }

}  // namespace

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
        if (cell) std::visit([&](const auto& value) { write_value(sink_, value); }, *cell);
        first = false;
    }
    sink_ << '\n';
}

}  // namespace crumple::io
