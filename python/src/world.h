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

/// View of a crumple.Shape: its mesh, the number of its name, and its positions at the end of a step, rest shape,
/// radii, edges and points.
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

/// Immutable contents of a world. A world of configurations has its moving bodies once per configuration, each
/// configuration in a world of its own, and then the static bodies, which are in all worlds.
struct Bodies {
    Kept kept;
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::int64_t configurations = 1;
    std::int64_t moving = 0;         ///< number of moving bodies in a configuration
    std::vector<Pose> static_poses;  ///< poses of the static bodies of a world of configurations

    std::int64_t posed() const { return configurations * moving; }
    std::int64_t at_rest() const { return static_cast<std::int64_t>(bodies.size()) - posed(); }
    /// Returns the number of bodies of one configuration and of static bodies, which exclusions refer to.
    std::int64_t distinct() const { return moving + at_rest(); }
};

/// View of an array of poses, (n, 3, 4) or (n, 4, 4), or (k, n, ...) for configurations; or no poses.
class BorrowedPoses {
   public:
    BorrowedPoses() = default;
    enum class When : std::uint8_t { start, end };
    /// None: identity for all. Throws Error unless there is one pose for each posed body. `stream`: the CUDA stream on
    /// which poses in CUDA memory must be ready, as in BorrowedMesh.
    BorrowedPoses(nanobind::handle poses, const Bodies& bodies, When when = When::start, void* stream = nullptr);

    /// Returns one pose per body: in place if possible, else in `buffer`. Reads the current contents. Throws Error if
    /// the last row of a matrix of four rows is not 0 0 0 1.
    std::span<const Pose> read(const Bodies& bodies, std::vector<Pose>& buffer) const;
    /// Returns the CUDA device that contains them, or BorrowedArray::on_host. read() refuses poses on a device.
    int device() const { return object_ ? array_.device : BorrowedArray::on_host; }
    /// Returns the poses on a device, ready on the stream. Refuses poses of configurations with static bodies.
    DevicePoses on_device(const Bodies& bodies) const;
    bool given() const { return object_.is_valid(); }
    /// Returns the array as given, or None.
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
    BorrowedPoses end_poses;  ///< none: the same as `poses`
};

/// Returns the world that a method is called on or with. Throws Error if __init__ of a subclass did not make it.
BorrowedWorld& given_world(nanobind::handle world);

/// Returns pairs of bodies from an (n, 2) array of int32, repeated for each configuration.
std::vector<BodyPair> excluded_bodies(const Bodies& bodies, nanobind::handle pairs);

void bind_world(nanobind::module_& module);

}  // namespace crumple::python
