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

/// Times of the searches of one frame or step, if it is searched several times.
struct Repeats {
    int count = 1;
    double least = 0, greatest = 0;  ///< milliseconds of the fastest and of the slowest search
};

/// Table as CSV or JSON. Each row is flushed when it is added. A file appears only when finish() is called.
class StatisticsTable {
   public:
    /// Writes to a file. `impacts`: rows are steps from one frame to the next.
    StatisticsTable(const std::string& path, bool json, bool impacts) : path_(path), json_(json), impacts_(impacts) {}
    /// Writes to a stream, which must outlive the table.
    StatisticsTable(std::ostream& out, bool json, bool impacts) : out_(&out), json_(json), impacts_(impacts) {}

    /// Adds a row. `statistics`: those of the search with the median time. `first`: first impact of a step; ignored if
    /// rows are frames. Throws Error (file) if the file cannot be created.
    void add(const std::string& frame, const Statistics& statistics, const Repeats& repeats,
             const FirstImpact& first = {});
    /// True if all rows so far could be written.
    bool is_good() const { return !out_ || *out_; }
    /// Completes the table. Writes nothing if it has no rows. Throws Error (file) if the file could not be written.
    void finish();
    /// Ends the table after a failure: on a stream, makes the rows so far a complete table; leaves a file unchanged.
    void give_up();

   private:
    std::string path_;  ///< empty if the table is written to a stream
    std::unique_ptr<io::AtomicFile> file_;
    std::ostream* out_ = nullptr;
    void end_rows();

    bool json_, impacts_;
    std::size_t count_ = 0;
};

/// Coloured frames. As .ply or .obj, each frame is a numbered file, which add() writes. As .glb, all frames are one
/// animation, which finish() writes. Throws as io::write_coloured and io::ColouredAnimation do.
class Pictures {
   public:
    /// `outputs`: paths of .ply, .obj and .glb files. `stream`: also receives an animation; may be null, otherwise it
    /// must outlive this object. `frames`: number of frames, which determines the digits of file numbers.
    Pictures(const std::vector<std::string>& outputs, std::ostream* stream, std::size_t frames);

    void add(const InputMeshes& input, const Intersections& found);
    /// Writes the animations. Writes nothing if no frame was added.
    void finish();

   private:
    std::vector<std::string> numbered_, animated_;
    std::ostream* stream_;
    std::size_t frames_, count_ = 0;
    std::optional<io::ColouredAnimation> animation_;
};

}  // namespace crumple::cli
