#pragma once

// Lists of results as .txt and .csv hold them: rows of words, each of a section.
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

/// Number of a triangle, a vertex and so on: "17", or "1:17" of body 1.
struct ListId {
    std::int32_t index = 0;
    std::optional<std::int32_t> body = {};
};
using ListValue = std::variant<ListId, double, bool, std::string_view>;

enum class FieldType : std::uint8_t { id, id_of_body, number, flag, word };

/// One value of a section's rows.
struct ListField {
    FieldType type;
    std::size_t column;              ///< place in a row of .csv
    std::string_view noun = {};      ///< names an id in messages: "face"
    bool is_written_as_text = true;  ///< else .txt goes without it
    bool may_be_nan = false;         ///< of a number: NaN is an empty cell of a .csv
};

struct ListSection {
    std::string_view keyword;  ///< first word of its rows; empty if there is no other section
    std::vector<ListField> fields;
};

struct RowTable {
    std::vector<std::string> columns;  ///< heading of the .csv; those of keywords come first
    std::vector<ListSection> sections;
    std::size_t may_lack = 0;    ///< rows without so many of their last fields are read
    bool may_have_more = false;  ///< what follows the fields is not read, and text may have commas between words
};

/// Writes rows as .txt or .csv. `table` must outlive it.
class RowWriter {
   public:
    RowWriter(std::ostream& out, const RowTable& table, bool csv) : sink_(out), table_(table), csv_(csv) {}

    void write_heading();
    /// Values of the section's fields, in their order; the last ones may be missing.
    void add(std::size_t section, std::span<const ListValue> values);

   private:
    Sink sink_;
    const RowTable& table_;
    bool csv_;
    std::vector<const ListValue*> cells_;  ///< values of a row; null: an empty cell
};

/// A cell of a .csv: in quotes where a comma, a quote, an end of a line or a blank at either end would be misread.
std::string csv_cell(std::string_view text);

/// Takes a row that has been read, and returns what is wrong with it, or nothing.
using TakeRow = std::function<std::string(std::size_t section, std::span<const ListValue> values)>;

/// Read all rows. Throw Error (format) that names the line.
void read_txt_rows(const Source& source, const RowTable& table, const TakeRow& take);
void read_csv_rows(const Source& source, const RowTable& table, const TakeRow& take);

}  // namespace crumple::io
