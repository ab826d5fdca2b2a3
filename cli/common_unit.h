#pragma once

// Files of different units in one command.

#include <string>

#include "crumple/io.h"

namespace crumple::cli {

/// The unit of the first file that has one, to which others are converted.
class CommonUnit {
   public:
    /// `strict`: what would be a warning is an error.
    explicit CommonUnit(bool strict) : strict_(strict) {}

    /// Converts what the file holds, in turn, and says so; warns of files that do not say their unit among files that
    /// do. Throws Error (invalid_argument), also for coordinates that overflow.
    void apply(const std::string& file, io::TriangleMesh& mesh);
    void apply(const std::string& file, io::WorldMesh& world);

   private:
    template <class Mesh>
    void convert(const std::string& file, Mesh& mesh);
    void warn(const std::string& unknown, const std::string& known, io::Unit unit);

    bool strict_;
    std::string file_;     ///< the first with a unit
    std::string unknown_;  ///< the first without one
    io::Unit unit_ = io::Unit::unknown;
    bool warned_ = false;
};

}  // namespace crumple::cli
