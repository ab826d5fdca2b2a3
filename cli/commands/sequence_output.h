#pragma once

// Outputs of a sequence: tables with one row per frame or step, and coloured frames.

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

/// Table as CSV or JSON, whose rows are flushed one by one. A file appears only when it is finished.
class Table {
   public:
    /// Writes to a file. `impacts`: rows are steps from one frame to the next.
    Table(const std::string& path, bool json, bool impacts) : path_(path), json_(json), impacts_(impacts) {}
    /// Writes to a stream, which must outlive the table.
    Table(std::ostream& out, bool json, bool impacts) : out_(&out), json_(json), impacts_(impacts) {}

    /// Adds a row. `first`: first impact of a step; ignored for frames. Throws Error (file) if the file cannot be made.
    void add(const std::string& frame, const Statistics& statistics, const FirstImpact& first = {});
    /// True if everything could be written so far.
    bool well() const { return !out_ || *out_; }
    /// Completes the table; a table without rows is not written. Throws Error (file) if the file could not be written.
    void finish();
    /// Ends the table after a failure: completes the rows on a stream, and leaves a file unchanged.
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
    /// `outputs`: files. `stream`: receives an animation; may be null, and must outlive the pictures.
    Pictures(const std::vector<std::string>& outputs, std::ostream* stream, std::size_t frames);

    void add(const Input& input, const Intersections& found);
    /// Writes the animations, unless no frame was added.
    void finish();

   private:
    std::vector<std::string> numbered_, animated_;
    std::ostream* stream_;
    std::size_t frames_, count_ = 0;
    std::optional<io::ColouredAnimation> animation_;
};

}  // namespace crumple::cli
