#pragma once

// Arrays on their way in: views of what Python holds, without a copy wherever the library can read it in place.
//
// Accepted as they are: NumPy's arrays, and anything that speaks DLPack, in host memory or CUDA's; vertices (n, 3) of
// float32 or float64, faces (m, 3) or flat (3m) of int32, uint32 or int64, groups (m) of int32 without gaps; poses; any
// strides. Everything else goes through crumple/_arrays.py, which converts what can be converted without loss and
// refuses the rest by name.
//
// NumPy's arrays are read by its C API, which tells strides in bytes: DLPack counts whole numbers, which the records of
// a structured array need not be apart.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/scene.h"

namespace crumple::python {

/// Python's objects that must stay while their memory is read.
using Kept = std::vector<nanobind::object>;

/// An array in place.
struct BorrowedArray {
    enum class Number : std::uint8_t { other, float32, float64, int32, uint32, int64 };
    static constexpr int on_host = -1;

    const void* data = nullptr;
    Number number = Number::other;
    static constexpr int most_dimensions = 4;
    int dimensions = 0;                                            ///< 1 to 4; 0 for another number of them
    std::array<std::int64_t, most_dimensions> shape{}, strides{};  ///< strides in bytes
    int device = on_host;                                          ///< number of the CUDA device that it lies on
};

/// Imports NumPy before the first array that comes or goes, to keep `import crumple` quick.
void import_numpy();

/// What to do with arrays that cannot be read where they lie.
inline constexpr const char* copy_to_host =
    "copy them to the host (PyTorch: .cpu(), CuPy: .get(), JAX: jax.device_get, Warp: .numpy())";

// Arrays in CUDA memory are made ready by the package that owns them, on the CUDA stream `stream` of the constructors
// below: __dlpack__(stream=...) has that stream wait for what the package's own current stream was given. Null is the
// legacy default stream, as in MeshView::stream. Arrays in host memory need no stream.

/// Stands for no stream: for arrays of which only the shape is read now, so that no stream has to wait.
inline void* no_stream() { return reinterpret_cast<void*>(~std::uintptr_t{0}); }  // NOLINT(performance-no-int-to-ptr)

/// A crumple.Mesh in place. Needs the GIL to come and go, not to be read.
class BorrowedMesh {
   public:
    /// `mesh` is (vertices, faces, groups or None). `which` leads every message: "first mesh: " or nothing.
    explicit BorrowedMesh(const nanobind::tuple& mesh, const char* which = "", void* stream = nullptr);
    const MeshView& view() const { return view_; }
    /// The CUDA device that all of it lies on, or BorrowedArray::on_host.
    int device() const { return vertices_.device; }

   private:
    Kept kept_;
    BorrowedArray vertices_, faces_, groups_;
    MeshView view_;
};

/// Where a mesh's vertices are at the end of a step, or at rest, in place, where the mesh lies, and ready on its
/// stream.
class BorrowedEnd {
   public:
    enum class When : std::uint8_t { end, rest };
    /// Throws where they are not as many as those of the mesh.
    BorrowedEnd(nanobind::handle end, const BorrowedMesh& mesh, const char* which = "", When when = When::end);
    const VertexView& view() const { return view_; }

   private:
    Kept kept_;
    VertexView view_;
};

/// Edges and points that a caller lists (MeshView::edges, MeshView::points), in place.
class BorrowedLists {
   public:
    /// `lists` is (edges or None, points or None). `device`: where they must lie, as the mesh does. `which` leads every
    /// message.
    explicit BorrowedLists(const nanobind::tuple& lists, int device = BorrowedArray::on_host, const char* which = "",
                           void* stream = nullptr);
    /// Of a MeshView or a Shape.
    template <class Listing>
    void put_into(Listing& listing) const {
        listing.edges = edges_;
        listing.points = points_;
    }

   private:
    Kept kept_;
    std::optional<std::span<const Edge>> edges_;
    std::optional<std::span<const std::int32_t>> points_;
};

/// One number of float64 for each vertex of a mesh, in place, where the mesh lies, and ready on its stream.
class BorrowedRadii {
   public:
    BorrowedRadii(nanobind::handle radii, const BorrowedMesh& mesh, const char* which = "");
    std::span<const double> view() const { return view_; }

   private:
    Kept kept_;
    std::span<const double> view_;
};

/// Numbers that the triangles or vertices of a share have over all ranks: (n) of int64 on the host, in place.
class BorrowedIds {
   public:
    /// `ids` may be None. `what`: "triangle", "vertex" or "body". Throws where they are not `wanted` ids.
    BorrowedIds(nanobind::handle ids, const char* what, std::int64_t wanted);
    std::span<const std::int64_t> view() const { return view_; }

   private:
    Kept kept_;
    std::span<const std::int64_t> view_;
};

/// The meshes of one call, in place; without a second one, one soup.
struct BorrowedMeshes {
    BorrowedMeshes(const nanobind::tuple& first, const std::optional<nanobind::tuple>& second, void* stream = nullptr);
    Scene scene() const { return second ? Scene(first.view(), second->view()) : Scene(first.view()); }

    BorrowedMesh first;
    std::optional<BorrowedMesh> second;
};

/// Poses: (n, 3, 4) or (n, 4, 4), or (k, n, ...), of float32 or float64 on the host; in CUDA memory (n, 3, 4) or
/// (k, n, 3, 4) without gaps. `which` leads every message.
BorrowedArray borrow_poses(nanobind::handle poses, const char* which, void* stream, Kept& kept);

/// Whether the elements lie one after the other, the last index fastest.
bool is_contiguous(const BorrowedArray& array);

/// Pairs of group ids from a sequence of pairs or an (n, 2) array.
std::vector<GroupPair> group_pairs(nanobind::handle pairs);

}  // namespace crumple::python
