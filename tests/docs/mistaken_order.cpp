// Mistake: triangles before vertices.
#include "crumple/mesh.h"

const float xyz[9]{};
const int ijk[3]{0, 1, 2};
const crumple::MeshView mesh(ijk, 3, xyz, 1);
