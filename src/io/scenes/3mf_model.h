#pragma once

// A model part of a 3MF file: its objects, and what its build is made of.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "crumple/io.h"
#include "io/scenes/package.h"

namespace crumple::io {

/// An object that a build item or a component names, and where it is put.
struct ModelReference {
    std::int64_t line = 0;
    std::int64_t id = 0;
    std::string part = {};  ///< empty: the part in which it stands
    Pose pose = {};
};

/// A mesh, or an assembly of other objects; neither, if only an extension tells what it is.
struct ModelObject {
    std::int64_t line = 0;
    std::string name = {};
    std::optional<std::size_t> mesh = {};
    std::vector<ModelReference> components = {};
};

struct Model {
    std::string place;  ///< of the part, for messages
    Unit unit = Unit::millimetre;
    std::unordered_map<std::int64_t, ModelObject> objects = {};
    std::vector<TriangleMesh> meshes = {};
    std::vector<ModelReference> build = {};
    std::int64_t beams = 0;  ///< lattices, which are skipped
};

/// Throws Error (format) that names the part and the line.
Model read_3mf_model(Package& package, const std::string& part, const ReadOptions& options);

}  // namespace crumple::io
