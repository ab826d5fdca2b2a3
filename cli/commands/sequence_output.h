#pragma once

// Outputs of a sequence: a table with a row a frame, and coloured frames.

#include <cstddef>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "cli/search.h"
#include "crumple/impacts.h"
#include "crumple/io.h"
#include "io/bytes/atomic_file.h"

namespace crumple::cli {

/// Rows of a table, as CSV or JSON, each written out at once. A file appears when it is finished, and only then.
class Table {
   public:
    /// A file. `impacts`: rows are of steps from one frame to the next.
    Table(const std::string& path, bool json, bool impacts) : path_(path), json_(json), impacts_(impacts) {}
    /// A stream, which must outlive the table.
    Table(std::ostream& out, bool json, bool impacts) : out_(&out), json_(json), impacts_(impacts) {}

    /// `first`: of a step, else ignored. Throws Error (file) if the file cannot be made.
    void add(const std::string& frame, const Statistics& statistics, const FirstImpact& first = {});
    /// True if everything could be written so far.
    bool well() const { return !out_ || *out_; }
    /// Throws Error (file) if the file could not be written. A table without rows is none.
    void finish();
    /// After a failure: what a stream was given becomes a table, and a file stays as it was.
    void give_up();

   private:
    std::string path_;  ///< empty: a stream
    std::unique_ptr<io::AtomicFile> file_;
    std::ostream* out_ = nullptr;
    void end_rows();

    bool json_, impacts_;
    std::size_t count_ = 0;
};

/// Coloured frames: .ply and .obj files are numbered and written at once, a .glb holds all of them and is written at
/// the end. Throws as io::write_coloured and io::ColouredAnimation do.
class Pictures {
   public:
    /// Files, and an animation to a stream, which may be null and must outlive the pictures.
    Pictures(const std::vector<std::string>& outputs, std::ostream* stream, std::size_t frames);

    void add(const Input& input, const Intersections& found);
    /// Writes what has been added, unless that is nothing.
    void finish();

   private:
    std::vector<std::string> numbered_, animated_;
    std::ostream* stream_;
    std::size_t frames_, count_ = 0;
    std::optional<io::ColouredAnimation> animation_;
};

}  // namespace crumple::cli
