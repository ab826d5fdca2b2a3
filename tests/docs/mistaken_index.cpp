// Mistake: indices of 16 bits.
#include "crumple/mesh.h"

const float xyz[9]{};
const short ijk[3]{0, 1, 2};
const crumple::MeshView mesh(xyz, 3, ijk, 1);
