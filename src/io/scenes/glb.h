#pragma once

// Building blocks of .glb files, shared by single and animated ones.

#include <iosfwd>
#include <optional>
#include <vector>

#include "io/formats.h"

namespace tinygltf {
class Model;
}

namespace crumple::io {

/// Returns an empty scene with these materials.
tinygltf::Model empty_glb(std::span<const Material> materials = collision_materials);

/// Adds a mesh as a node of the scene and returns the node's index; adds nothing for a mesh without triangles. Throws
/// Error (invalid_argument) if the file would exceed the 4 GiB of .glb, or a coordinate overflows float32.
std::optional<int> add_node(tinygltf::Model& model, const ColouredMesh& coloured);

/// Appends numbers to the model's one buffer and returns the index of their accessor; `type` and `target` are
/// tinygltf's constants, target 0 for none.
int add_floats(tinygltf::Model& model, const std::vector<float>& values, int type, int target);

/// Writes the model, which is unchanged afterwards. A known unit is scaled to metres by a node above all others.
void write_glb(std::ostream& out, tinygltf::Model& model, Unit unit);

}  // namespace crumple::io
