#pragma once

#include <concepts>
#include <variant>

#include "crumple/mesh.h"
#include "crumple/part.h"
#include "crumple/world.h"

namespace crumple {

/// Pairs across two meshes. Equal indices share nothing; with `weld` equal positions do. If one is float64, both are
/// computed in float64.
struct TwoMeshes {
    MeshView a, b;
};

/// Subject of a query. Made by conversion from any of these; a world is named, find(World{shapes, bodies, poses}).
/// Nothing is copied but views, so that what they name, a part too, must stay as it is until the call returns.
class Scene {
   public:
    /// Pairs within one mesh.
    Scene(const MeshView& mesh) : source_(mesh) {}
    Scene(const MeshView& a, const MeshView& b) : source_(TwoMeshes{a, b}) {}
    /// Pairs within the mesh that is made of these: vertices, triangles, and perhaps groups.
    template <class Vertices, class Triangles, class... Groups>
    requires std::constructible_from<MeshView, const Vertices&, const Triangles&, const Groups&...> Scene(
        const Vertices& vertices CRUMPLE_LIFETIMEBOUND, const Triangles& triangles CRUMPLE_LIFETIMEBOUND,
        const Groups&... groups)
        : source_(MeshView(vertices, triangles, groups...)) {}
    /// Pairs of different bodies, and within bodies.
    Scene(const World& world) : source_(world) {}
    /// The pairs that a part owns, without a look at the meshes that it was cut from (Detector::partition).
    Scene(const Part& part CRUMPLE_LIFETIMEBOUND) : source_(&part) {}

    const std::variant<MeshView, TwoMeshes, World, const Part*>& source() const { return source_; }

   private:
    std::variant<MeshView, TwoMeshes, World, const Part*> source_;
};

}  // namespace crumple
