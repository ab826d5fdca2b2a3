#pragma once

// Conversion of the input files of one command to a common unit of length.

#include <string>

#include "crumple/io.h"

namespace crumple::cli {

/// Converter of meshes and worlds to the unit of the first file that states a unit.
class CommonUnit {
   public:
    /// `strict`: warnings are errors.
    explicit CommonUnit(bool strict) : strict_(strict) {}

    /// Converts the contents of the next file if its unit differs, and prints a note about it. Warns if only some of
    /// the files state a unit; if strict, throws Error (invalid_argument) instead. Throws Error (invalid_argument) also
    /// if a coordinate overflows.
    void apply(const std::string& file, io::TriangleMesh& mesh);
    void apply(const std::string& file, io::WorldMesh& world);

   private:
    template <class Mesh>
    void convert(const std::string& file, Mesh& mesh);
    void warn(const std::string& unknown, const std::string& known, io::Unit unit);

    bool strict_;
    std::string file_;     ///< first file with a unit
    std::string unknown_;  ///< first file without a unit
    io::Unit unit_ = io::Unit::unknown;
    bool warned_ = false;
};

}  // namespace crumple::cli
