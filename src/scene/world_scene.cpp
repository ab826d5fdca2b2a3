#include "scene/world_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "crumple/error.h"

namespace crumple {
namespace {

constexpr std::int64_t chunk = 8192;
constexpr std::size_t most_marked_boxes = 10;  // six bits each

}  // namespace

void fail_body_not_finite(const WorldOutline& outline, std::int32_t b) {
    const Shape& shape = outline.shape(b);
    const auto look = [&](const VertexReader& position, const Placement& place, const char* when) {
        for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
            const Vec3d given = position(v);
            if (all_finite(place(given))) continue;
            const std::string what = all_finite(given) ? " is posed to infinity" : " is not finite";
            throw Error(ErrorCode::not_finite, WorldOutline::name(b) + "vertex " + std::to_string(v) + what + when,
                        Element::vertex, v);
        }
    };
    look(reader_of(shape), outline.placement(b), "");
    look(end_reader_of(shape), outline.end_placement(b), " at the end");
    throw Error(ErrorCode::not_finite, WorldOutline::name(b) + "a vertex is not finite", Element::body, b);
}

WorldScene::WorldScene(MemoryMeter* meter)
    : start_(meter),
      end_(meter),
      corner_(meter),
      groups_(meter),
      triangle_(meter),
      lone_groups_(meter),
      first_of_world_(meter),
      added_(meter),
      edges_(meter),
      points_(meter),
      row_(meter),
      sides_(meter),
      buffers_(meter) {}

void WorldScene::begin(bool float32, BodyFilter& rules, bool moving) {
    float32_ = float32;
    moving_ = moving;
    rules_ = &rules;
    classes_ = &rules.classes;
    classes_->clear();
    for (auto* coordinates : {&start_, &end_}) {
        coordinates->f.clear();
        coordinates->d.clear();
    }
    for (auto* list : {&corner_, &groups_, &triangle_}) list->clear();
    added_.clear();
    edges_.clear();
    points_.clear();
    first_of_world_.assign(1, 0);
}

void WorldScene::grow_vertices(std::int64_t more) {
    const std::int64_t n = vertices() + more;
    if (n > std::numeric_limits<std::int32_t>::max())
        throw Error(ErrorCode::invalid_argument, "bodies that meet have more than 2147483647 vertices together");
    const auto grow = [&](auto& coordinates) {
        coordinates.grow_by(static_cast<std::size_t>(3 * more));
        coordinates.resize(static_cast<std::size_t>(3 * n));
    };
    for (auto* coordinates : {&start_, &end_}) {
        if (coordinates == &end_ && !moving_) continue;
        if (float32_)
            grow(coordinates->f);
        else
            grow(coordinates->d);
    }
}

template <class PositionOf>
void WorldScene::put(Coordinates& coordinates, std::int64_t first, std::int64_t count, PositionOf position_of) {
    const auto write = [&](auto* out) {
        for (std::int64_t i = 0; i < count; ++i, out += 3) {
            const Vec3d p = position_of(i);
            for (int axis = 0; axis < 3; ++axis) out[axis] = static_cast<std::decay_t<decltype(*out)>>(p[axis]);
        }
    };
    float32_ ? write(coordinates.f.data() + 3 * first) : write(coordinates.d.data() + 3 * first);
}

// Marks each vertex from `first` on by its sides of up to ten boxes, in six bits for each box: bit 2 k if it lies below
// the box on axis k, bit 2 k + 1 if above.
void WorldScene::mark_sides(std::int64_t first, std::span<const Bounds> near) {
    sides_.resize_discard(static_cast<std::size_t>(vertices() - first));
    for (std::size_t v = 0; v < sides_.size(); ++v) {
        const Vec3d p = at(first + static_cast<std::int64_t>(v));
        std::uint64_t sides = 0;
        for (const Bounds& box : near) {
            sides <<= 6;
            for (int axis = 0; axis < 3; ++axis) {
                sides |= std::uint64_t{p[axis] < box.low[axis]} << (2 * axis);
                sides |= std::uint64_t{p[axis] > box.high[axis]} << (2 * axis + 1);
            }
        }
        sides_[v] = sides;
    }
}

// True if the box of a triangle overlaps a box in `near`, of which there are at most ten; its vertices are marked from
// `first` on. The box is apart from another one if all corners lie beyond the same side of that one.
bool WorldScene::is_near(const Row& row, std::int64_t first, std::span<const Bounds> near) const {
    const auto sides = [&](std::int32_t v) { return sides_[static_cast<std::size_t>(v - first)]; };
    std::uint64_t all = sides(row.corner[0]) & sides(row.corner[1]) & sides(row.corner[2]);
    for (std::size_t i = 0; i < near.size(); ++i, all >>= 6)
        if ((all & 63) == 0) return true;
    return false;
}

bool WorldScene::is_near(const Row& row, std::span<const Bounds> near) const {
    Bounds box = no_bounds;
    for (const std::int32_t v : row.corner) box.widen(at(v));
    return std::any_of(near.begin(), near.end(), [&](const Bounds& other) { return overlap(box, other); });
}

VertexView WorldScene::view(const Coordinates& coordinates) const {
    return float32_ ? rows_of_three(coordinates.f.data(), vertices()) : rows_of_three(coordinates.d.data(), vertices());
}

std::size_t WorldScene::added_of(std::int32_t vertex) const {
    const auto after = std::upper_bound(added_.begin(), added_.end(), std::int64_t{vertex},
                                        [](std::int64_t v, const Added& added) { return v < added.first_vertex; });
    return static_cast<std::size_t>(after - added_.begin()) - 1;
}

void WorldScene::begin_body(std::int32_t b, bool everywhere) { added_.push_back({b, vertices(), everywhere}); }

void WorldScene::add_triangle(const WorldOutline& outline, std::int32_t b, bool everywhere, const Row& row) {
    const Body& body = outline.body(b);
    const auto& groups = outline.shape(b).groups;
    const std::int32_t group = groups.empty() ? body.group : groups[static_cast<std::size_t>(row.element)];
    const BodyClass its{b, group, body.self, everywhere, true};
    if (classes_->empty() || classes_->back() != its) classes_->push_back(its);
    groups_.push_back(static_cast<std::int32_t>(classes_->size()) - 1);
    triangle_.push_back(row.element);
    for (const std::int32_t corner : row.corner) corner_.push_back(corner);
}

void WorldScene::add(const WorldOutline& outline, std::int32_t b, bool everywhere, ParallelFor& workers,
                     std::span<const Bounds> near) {
    const Shape& shape = outline.shape(b);
    const std::int64_t first = vertices(), n = shape.vertices.rows, m = shape.triangles.rows;
    begin_body(b, everywhere);
    grow_vertices(n);
    const VertexReader position = reader_of(shape), end_position = end_reader_of(shape);
    const Placement place = outline.placement(b), end_place = outline.end_placement(b);
    workers.parallel_for(static_cast<std::size_t>((n + chunk - 1) / chunk), [&](std::size_t c) {
        const std::int64_t begin = static_cast<std::int64_t>(c) * chunk, count = std::min(chunk, n - begin);
        put(start_, first + begin, count, [&](std::int64_t v) { return place(position(begin + v)); });
        if (moving_)
            put(end_, first + begin, count, [&](std::int64_t v) { return end_place(end_position(begin + v)); });
    });
    const bool marked = !near.empty() && near.size() <= most_marked_boxes;
    if (marked) mark_sides(first, near);
    groups_.grow_by(static_cast<std::size_t>(m));
    triangle_.grow_by(static_cast<std::size_t>(m));
    corner_.grow_by(static_cast<std::size_t>(3 * m));
    with_corner_reader(shape, [&](auto corner) {
        for (std::int64_t t = 0; t < m; ++t) {
            Row row{static_cast<std::int32_t>(t), {}};
            for (int k = 0; k < 3; ++k) {
                const std::int64_t v = corner(t, k);
                if (v < 0 || v >= n) fail_index(WorldOutline::name(b), t, v, n);
                row.corner[k] = static_cast<std::int32_t>(first + v);
            }
            if (near.empty() || (marked ? is_near(row, first, near) : is_near(row, near)))
                add_triangle(outline, b, everywhere, row);
        }
    });
}

void WorldScene::add(const WorldOutline& outline, std::int32_t b, bool everywhere, const ShapeTree& tree,
                     std::span<const std::int32_t> groups, std::span<const Bounds> near) {
    const Placement place = outline.placement(b), end_place = outline.end_placement(b);
    ShapeTree::Posed posed;
    begin_body(b, everywhere);
    row_.clear();
    for (const std::int32_t g : groups) {
        const ShapeTree::Group& group = tree.group(g);
        const auto first = static_cast<std::int32_t>(vertices());
        grow_vertices(group.vertices);
        const auto posed_vertex = [&](std::int64_t v) { return Vec3d{posed[0][v], posed[1][v], posed[2][v]}; };
        tree.pose(group, place, posed);
        put(start_, first, group.vertices, posed_vertex);
        if (moving_) {
            tree.pose(group, end_place, posed);
            put(end_, first, group.vertices, posed_vertex);
        }
        for (std::size_t k = 0; k < static_cast<std::size_t>(group.count); ++k) {
            const auto& c = group.corner[k];
            row_.push_back({group.element[k], {first + c[0], first + c[1], first + c[2]}});
        }
    }
    std::sort(row_.begin(), row_.end(), [](const Row& a, const Row& b) { return a.element < b.element; });
    const Shape& shape = outline.shape(b);
    const std::int64_t triangles = shape.triangles.rows;
    const std::int64_t edges = shape.edges ? static_cast<std::int64_t>(shape.edges->size()) : 0;
    Added& added = added_[added_.size() - 1];
    added.only_groups = true;
    added.first_edge = edges_.size();
    added.first_point = points_.size();
    for (const Row& row : row_) {
        if (row.element >= triangles + edges)
            points_.push_back(row.corner[0]);
        else if (row.element >= triangles)
            edges_.push_back({row.corner[0], row.corner[1]});
        else if (near.empty() || is_near(row, near))
            add_triangle(outline, b, everywhere, row);
    }
    added.end_edge = edges_.size();
    added.end_point = points_.size();
}

PreparedScene WorldScene::scene(const WorldOutline& outline, bool weld, ParallelFor& workers) {
    const MeshView mesh(view(start_), rows_of_three(corner_.data(), triangles()), groups_.span());
    try {
        PreparedScene scene = prepare_scene(mesh, nullptr, weld, workers, buffers_);
        scene.bodies = rules_;
        if (first_of_world_.size() > 2) {
            scene.first_of_world = first_of_world_.data();
            scene.worlds = static_cast<int>(first_of_world_.size()) - 1;
        }
        if (moving_) add_motion(view(end_), workers, buffers_, scene);
        return scene;
    } catch (const Error& error) {
        if (error.element != Element::vertex) throw;
        fail_body_not_finite(outline, added_[added_of(static_cast<std::int32_t>(error.index))].body);
    }
}

// A proxy triangle is a degenerate one that owns an edge or a point which no triangle owns (scene_features.h). If a
// triangle has this feature nevertheless, because the feature is listed repeatedly, the proxy triangle is in that
// triangle's class (BodyClass); else it is in a further class of its body.
PreparedScene WorldScene::with_proxies(const WorldOutline& outline, const SceneFeatures& features,
                                       const PreparedScene& scene) {
    if (features.proxies() == 0) return scene;
    lone_groups_.resize_discard(static_cast<std::size_t>(vertices()));
    for (std::size_t i = 0; i < added_.size(); ++i) {
        const std::int32_t b = added_[i].body;
        const auto group = static_cast<std::int32_t>(classes_->size());
        classes_->push_back(
            {b, outline.body(b).group, outline.body(b).self, added_[i].everywhere, outline.shape(b).groups.empty()});
        std::fill(lone_groups_.begin() + first_vertex(i), lone_groups_.begin() + end_vertex(i), group);
    }
    groups_.grow_by(static_cast<std::size_t>(features.proxies()));
    for (std::int64_t i = 0; i < features.proxies(); ++i) {
        const std::int32_t face = features.face_of_proxy(i);
        groups_.push_back(face < 0 ? lone_groups_[features.corners()[3 * (features.faces() + i)]] : groups_[face]);
    }
    PreparedScene all = features.with_proxies(scene);
    all.groups = groups_.data();
    all.lone_groups = lone_groups_.data();
    return all;
}

}  // namespace crumple
