#pragma once

// Conversion of several input files to a common unit of length.

#include <functional>
#include <string>
#include <utility>

#include "crumple/io.h"

namespace crumple::io {

/// Converter of meshes and worlds to the unit of the first file that states a unit.
class CommonUnit {
   public:
    using Message = std::function<void(const std::string&)>;

    /// `strict`: warnings are errors. `advice`: how to state the unit of a file. `note`, `warn`: consume messages.
    CommonUnit(bool strict, std::string advice, Message note, Message warn)
        : strict_(strict), advice_(std::move(advice)), note_(std::move(note)), warn_(std::move(warn)) {}

    /// Converts the contents of the next file if its unit differs, with a note about it. Warns if only some of the
    /// files state a unit; if strict, throws Error (invalid_argument) instead. Throws Error (invalid_argument) also if
    /// a coordinate overflows.
    void apply(const std::string& file, TriangleMesh& mesh);
    void apply(const std::string& file, WorldMesh& world);

   private:
    template <class Mesh>
    void convert(const std::string& file, Mesh& mesh);
    void warn(const std::string& unknown, const std::string& known, Unit unit);

    bool strict_;
    std::string advice_;
    Message note_, warn_;
    std::string file_;     ///< first file with a unit
    std::string unknown_;  ///< first file without a unit
    Unit unit_ = Unit::unknown;
    bool warned_ = false;
};

}  // namespace crumple::io
