#pragma once

// A float32 mesh that grows, and closed solids to fill it with.

#include <array>
#include <cstdint>
#include <utility>

#include "geometry/vec.h"
#include "scenes/scenes.h"

namespace crumple::scenes {

/// Mesh that grows; rounds coordinates to float32 as they are added.
class Soup {
   public:
    void reserve(std::int64_t vertices, std::int64_t triangles);
    /// Adds a vertex and returns its index.
    std::int32_t vertex(Vec3d position);
    /// Adds a triangle. Has a single argument, so that calls of vertex() within the argument are made in order: C++
    /// specifies the order of evaluation within braces, but not between arguments.
    void triangle(std::array<std::int32_t, 3> corners);
    /// Adds a triangle with vertices of its own.
    void triangle(Vec3d a, Vec3d b, Vec3d c);
    /// Assigns this group to all triangles that have none yet.
    void group(std::int32_t id) { mesh_.groups.resize(mesh_.triangles.size() / 3, id); }
    std::int64_t triangle_count() const { return mesh_.triangle_count(); }
    io::TriangleMesh take() { return std::move(mesh_); }

   private:
    io::TriangleMesh mesh_{std::vector<float>{}, {}, {}};
};

/// Scaling followed by a rigid motion: origin + axes * (scale * p).
struct ScaledPose {
    std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d origin{};
    double scale = 1;

    Vec3d operator()(Vec3d p) const {
        p = scale * p;
        return origin + p.x * axes[0] + p.y * axes[1] + p.z * axes[2];
    }
};

// Closed and watertight solids: adjacent triangles share vertices by index.

/// Adds a unit sphere of meridians and parallels about z (a UV sphere), with 2 * slices * (stacks - 1) triangles.
void add_uv_sphere(Soup& soup, int slices, int stacks, const ScaledPose& pose);
/// Adds a unit sphere, made of an icosahedron whose edges are cut into `cuts` parts: 20 cuts² triangles.
void add_icosphere(Soup& soup, int cuts, const ScaledPose& pose);
/// Adds a box of half widths `half`, whose edges are cut into `cuts` parts: 12 cuts² triangles.
void add_box(Soup& soup, int cuts, Vec3d half, const ScaledPose& pose);
/// Adds a torus about z, a tube of radius `tube` along the unit circle, with 2 * around * across triangles.
void add_torus(Soup& soup, int around, int across, double tube, const ScaledPose& pose);

}  // namespace crumple::scenes
