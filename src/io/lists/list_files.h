#pragma once

// Writing and reading of lists of results of any kind, in any of the formats.

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "crumple/io.h"
#include "io/bytes/atomic_file.h"
#include "io/lists/list_arrays.h"
#include "io/lists/list_rows.h"

namespace crumple::io {

/// List of results, or a block of such a list. Refers to the result, which must outlive it.
struct ListTable {
    std::string_view what;  ///< names the results in messages: "near pairs"
    RowTable rows;
    std::function<void(RowWriter&)> add_rows;
    std::function<std::vector<ListMember>()> members;
};

/// Write a list as .txt, .csv, .json or .npz. With PairFormat::automatic, the extension of the path selects the format,
/// and a stream receives text. Throw Error (file, invalid_argument).
void write_list(const std::filesystem::path& path, const ListTable& list, PairFormat format);
void write_list(std::ostream& out, const ListTable& list, PairFormat format);

/// Writer of a list, block by block, as .txt or .csv: to a file, which appears at commit(), or to a stream.
class ListWriter {
   public:
    ListWriter(std::string_view what, const RowTable& rows, const std::filesystem::path& path, PairFormat format);
    ListWriter(std::string_view what, const RowTable& rows, std::ostream& out, PairFormat format);

    void add(const ListTable& block);
    void commit();

   private:
    std::string_view what_;
    PairFormat format_;
    std::optional<AtomicFile> file_;
    std::ostream* out_;  ///< the stream of file_, or the caller's
};

/// Description of the table that a file must hold, and the functions that consume its rows or arrays.
struct ListReader {
    RowTable rows;  ///< table of the rows of .txt and .csv
    ConsumeRow consume_row;
    std::vector<ListArray> arrays;  ///< arrays of .json and .npz
    std::function<void(const NumbersByName&)> consume_arrays;
    bool reads_npy = false;  ///< true if .npy files are accepted; they hold arrays[0]
};
/// Reads a list. The extension of the source's name selects the format, text by default. Throws Error (file, format).
void read_list(const Source& source, const ListReader& reader);

}  // namespace crumple::io
