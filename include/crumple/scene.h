#pragma once

#include <concepts>
#include <variant>

#include "crumple/mesh.h"
#include "crumple/part.h"
#include "crumple/world.h"

namespace crumple {

/// Two meshes: queries search for pairs of an element of `a` and one of `b`. Vertices of different meshes are
/// different, whatever their indices; with `weld`, vertices at equal positions count as one. If one mesh is float64,
/// both are computed in float64.
struct TwoMeshes {
    MeshView a, b;
};

/// Subject of a query. Converts implicitly from the parameters of each constructor below; for a world, write the type:
/// find(World{shapes, bodies, poses}). Holds views only: the arrays (and the Part) they refer to must stay unchanged
/// until the call returns.
class Scene {
   public:
    /// One mesh, with pairs within it.
    Scene(const MeshView& mesh) : source_(mesh) {}
    /// Two meshes, with pairs across them: first a, second b.
    Scene(const MeshView& a, const MeshView& b) : source_(TwoMeshes{a, b}) {}
    /// One mesh, MeshView(vertices, triangles, groups...).
    template <class Vertices, class Triangles, class... Groups>
    requires std::constructible_from<MeshView, const Vertices&, const Triangles&, const Groups&...> Scene(
        const Vertices& vertices CRUMPLE_LIFETIMEBOUND, const Triangles& triangles CRUMPLE_LIFETIMEBOUND,
        const Groups&... groups)
        : source_(MeshView(vertices, triangles, groups...)) {}
    /// Bodies, with pairs across them, and within bodies that have Body::self.
    Scene(const World& world) : source_(world) {}
    /// A part, with the pairs that it owns (Detector::partition). The meshes that it was cut from are not needed.
    Scene(const Part& part CRUMPLE_LIFETIMEBOUND) : source_(&part) {}

    /// Returns the views, by kind of scene.
    const std::variant<MeshView, TwoMeshes, World, const Part*>& source() const { return source_; }

   private:
    std::variant<MeshView, TwoMeshes, World, const Part*> source_;
};

}  // namespace crumple
