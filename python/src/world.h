#pragma once

// Conversion of worlds: views of shapes and poses, without a copy if the library can read them in place.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/world.h"

namespace crumple::python {

/// View of a crumple.Shape: its mesh, its name (a number that Python assigns), its positions at the end of a step, its
/// rest shape, radii, edges and points.
struct BorrowedShape {
    /// `mesh` is (vertices, faces, groups or None), `lists` (edges or None, points or None); `end`, `radii` and `rest`
    /// may be None. `which` is the prefix of all messages.
    BorrowedShape(const nanobind::tuple& mesh, const char* which, std::uint64_t name, nanobind::handle end,
                  const nanobind::tuple& lists, nanobind::handle radii, nanobind::handle rest);

    BorrowedMesh mesh;
    std::optional<BorrowedEnd> end, rest;
    BorrowedLists lists;
    std::optional<BorrowedRadii> radii;
    Shape shape;
};

/// Immutable contents of a world. If it has configurations, it lists its moving bodies once per configuration; each
/// configuration has a world index of its own. The static bodies follow, which are in all worlds.
struct Bodies {
    Kept kept;
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::int64_t configurations = 1;
    std::int64_t moving = 0;         ///< number of moving bodies of one configuration
    std::vector<Pose> static_poses;  ///< poses of the static bodies of a world of configurations

    std::int64_t posed() const { return configurations * moving; }
    std::int64_t static_count() const { return static_cast<std::int64_t>(bodies.size()) - posed(); }
    /// Returns the number of moving bodies of one configuration plus the number of static bodies. Excluded pairs use
    /// these indices.
    std::int64_t distinct() const { return moving + static_count(); }
};

/// View of an array of poses of shape (n, 3, 4) or (n, 4, 4), or (k, n, 3, 4) or (k, n, 4, 4) for k configurations. May
/// be empty: no poses were given.
class BorrowedPoses {
   public:
    BorrowedPoses() = default;
    enum class When : std::uint8_t { start, end };
    /// If `poses` is None, all poses are the identity. Throws Error unless there is one pose for each moving body of
    /// each configuration. `stream`: the CUDA stream on which poses in CUDA memory must be ready, as in BorrowedMesh.
    BorrowedPoses(nanobind::handle poses, const Bodies& bodies, When when = When::start, void* stream = nullptr);

    /// Returns one pose per body, with the current contents of the array: a view of the array if possible, otherwise of
    /// a copy in `buffer`. Throws Error if a matrix has four rows and the last is not 0 0 0 1.
    std::span<const Pose> read(const Bodies& bodies, std::vector<Pose>& buffer) const;
    /// Returns the CUDA device that contains the poses, or BorrowedArray::on_host. read() refuses poses on a device.
    int device() const { return object_ ? array_.device : BorrowedArray::on_host; }
    /// Returns poses on a device, ready on the stream. Throws Error if the world has configurations and static bodies.
    DevicePoses on_device(const Bodies& bodies) const;
    bool given() const { return object_.is_valid(); }
    /// Returns the array that was given, or None.
    nanobind::object object() const { return object_ ? object_ : nanobind::none(); }

   private:
    void copy(std::int64_t count, std::vector<Pose>& buffer) const;

    nanobind::object object_;
    Kept kept_;
    BorrowedArray array_;
    When when_ = When::start;
    void* stream_ = nullptr;
};

/// View of a crumple.World.
struct BorrowedWorld {
    std::shared_ptr<const Bodies> bodies;
    BorrowedPoses poses;
    BorrowedPoses end_poses;  ///< poses at the end of a step; empty: the same as `poses`
};

/// Returns the world that a method is called on or with. Throws Error if it was not constructed, because a subclass did
/// not call __init__.
BorrowedWorld& given_world(nanobind::handle world);

/// Returns excluded pairs of bodies, repeated for each configuration. `pairs`: indices in [0, distinct()), (n, 2)
/// int32, or None.
std::vector<BodyPair> excluded_bodies(const Bodies& bodies, nanobind::handle pairs);

void bind_world(nanobind::module_& module);

}  // namespace crumple::python
