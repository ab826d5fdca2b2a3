#pragma once

// Lists of results as .txt and .csv hold them: rows of words, each row in a section.
//
//     section    columns of .csv                             row of .txt
//                kind  vertex  face  a  b  c  d  toi  start
//     vf         vf    7       1                 0.5  0       vf 7 1 0.5 0
//     ee         ee                  0  7  2  9  0    1       ee 0 7 2 9 0 1

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "io/bytes/sink.h"
#include "io/bytes/source.h"

namespace crumple::io {

/// Id of a triangle, a vertex and so on: "17", or "1:17" for id 17 of body 1.
struct ListId {
    std::int32_t index = 0;
    std::optional<std::int32_t> body = {};
};
using ListValue = std::variant<ListId, double, bool, std::string_view>;

enum class FieldType : std::uint8_t { id, id_of_body, number, flag, word };

/// Description of one value in the rows of a section.
struct ListField {
    FieldType type;
    std::size_t column;              ///< index of its column in .csv, from 0
    std::string_view noun = {};      ///< names an id in messages: "face"
    bool is_written_as_text = true;  ///< false: .txt omits it
    bool may_be_nan = false;         ///< for numbers: an empty cell of a .csv means NaN
};

struct ListSection {
    std::string_view keyword;  ///< first word of its rows; empty if the table has one section
    std::vector<ListField> fields;
};

struct RowTable {
    std::vector<std::string> columns;  ///< heading of the .csv; the column of keywords, if any, is first
    std::vector<ListSection> sections;
    std::size_t may_lack = 0;    ///< number of fields at the end of a row that may be missing
    bool may_have_more = false;  ///< readers ignore words after the last field; .txt may have commas between words
};

/// Writer of rows as .txt or .csv. `table` must outlive it.
class RowWriter {
   public:
    RowWriter(std::ostream& out, const RowTable& table, bool csv) : sink_(out), table_(table), csv_(csv) {}

    void write_heading();
    /// Writes a row: the values of the section's fields, in order. The last fields may have no value.
    void add(std::size_t section, std::span<const ListValue> values);

   private:
    Sink sink_;
    const RowTable& table_;
    bool csv_;
    std::vector<const ListValue*> cells_;  ///< scratch: values of the cells of a row; null: an empty cell
};

/// Returns the text of a .csv cell. Puts it in quotes if it has a comma, a quote or a line end, or a blank at either
/// end.
std::string csv_cell(std::string_view text);

/// Callback that consumes a row that has been read. Returns a message that says what is wrong with the row, or an empty
/// text.
using ConsumeRow = std::function<std::string(std::size_t section, std::span<const ListValue> values)>;

/// Read all rows. Throw Error (format) that names the line.
void read_txt_rows(const Source& source, const RowTable& table, const ConsumeRow& take);
void read_csv_rows(const Source& source, const RowTable& table, const ConsumeRow& take);

}  // namespace crumple::io
