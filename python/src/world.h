#pragma once

// Worlds on their way in: shapes and poses in place, where the library can read them so.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/world.h"

namespace crumple::python {

/// crumple.Shape: a mesh in place, the number that names it, what else is known of its vertices, which is where they
/// are at the end of a step and at rest, and their radii, and what edges and points it lists.
struct BorrowedShape {
    /// `mesh` is (vertices, faces, groups or None), `lists` (edges or None, points or None); `end`, `radii` and `rest`
    /// may be None. `which` leads every message.
    BorrowedShape(const nanobind::tuple& mesh, const char* which, std::uint64_t name, nanobind::handle end,
                  const nanobind::tuple& lists, nanobind::handle radii, nanobind::handle rest);

    BorrowedMesh mesh;
    std::optional<BorrowedEnd> end, rest;
    BorrowedLists lists;
    std::optional<BorrowedRadii> radii;
    Shape shape;
};

/// What a world is made of and never changes. A world of configurations has the bodies that move as often as there are
/// configurations, each configuration in a world of its own, and after them those at rest, which are in all worlds.
struct Bodies {
    Kept kept;
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::int64_t configurations = 1;
    std::int64_t moving = 0;          ///< bodies of one configuration
    std::vector<Pose> poses_at_rest;  ///< of those that are in all worlds of a world of configurations

    std::int64_t posed() const { return configurations * moving; }
    std::int64_t at_rest() const { return static_cast<std::int64_t>(bodies.size()) - posed(); }
    /// Bodies of one configuration and those at rest, as exclusions count them.
    std::int64_t distinct() const { return moving + at_rest(); }
};

/// An array of poses in place, of shape (n, 3, 4) or (n, 4, 4), or (k, n, ...) of configurations; or none.
class BorrowedPoses {
   public:
    BorrowedPoses() = default;
    enum class When : std::uint8_t { start, end };
    /// None: all as given. Throws where there is not one for each body that is posed. `stream`: the CUDA
    /// stream that poses in CUDA memory must be ready on, as in BorrowedMesh.
    BorrowedPoses(nanobind::handle poses, const Bodies& bodies, When when = When::start, void* stream = nullptr);

    /// One a body: in place where that can be, else in `buffer`. Reads the numbers as they are now; those of matrices
    /// of four rows must end in 0 0 0 1.
    std::span<const Pose> read(const Bodies& bodies, std::vector<Pose>& buffer) const;
    /// The CUDA device that they lie on, which read() refuses, or BorrowedArray::on_host.
    int device() const { return object_ ? array_.device : BorrowedArray::on_host; }
    /// Returns the poses on a device, ready on the stream. Refuses poses of configurations with bodies at rest.
    DevicePoses on_device(const Bodies& bodies) const;
    bool given() const { return object_.is_valid(); }
    /// As they were given.
    nanobind::object object() const { return object_ ? object_ : nanobind::none(); }

   private:
    void copy(std::int64_t count, std::vector<Pose>& buffer) const;

    nanobind::object object_;
    Kept kept_;
    BorrowedArray array_;
    When when_ = When::start;
    void* stream_ = nullptr;
};

/// crumple.World.
struct BorrowedWorld {
    std::shared_ptr<const Bodies> bodies;
    BorrowedPoses poses;
    BorrowedPoses end_poses;  ///< none: as `poses`
};

/// The world that a method is given or called on. A class of Python may leave it without what __init__ makes.
BorrowedWorld& given_world(nanobind::handle world);

/// Pairs of bodies from an (n, 2) array of int32, repeated for each configuration.
std::vector<BodyPair> excluded_bodies(const Bodies& bodies, nanobind::handle pairs);

void bind_world(nanobind::module_& module);

}  // namespace crumple::python
