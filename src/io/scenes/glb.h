#pragma once

// What a single coloured .glb and an animated one have in common.

#include <iosfwd>
#include <optional>
#include <vector>

#include "io/formats.h"

namespace tinygltf {
class Model;
}

namespace crumple::io {

/// An empty scene with these materials.
tinygltf::Model empty_glb(std::span<const Material> materials = collision_materials);

/// Adds a mesh as a node of the scene and returns the node's index; nothing for a mesh without triangles. Throws Error
/// (invalid_argument) if the file would outgrow the format or a coordinate float32.
std::optional<int> add_node(tinygltf::Model& model, const ColouredMesh& coloured);

/// Appends numbers to the model's one buffer and returns the index of their accessor; `type` and `target` are
/// tinygltf's constants, target 0 for none.
int add_floats(tinygltf::Model& model, const std::vector<float>& values, int type, int target);

/// A known unit is scaled to metres by a node above all others. The model is left as it was.
void write_glb(std::ostream& out, tinygltf::Model& model, Unit unit);

}  // namespace crumple::io
