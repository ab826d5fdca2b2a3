// Mistake: a view of vectors that no longer exist.
#include "crumple/mesh.h"

std::vector<std::array<float, 3>> vertices();
std::vector<std::array<int, 3>> triangles();

void use() { [[maybe_unused]] const crumple::MeshView mesh(vertices(), triangles()); }
