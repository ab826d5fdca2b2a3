#pragma once

// Input arrays: views of Python's arrays, without a copy if the library can read them in place.
//
// These arrays are read in place: NumPy arrays, and anything that supports DLPack, in host or CUDA memory, with any
// strides. Vertices must be (n, 3) float32 or float64; faces (m, 3) or flat (3m) int32, uint32 or int64; groups (m)
// contiguous int32; for poses see borrow_poses(). Other arrays go through crumple/_arrays.py, which converts them
// without loss or raises an error that names the array.
//
// "Borrowed" types are such views, together with what keeps the memory of the arrays alive.
//
// NumPy arrays are read through NumPy's C API, which has strides in bytes. DLPack counts strides in elements, and
// fields of a structured array may not be a whole number of elements apart.

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

/// Python objects that keep the memory of a view alive.
using Kept = std::vector<nanobind::object>;

/// View of an array.
struct BorrowedArray {
    enum class Number : std::uint8_t { other, float32, float64, int32, uint32, int64 };
    static constexpr int on_host = -1;

    const void* data = nullptr;
    Number number = Number::other;
    static constexpr int most_dimensions = 4;
    int dimensions = 0;  ///< number of axes, 1 to 4; 0 if the array has none, or more than 4
    std::array<std::int64_t, most_dimensions> shape{}, strides{};  ///< of each axis; strides are in bytes
    int device = on_host;  ///< number of the CUDA device whose memory has the array
};

/// Imports NumPy before the first use of an array, so that `import crumple` stays fast.
void import_numpy();

/// Advice for messages about arrays in CUDA memory that are needed in host memory.
inline constexpr const char* copy_to_host =
    "copy them to the host (PyTorch: .cpu(), CuPy: .get(), JAX: jax.device_get, Warp: .numpy())";

// `stream` in the constructors below is the CUDA stream on which arrays in CUDA memory must be ready. The package that
// owns an array ensures this: its __dlpack__(stream=...) makes `stream` wait for the package's current stream. Null is
// the legacy default stream, as in MeshView::stream. Arrays in host memory need no stream.

/// Returns the value of `stream` that means no stream, so that no stream has to wait. For arrays of which only the
/// shape is read.
inline void* no_stream() { return reinterpret_cast<void*>(~std::uintptr_t{0}); }  // NOLINT(performance-no-int-to-ptr)

/// View of a crumple.Mesh. Construct and destroy it with the GIL; reading it needs no GIL.
class BorrowedMesh {
   public:
    /// `mesh` is (vertices, faces, groups or None). `which` is the prefix of all messages: "first mesh: " or empty.
    explicit BorrowedMesh(const nanobind::tuple& mesh, const char* which = "", void* stream = nullptr);
    const MeshView& view() const { return view_; }
    /// Returns the CUDA device that contains all arrays, or BorrowedArray::on_host.
    int device() const { return vertices_.device; }

   private:
    Kept kept_;
    BorrowedArray vertices_, faces_, groups_;
    MeshView view_;
};

/// View of a mesh's vertices at the end of a step or in the rest shape. The array must be in the same memory (host or
/// device) as the mesh. If it is on the device, the package that owns it makes it ready on the mesh's stream.
class BorrowedEnd {
   public:
    enum class When : std::uint8_t { end, rest };
    /// Throws Error if the number of vertices is not that of the mesh.
    BorrowedEnd(nanobind::handle end, const BorrowedMesh& mesh, const char* which = "", When when = When::end);
    const VertexView& view() const { return view_; }

   private:
    Kept kept_;
    VertexView view_;
};

/// View of the codimensional edges and points of a mesh or shape (MeshView::edges, MeshView::points).
class BorrowedLists {
   public:
    /// `lists` is (edges or None, points or None). `device`: the device of the mesh, on which the lists must be, too.
    /// `which` is the prefix of all messages.
    explicit BorrowedLists(const nanobind::tuple& lists, int device = BorrowedArray::on_host, const char* which = "",
                           void* stream = nullptr);
    /// Sets the members `edges` and `points` of a MeshView or a Shape.
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

/// View of the radii of a mesh's vertices, one float64 each. The array must be in the same memory (host or device) as
/// the mesh. If it is on the device, the package that owns it makes it ready on the mesh's stream.
class BorrowedRadii {
   public:
    BorrowedRadii(nanobind::handle radii, const BorrowedMesh& mesh, const char* which = "");
    std::span<const double> view() const { return view_; }

   private:
    Kept kept_;
    std::span<const double> view_;
};

/// View of the ids, over all ranks, of the triangles, vertices or bodies of one rank: (n) int64 in host memory.
class BorrowedIds {
   public:
    /// `ids` may be None. `what`: "triangle", "vertex" or "body", for messages. The last argument is the required
    /// number of ids; throws Error if there are more or fewer.
    BorrowedIds(nanobind::handle ids, const char* what, std::int64_t wanted);
    std::span<const std::int64_t> view() const { return view_; }

   private:
    Kept kept_;
    std::span<const std::int64_t> view_;
};

/// View of the meshes of a call: one, or two.
struct BorrowedMeshes {
    BorrowedMeshes(const nanobind::tuple& first, const std::optional<nanobind::tuple>& second, void* stream = nullptr);
    Scene scene() const { return second ? Scene(first.view(), second->view()) : Scene(first.view()); }

    BorrowedMesh first;
    std::optional<BorrowedMesh> second;
};

/// Returns a view of poses: (n, 3, 4) or (n, 4, 4), or (k, n, ...), of float32 or float64 in host memory; (n, 3, 4) or
/// (k, n, 3, 4) without gaps in CUDA memory. `which` is the prefix of all messages.
BorrowedArray borrow_poses(nanobind::handle poses, const char* which, void* stream, Kept& kept);

/// True if the elements are contiguous in row-major order.
bool is_contiguous(const BorrowedArray& array);

/// Returns pairs of group ids from a sequence of pairs or an (n, 2) array.
std::vector<GroupPair> group_pairs(nanobind::handle pairs);

}  // namespace crumple::python
