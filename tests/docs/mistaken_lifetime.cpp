// A view of vertices that are gone.
#include "crumple/mesh.h"

std::vector<std::array<float, 3>> vertices();
std::vector<std::array<int, 3>> triangles();

void use() { [[maybe_unused]] const crumple::MeshView mesh(vertices(), triangles()); }
