#include "scene/world_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "crumple/error.h"
#include "scene/outline.h"

namespace crumple {
namespace {

constexpr std::int64_t most_elements = std::numeric_limits<std::int32_t>::max();

[[noreturn]] void refuse(const std::string& message, Element element, std::int64_t index) {
    throw Error(ErrorCode::invalid_argument, message, element, index);
}

// A shape whose end positions have neither rows nor data does not move.
void check_end(const Shape& shape, std::size_t s) {
    const VertexView& end = shape.end;
    if (!end.data && end.rows == 0) return;
    const auto refuse_shape = [&](const std::string& what) {
        refuse("shape " + std::to_string(s) + ": " + what, Element::shape, static_cast<std::int64_t>(s));
    };
    if (end.rows != shape.vertices.rows)
        refuse_shape("there are " + std::to_string(end.rows) + " vertices at the end for " +
                     std::to_string(shape.vertices.rows) + " at the start");
    if (const char* fault = fault_of(end)) refuse_shape(std::string("the vertices at the end") + fault);
}

void check_shapes(const World& world) {
    if (static_cast<std::int64_t>(world.shapes.size()) > most_elements)
        refuse("a world has at most 2147483647 shapes", Element::none, -1);
    for (std::size_t s = 0; s < world.shapes.size(); ++s) {
        const Shape& shape = world.shapes[s];
        MeshView mesh(shape.vertices, shape.triangles, shape.groups);
        check_mesh_outline(mesh, "shape " + std::to_string(s), MemorySpace::host);
        check_end(shape, s);
    }
}

void check_body(const World& world, std::size_t b) {
    const Body& body = world.bodies[b];
    const auto refuse_body = [&](const std::string& what) {
        refuse(WorldOutline::name(static_cast<std::int32_t>(b)) + what, Element::body, static_cast<std::int64_t>(b));
    };
    if (body.shape < 0 || static_cast<std::size_t>(body.shape) >= world.shapes.size())
        refuse_body("there is no shape " + std::to_string(body.shape) +
                    " (number of shapes: " + std::to_string(world.shapes.size()) + ")");
    if (body.world < -1 || body.world == most_elements)
        refuse_body("its world is " + std::to_string(body.world) + "; worlds are 0 to 2147483646, or -1");
    if (b > 0) {
        const std::int32_t before = world.bodies[b - 1].world;
        if (before == -1 && body.world != -1) refuse_body("bodies that are in all worlds (-1) must come last");
        if (body.world != -1 && body.world < before)
            refuse_body("its world " + std::to_string(body.world) + " comes after world " + std::to_string(before) +
                        "; world ids must ascend over the bodies");
    }
    for (const auto& poses : {world.poses, world.end_poses}) {
        if (poses.empty()) continue;
        for (const double value : poses[b].rows)
            if (!std::isfinite(value)) refuse_body("its pose is not finite");
    }
}

void check_filter(const PairFilter& rules, std::int64_t bodies) {
    const auto known = [](PairScope w) {
        return w == PairScope::both || w == PairScope::between || w == PairScope::within;
    };
    if (!known(rules.bodies) || !known(rules.groups))
        refuse("filter.bodies and filter.groups must be both, between or within", Element::option, -1);
    for (const BodyPair& pair : rules.excluded_bodies)
        for (const std::int32_t b : {pair.first, pair.second})
            if (b < 0 || b >= bodies)
                refuse("excluded_bodies names body " + std::to_string(b) + " of " + std::to_string(bodies),
                       Element::body, b);
}

}  // namespace

void WorldOutline::read(const World& world, const PairFilter& rules) {
    world_ = world;
    const auto n = static_cast<std::int64_t>(world.bodies.size());
    if (n > most_elements) refuse("a world has at most 2147483647 bodies", Element::none, -1);
    for (const auto& poses : {world.poses, world.end_poses})
        if (!poses.empty() && poses.size() != world.bodies.size())
            refuse("there are " + std::to_string(poses.size()) + " poses for " + std::to_string(n) + " bodies",
                   Element::none, -1);
    check_shapes(world);
    first_triangle_.resize_discard(static_cast<std::size_t>(n) + 1);
    first_triangle_[0] = 0;
    std::int32_t worlds = 0;
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        check_body(world, b);
        worlds = std::max(worlds, world.bodies[b].world + 1);
        first_triangle_[b + 1] = first_triangle_[b] + shape(static_cast<std::int32_t>(b)).triangles.rows;
    }
    check_filter(rules, n);

    first_body_.resize_discard(static_cast<std::size_t>(worlds) + 1);
    std::int32_t b = 0;
    for (std::int32_t w = 0; w <= worlds; ++w) {
        while (b < n && body(b).world != -1 && body(b).world < w) ++b;
        first_body_[w] = b;
    }
}

bool WorldOutline::moving() const {
    const auto moves = [](const Shape& shape) { return shape.end.data != nullptr; };
    return !world_.end_poses.empty() || std::any_of(world_.shapes.begin(), world_.shapes.end(), moves);
}

}  // namespace crumple
