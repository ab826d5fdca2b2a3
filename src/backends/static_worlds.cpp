#include "backends/static_worlds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "crumple/error.h"
#include "results/world_output.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"

namespace crumple {
namespace {

constexpr std::int64_t most_triangles = 1 << 24;  // limit of a scene of several worlds; a single world may exceed it

bool same_pairs(const auto& a, const auto& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& p, const auto& q) { return p.first == q.first && p.second == q.second; });
}

bool same_filter(const PairFilter& a, const PairFilter& b) {
    return a.bodies == b.bodies && a.groups == b.groups && same_pairs(a.excluded_bodies, b.excluded_bodies) &&
           same_pairs(a.excluded_groups, b.excluded_groups);
}

bool same_body(const Body& a, const Body& b) {
    return a.shape == b.shape && a.group == b.group && a.world == b.world && a.self == b.self;
}

bool same_size(const Shape& a, const Shape& b) {
    return a.vertices.rows == b.vertices.rows && a.vertices.type == b.vertices.type &&
           a.triangles.rows == b.triangles.rows;
}

// Passes those contents of a shape that its name does not identify to take(), one number at a time, until take()
// returns false: groups and, if the shape has no name, positions and triangles. Returns false if take() did.
template <class Take>
bool for_each_word(const Shape& shape, Take take) {
    const bool named = shape.name != 0;
    const VertexReader position = reader_of(shape);
    for (std::int64_t v = 0; !named && v < shape.vertices.rows; ++v) {
        const Vec3d p = position(v);
        for (const double x : {p.x, p.y, p.z})
            if (!take(std::bit_cast<std::uint64_t>(x))) return false;
    }
    bool all = true;
    with_corner_reader(shape, [&](auto corner) {
        for (std::int64_t t = 0; !named && all && t < shape.triangles.rows; ++t)
            for (int k = 0; all && k < 3; ++k) all = take(static_cast<std::uint64_t>(corner(t, k)));
    });
    for (std::size_t t = 0; all && t < shape.groups.size(); ++t)
        all = take(static_cast<std::uint64_t>(shape.groups[t]));
    return all;
}

}  // namespace

/// State while the world is read; the outline is kept to make results.
struct StaticWorlds::Read {
    explicit Read(MemoryMeter* meter) : outline(meter), scene(std::in_place, meter) {}
    WorldOutline outline;
    std::optional<WorldScene> scene;
};

StaticWorlds::StaticWorlds(const World& world, const PairFilter& rules, MemoryMeter& meter)
    : meter_(meter),
      shapes_(world.shapes.begin(), world.shapes.end()),
      all_(&meter),
      given_(rules),
      body_filter_(&meter),
      read_(std::make_unique<Read>(&meter)),
      shape_vertices_(&meter),
      bodies_(&meter),
      first_of_occurrence_(&meter),
      first_of_class_(&meter),
      first_of_caller_world_(&meter),
      first_of_scene_world_(&meter),
      caller_worlds_(&meter) {
    std::ranges::copy(world.bodies, all_.resize_discard(world.bodies.size()));
    read_->outline.read({shapes_, all_.span(), {}}, rules);
    body_filter_.prepare(rules);
}
StaticWorlds::~StaticWorlds() = default;

std::unique_ptr<StaticWorlds> StaticWorlds::make(const World& world, const PairFilter& rules, int worlds_at_once,
                                                 ParallelFor& workers, MemoryMeter& meter) {
    std::unique_ptr<StaticWorlds> made(new StaticWorlds(world, rules, meter));
    if (!made->choose_worlds(worlds_at_once)) return nullptr;
    made->add_bodies(workers);
    made->add_shapes();
    return made;
}

std::int32_t StaticWorlds::worlds() const { return read_->outline.worlds(); }

// Collects the indices of the caller's worlds in which a pair is possible; the index worlds() stands for pairs among
// bodies that are in all worlds. Returns false if one scene cannot hold all of these.
bool StaticWorlds::choose_worlds(int worlds_at_once) {
    const WorldOutline& outline = read_->outline;
    const std::int32_t worlds = outline.worlds(), rest = outline.first_body(worlds);
    const auto vertices_of = [&](std::int32_t begin, std::int32_t end) {
        std::int64_t sum = 0;
        for (std::int32_t b = begin; b < end; ++b) sum += outline.shape(b).vertices.rows;
        return sum;
    };
    const std::int64_t static_vertices = vertices_of(rest, outline.bodies());
    std::int64_t triangles = 0, vertices = 0;
    for (std::int32_t pass = 0; pass <= worlds; ++pass) {
        const std::int32_t begin = outline.first_body(pass);
        const std::int32_t end = pass < worlds ? outline.first_body(pass + 1) : outline.bodies();
        const std::int64_t own = outline.first_triangle(end) - outline.first_triangle(begin);
        const std::int64_t others = pass < worlds ? outline.triangles() - outline.first_triangle(rest) : 0;
        if (own == 0 || own + others < 2) continue;
        caller_worlds_.push_back(pass);
        triangles += own + others;
        vertices += vertices_of(begin, end) + (pass < worlds ? static_vertices : 0);
        if (caller_worlds_.size() > 1 && triangles > most_triangles) return false;
        if (static_cast<std::int64_t>(caller_worlds_.size()) > worlds_at_once) return false;
        if (std::max(triangles, vertices) > std::numeric_limits<std::int32_t>::max()) return false;
    }
    return true;
}

void StaticWorlds::add_shapes() {
    std::int64_t rows = 0;
    for (const Shape& shape : shapes_) {
        shape_first_.push_back(static_cast<std::uint32_t>(rows));
        rows += shape.vertices.rows;
    }
    if (rows > std::numeric_limits<std::int32_t>::max())
        throw Error(ErrorCode::invalid_argument, "shapes have more than 2147483647 vertices together");
    const std::size_t scalar = scene_.float32 ? sizeof(float) : sizeof(double);
    std::byte* out = shape_vertices_.resize_discard(3 * static_cast<std::size_t>(rows) * scalar);
    const auto put = [&](auto value) {
        std::memcpy(out, &value, sizeof value);
        out += sizeof value;
    };
    for (const Shape& shape : shapes_) {
        const VertexReader position = reader_of(shape);
        for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
            const Vec3d p = position(v);
            for (int axis = 0; axis < 3; ++axis) scene_.float32 ? put(static_cast<float>(p[axis])) : put(p[axis]);
        }
    }
    for (StaticBody& added : bodies_)
        added.shape_vertex = shape_first_[static_cast<std::size_t>(all_[added.body].shape)];
    for (const Shape& shape : shapes_) {
        Array<std::uint64_t>& words = contents_.emplace_back(&meter_);
        for_each_word(shape, [&](std::uint64_t word) {
            words.push_back(word);
            return true;
        });
    }
}

// Builds the scene, with all bodies unposed.
void StaticWorlds::add_bodies(ParallelFor& workers) {
    const WorldOutline& outline = read_->outline;
    WorldScene& scene = *read_->scene;
    const std::int32_t worlds = outline.worlds(), rest = outline.first_body(worlds);
    const bool float32 = std::all_of(shapes_.begin(), shapes_.end(),
                                     [](const Shape& s) { return s.vertices.type == ScalarType::float32; });
    scene.begin(float32, body_filter_);
    const auto add = [&](std::int32_t b, bool everywhere) {
        const auto first = static_cast<std::int32_t>(scene.triangles());
        const bool rounded = outline.shape(b).vertices.type == ScalarType::float32;
        bodies_.push_back({static_cast<std::uint32_t>(scene.vertices()), 0, b, rounded});
        first_of_occurrence_.push_back(first);
        scene.add(outline, b, everywhere, workers);
        while (first_of_class_.size() < body_filter_.classes.size()) first_of_class_.push_back(first);
    };
    first_of_caller_world_.assign(static_cast<std::size_t>(worlds) + 1, 0);
    std::int32_t world = 0;
    const auto begin_worlds = [&](std::int32_t up_to) {
        for (; world <= up_to; ++world) first_of_caller_world_[world] = scene.triangles();
    };
    for (const std::int32_t pass : caller_worlds_) {
        begin_worlds(pass);
        first_of_scene_world_.push_back(scene.triangles());
        const std::int32_t end = pass < worlds ? outline.first_body(pass + 1) : outline.bodies();
        for (std::int32_t b = outline.first_body(pass); b < end; ++b) add(b, false);
        if (pass < worlds)
            for (std::int32_t b = rest; b < outline.bodies(); ++b) add(b, true);
        scene.end_world();
    }
    begin_worlds(worlds);
    first_of_occurrence_.push_back(scene.triangles());
    first_of_scene_world_.push_back(scene.triangles());
    scene_ = scene.scene(outline, false, workers);
    if (scene_.worlds > 1) scene_.first_of_world = first_of_scene_world_.data();
}

bool StaticWorlds::is_of(const World& world, const PairFilter& rules) const {
    if (world.shapes.size() != shapes_.size()) return false;
    bool same = true;
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
        const Shape &given = world.shapes[s], &known = shapes_[s];
        const bool fits = same_size(given, known);
        if (given.name != 0 && given.name == known.name && !fits)
            throw Error(ErrorCode::invalid_argument,
                        "shape " + std::to_string(s) + ": an earlier shape with the name " +
                            std::to_string(given.name) +
                            " had another size or precision; a changed shape needs another name",
                        Element::shape, static_cast<std::int64_t>(s));
        same = same && fits && given.name == known.name && given.groups.size() == known.groups.size();
        if (!same) continue;
        const std::uint64_t* word = contents_[s].begin();
        same = for_each_word(given, [&](std::uint64_t value) { return value == *word++; });
    }
    return same && same_filter(rules, given_) &&
           std::equal(world.bodies.begin(), world.bodies.end(), all_.begin(), all_.end(), same_body);
}

void StaticWorlds::drop_lists() {
    read_->scene.reset();
    shape_vertices_.release();
    scene_.corners = scene_.groups = nullptr;
    scene_.reader = {};
}

void StaticWorlds::fail_not_finite(std::int64_t vertex, std::span<const Pose> poses) const {
    for (std::size_t b = 0; b < poses.size(); ++b)
        if (!std::ranges::all_of(poses[b].rows, [](double x) { return std::isfinite(x); }))
            throw Error(ErrorCode::invalid_argument,
                        WorldOutline::name(static_cast<std::int32_t>(b)) + "its pose is not finite", Element::body,
                        static_cast<std::int64_t>(b));
    const auto after =
        std::upper_bound(bodies_.begin(), bodies_.end(), vertex,
                         [](std::int64_t v, const StaticBody& added) { return v < std::int64_t{added.first_vertex}; });
    const StaticBody& added = *std::prev(after);
    const std::int64_t within = vertex - added.first_vertex;
    throw Error(ErrorCode::not_finite,
                WorldOutline::name(added.body) + "vertex " + std::to_string(within) + " is posed to infinity",
                Element::vertex, within);
}

void StaticWorlds::begin(const IntersectionQuery& query, Intersections& result) const {
    clear(result, read_->outline, query);
}
void StaticWorlds::finish(const IntersectionQuery& query, Intersections& result) const {
    crumple::finish(read_->outline, query, result);
}

void StaticWorlds::report_flags(std::span<const std::uint8_t> flags, Intersections& result) const {
    for (std::size_t w = 0; w < flags.size(); ++w)
        if (flags[w]) hit(caller_worlds_[w], read_->outline, result);
}

std::size_t StaticWorlds::added_of_triangle(std::int64_t t) const {
    const auto after = std::upper_bound(first_of_occurrence_.begin(), first_of_occurrence_.end(), t);
    return static_cast<std::size_t>(after - first_of_occurrence_.begin()) - 1;
}

// Requires that `found` lists the pairs world by world.
void StaticWorlds::report_pairs(const Intersections& found, const IntersectionQuery& query,
                                Intersections& result) const {
    std::size_t world = 0;
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
        const Pair& pair = found.pairs[i];
        while (pair.a >= first_of_scene_world_[world + 1]) ++world;
        const std::size_t a = added_of_triangle(pair.a), b = added_of_triangle(pair.b);
        add_pair(read_->outline, query, caller_worlds_[world], {bodies_[a].body, bodies_[b].body},
                 {static_cast<std::int32_t>(pair.a - first_of_occurrence_[a]),
                  static_cast<std::int32_t>(pair.b - first_of_occurrence_[b])},
                 result);
        const Contacts& c = found.contacts;
        if (query.output == Output::contacts)
            add_contact(c.kinds[i], {c.points.data() + c.offsets[i], c.points.data() + c.offsets[i + 1]}, result);
    }
}

}  // namespace crumple
