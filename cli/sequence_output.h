#pragma once

// What a sequence leaves behind: a table with a row a frame, and coloured frames.

#include <cstddef>
#include <fstream>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "cli/search.h"
#include "crumple/io.h"

namespace crumple::cli {

/// Rows of a table, as CSV or JSON, each written out at once. Nothing is touched before the first row.
class Table {
   public:
    /// A file.
    Table(const std::string& path, bool json) : path_(path), json_(json) {}
    /// A stream, which must outlive the table.
    Table(std::ostream& out, bool json) : out_(&out), json_(json) {}

    /// Throws Error (file) if the file cannot be opened.
    void add(const std::string& frame, const Statistics& statistics);
    /// Whether everything could be written so far.
    bool well() const { return !out_ || *out_; }
    /// Throws Error (file) if the file could not be written.
    void finish();

   private:
    std::string path_;  ///< empty: a stream
    std::unique_ptr<std::ofstream> file_;
    std::ostream* out_ = nullptr;
    bool json_;
    std::size_t count_ = 0;
};

/// Coloured frames: .ply and .obj files are numbered and written at once, a .glb holds all of them and is written at
/// the end. Throws as io::write_coloured and io::ColouredAnimation do.
class Pictures {
   public:
    Pictures(const std::vector<std::string>& outputs, std::size_t frames);

    void add(const Input& input, const Collisions& found);
    /// Writes what has been added, unless that is nothing.
    void finish();

   private:
    std::vector<std::string> numbered_, animated_;
    std::size_t frames_, count_ = 0;
    std::optional<io::ColouredAnimation> animation_;
};

}  // namespace crumple::cli
