#pragma once

// Conversion of files with different units in one command.

#include <string>

#include "crumple/io.h"

namespace crumple::cli {

/// Unit of the first file that states one, to which the others are converted.
class CommonUnit {
   public:
    /// `strict`: warnings are errors.
    explicit CommonUnit(bool strict) : strict_(strict) {}

    /// Converts the contents of the next file, and prints a note. Warns if only some of the files state a unit. Throws
    /// Error (invalid_argument), also for coordinates that overflow.
    void apply(const std::string& file, io::TriangleMesh& mesh);
    void apply(const std::string& file, io::WorldMesh& world);

   private:
    template <class Mesh>
    void convert(const std::string& file, Mesh& mesh);
    void warn(const std::string& unknown, const std::string& known, io::Unit unit);

    bool strict_;
    std::string file_;     ///< first file with a unit
    std::string unknown_;  ///< first file without one
    io::Unit unit_ = io::Unit::unknown;
    bool warned_ = false;
};

}  // namespace crumple::cli
