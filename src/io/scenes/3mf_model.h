#pragma once

// Model part of a 3MF file: its objects, and the items of its build.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "crumple/io.h"
#include "io/scenes/package.h"

namespace crumple::io {

/// Reference of a build item or a component to an object, with its pose.
struct ModelReference {
    std::int64_t line = 0;
    std::int64_t id = 0;
    std::string part = {};  ///< part with the object; empty: the part with the reference
    Pose pose = {};
};

/// Object of a model: a mesh, or an assembly of other objects. It has neither if its geometry is that of an extension.
struct ModelObject {
    std::int64_t line = 0;
    std::string name = {};
    std::optional<std::size_t> mesh = {};
    std::vector<ModelReference> components = {};
};

struct Model {
    std::string place;  ///< file and part, for messages
    Unit unit = Unit::millimetre;
    std::unordered_map<std::int64_t, ModelObject> objects = {};
    std::vector<TriangleMesh> meshes = {};
    std::vector<ModelReference> build = {};
    std::int64_t beams = 0;  ///< number of beam lattices, which are skipped
};

/// Reads a model part. Throws Error (format) that names the part and the line.
Model read_3mf_model(Package& package, const std::string& part, const ReadOptions& options);

}  // namespace crumple::io
