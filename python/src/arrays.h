#pragma once

// Arrays on their way in: views of what Python holds, without a copy wherever the library can read it in place.
//
// Accepted as they are: host arrays that speak DLPack or the buffer protocol; vertices (n, 3) of float32 or float64,
// faces (m, 3) of int32, uint32 or int64, groups (m) of int32 without gaps; any strides. Everything else goes through
// crumple/_arrays.py, which converts what can be converted without loss and refuses the rest by name.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <string>
#include <vector>

#include "crumple/mesh.h"
#include "crumple/options.h"

namespace crumple::python {

using AnyArray = nanobind::ndarray<nanobind::ro>;

/// A mesh that Python holds, a tuple (vertices, faces, groups or None). Keeps its arrays alive; needs the GIL to come
/// and go, not to be read.
class BorrowedMesh {
   public:
    /// `which` leads every message: "first mesh: " or nothing.
    BorrowedMesh(nanobind::handle mesh, const std::string& which);
    const MeshView& view() const { return view_; }

   private:
    AnyArray vertices_, faces_, groups_;
    MeshView view_;
};

/// Pairs of group ids from a sequence of pairs or an (n, 2) array.
std::vector<GroupPair> group_pairs(nanobind::handle pairs);

}  // namespace crumple::python
