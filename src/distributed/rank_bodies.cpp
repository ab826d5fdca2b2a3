#include "distributed/rank_bodies.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>

#include "queries/checks.h"
#include "scene/world_scene.h"

namespace crumple::distribute {
namespace {

[[noreturn]] void refuse_body(std::int64_t body, const std::string& what) {
    throw Error(ErrorCode::invalid_argument, "body " + std::to_string(body) + what, Element::body, body);
}

void check_total(std::int64_t total, const char* what) {
    if (total > most_ids)
        throw Error(ErrorCode::invalid_argument, "all ranks together have " + std::to_string(total) + " " + what +
                                                     "; at most 2147483647 are supported");
}

template <class Coordinates>
void reserve(Coordinates& coordinates, bool float32, std::int64_t rows) {
    const auto n = static_cast<std::size_t>(3 * rows);
    if (float32 != std::holds_alternative<std::vector<float>>(coordinates)) {
        if (float32)
            coordinates = std::vector<float>();
        else
            coordinates = std::vector<double>();
    }
    std::visit([n](auto& xyz) { xyz.resize(n); }, coordinates);
}

template <class Coordinates>
VertexView view_of(const Coordinates& coordinates) {
    return std::visit(
        [](const auto& xyz) { return rows_of_three(xyz.data(), static_cast<std::int64_t>(xyz.size() / 3)); },
        coordinates);
}

// Writes posed positions of a body. Returns true if all are finite.
template <class Coordinates>
bool put(const VertexReader& position, const crumple::Placement& place, std::int64_t first, std::int64_t rows,
         Coordinates& coordinates, ParallelFor& workers) {
    constexpr std::int64_t chunk = 8192;
    std::atomic<bool> finite = true;
    std::visit(
        [&](auto& xyz) {
            using Scalar = typename std::remove_cvref_t<decltype(xyz)>::value_type;
            workers.parallel_for(static_cast<std::size_t>((rows + chunk - 1) / chunk), [&](std::size_t c) {
                const std::int64_t begin = static_cast<std::int64_t>(c) * chunk;
                for (std::int64_t v = begin; v < std::min(rows, begin + chunk); ++v) {
                    const Vec3d p = place(position(v));
                    for (int axis = 0; axis < 3; ++axis) {
                        if (!std::isfinite(p[axis])) finite = false;
                        xyz[static_cast<std::size_t>(3 * (first + v) + axis)] = static_cast<Scalar>(p[axis]);
                    }
                }
            });
        },
        coordinates);
    return finite;
}

}  // namespace

void Bodies::forget() {
    table_.clear();
    kept_.clear();
    first_edge_.clear();
}

void Bodies::fail_with_id(const Error& error, std::int64_t body, std::int64_t id) {
    std::string message = error.what();
    if (id != body) message += " (body " + std::to_string(id) + " over all ranks)";
    throw Error(error.code, message, Element::body, id);
}

void Bodies::outline(const LocalWorld& local, const PairFilter& rules, bool moving) {
    given_ = local.body_ids;
    name_bodies_by_id([&] { outline_local(local, rules); });
    reserve_mesh(moving);
}

void Bodies::outline_whole(const LocalWorld& local, const PairFilter& rules) {
    given_ = local.body_ids;
    name_bodies_by_id([&] { outline_local(local, rules); });
    local_ = {};
    end_view_ = {};
}

// Runs read(). If it throws an error about a body, names the body by its id.
template <class Read>
void Bodies::name_bodies_by_id(Read read) {
    try {
        read();
    } catch (const Error& error) {
        const std::int64_t b = error.index;
        if (error.element != Element::body || b < 0 || b >= static_cast<std::int64_t>(given_.size())) throw;
        fail_with_id(error, b, std::max<std::int64_t>(given_[static_cast<std::size_t>(b)], 0));
    }
}

void Bodies::outline_local(const LocalWorld& local, const PairFilter& rules) {
    // The outline does not get the excluded pairs of bodies, because they have numbers over all ranks.
    check(!lies_on_device(local.world), "poses must be in host memory: ranks do not support poses in device memory");
    PairFilter known;
    known.bodies = rules.bodies, known.groups = rules.groups;
    outline_.read(local.world, known);
    rules_ = rules;
    by_groups_ = rules.groups != PairScope::both || !rules.excluded_groups.empty();
    const std::int32_t bodies = outline_.bodies();
    if (!given_.empty() && given_.size() != static_cast<std::size_t>(bodies))
        throw Error(ErrorCode::invalid_argument, "there are " + std::to_string(given_.size()) + " body ids for " +
                                                     std::to_string(bodies) + " bodies");
    for (std::int32_t b = 0; b < bodies; ++b) {
        check_shape(outline_.shape(b), b);
        if (outline_.body(b).world != 0) refuse_body(b, ": its world must be 0, because all ranks share one world");
    }
}

void Bodies::reserve_mesh(bool moving) {
    bool float32 = true;
    std::int64_t vertices = 0;
    for (std::int32_t b = 0; b < outline_.bodies(); ++b) {
        const Shape& shape = outline_.shape(b);
        float32 = float32 && shape.vertices.type == ScalarType::float32 &&
                  (!moving || !shape.end.data || shape.end.type == ScalarType::float32);
        vertices += shape.vertices.rows;
    }
    const std::int64_t triangles = outline_.triangles();
    check_total(triangles, "triangles");
    check_total(vertices, "vertices");
    const auto m = static_cast<std::size_t>(triangles);
    reserve(start_, float32, vertices);
    reserve(end_, float32, moving ? vertices : 0);
    corners_.resize(3 * m);
    groups_.resize(m);
    triangle_ids_.resize(m);
    vertex_ids_.resize(static_cast<std::size_t>(vertices));
    local_.mesh = MeshView(view_of(start_), rows_of_three(corners_.data(), triangles), groups_);
    local_.triangle_ids = triangle_ids_, local_.vertex_ids = vertex_ids_;
    end_view_ = view_of(end_);
}

void Bodies::check_shape(const Shape& shape, std::int32_t body) const {
    if (shape.edges || shape.points) refuse_body(body, ": ranks do not support a shape's list of edges or points");
    if (!shape.radii.empty()) refuse_body(body, ": ranks do not support a shape's radii; use the radius of the query");
    if (shape.rest.data || shape.rest.rows != 0) refuse_body(body, ": ranks do not support rest shapes");
}

void Bodies::number(Transport& transport, CollectiveCheck& agree) {
    if (!resolve_body_ids(transport, agree)) tabulate(transport, agree);
    agree(Phase::input, [&] {
        exchange_filters();
        give_numbers();
    });
}

void Bodies::number_whole(Transport& transport, CollectiveCheck& agree) {
    if (!resolve_body_ids(transport, agree)) tabulate(transport, agree);
    agree(Phase::input, [&] { check_excluded_bodies(); });
}

void Bodies::check_whole() const {
    for (std::int32_t b = 0; b < outline_.bodies(); ++b) {
        const Shape& shape = outline_.shape(b);
        const VertexReader position = reader_of(shape);
        const crumple::Placement place = outline_.placement(b);
        try {
            for (std::int64_t v = 0; v < shape.vertices.rows; ++v)
                if (!all_finite(place(position(v)))) fail_body_not_finite(outline_, b);
            with_corner_reader(shape, [&](auto corner) {
                for (std::int64_t t = 0; t < shape.triangles.rows; ++t)
                    for (int k = 0; k < 3; ++k)
                        if (const std::int64_t v = corner(t, k); v < 0 || v >= shape.vertices.rows)
                            fail_index(WorldOutline::name(b), t, v, shape.vertices.rows);
            });
        } catch (const Error& error) {
            fail_with_id(error, b, id_of(b));
        }
    }
}

// Checks ids of bodies. Returns true if the table of the previous call is still valid.
bool Bodies::resolve_body_ids(Transport& transport, CollectiveCheck& agree) {
    std::vector<std::int64_t> bodies(static_cast<std::size_t>(transport.size()) + 2, 0);
    const auto rank = static_cast<std::size_t>(transport.rank());
    bodies[rank] = outline_.bodies();
    bodies.back() = !given_.empty();
    transport.reduce(bodies, Reduction::sum);
    const bool ids = bodies.back() != 0;
    first_body_ = 0;
    std::int64_t all = 0;
    for (std::size_t r = 0; r + 2 < bodies.size(); ++r) {
        if (r < rank) first_body_ += bodies[r];
        all += bodies[r];
    }
    std::vector<std::pair<std::int64_t, Row>> rows;
    agree(Phase::input, [&] {
        check_total(all, "bodies");
        check(!ids || !given_.empty() || outline_.bodies() == 0,
              "body_ids are missing on this rank, but another rank has them");
        for (std::int32_t b = 0; b < outline_.bodies(); ++b) {
            const std::int64_t id = id_of(b);
            if (id < 0 || id >= all)
                throw Error(ErrorCode::invalid_argument,
                            "body " + std::to_string(b) + " has the id " + std::to_string(id) + ", but ids are 0 to " +
                                std::to_string(all - 1),
                            Element::body, std::max<std::int64_t>(id, 0));
            const Shape& shape = outline_.shape(b);
            rows.push_back({id,
                            {1, static_cast<std::int64_t>(rank), shape.triangles.rows, shape.vertices.rows,
                             outline_.body(b).self}});
        }
    });
    std::int64_t same = rows == kept_ && static_cast<std::int64_t>(table_.size()) == all;
    transport.reduce({&same, 1}, Reduction::min);
    kept_ = std::move(rows);
    if (same) return true;
    agree(Phase::input, [&] { table_.assign(static_cast<std::size_t>(all), {}); });
    return false;
}

void Bodies::tabulate(Transport& transport, CollectiveCheck& agree) {
    static_assert(sizeof(Row) == 5 * sizeof(std::int64_t));
    std::vector<std::int64_t> numbers;
    agree(Phase::input, [&] {
        numbers.assign(5 * table_.size(), 0);
        for (const auto& [id, row] : kept_) {
            std::int64_t* const of = numbers.data() + 5 * id;
            of[0] += row.providers, of[1] += row.rank;
            of[2] += row.triangles, of[3] += row.vertices, of[4] += row.self;
        }
    });
    transport.reduce(numbers, Reduction::sum);
    agree(Phase::input, [&] {
        first_triangle_.assign(1, 0);
        first_vertex_.assign(1, 0);
        for (std::size_t b = 0; b < table_.size(); ++b) {
            const std::int64_t* const of = numbers.data() + 5 * b;
            const auto id = static_cast<std::int64_t>(b);
            if (of[0] == 0) refuse_body(id, " is missing: no rank provides it");
            if (of[0] > 1) refuse_body(id, " is provided " + std::to_string(of[0]) + " times");
            table_[b] = {of[0], of[1], of[2], of[3], of[4]};
            first_triangle_.push_back(first_triangle_.back() + table_[b].triangles);
            first_vertex_.push_back(first_vertex_.back() + table_[b].vertices);
        }
        check_total(first_triangle_.back(), "triangles");
        check_total(first_vertex_.back(), "vertices");
        first_edge_.clear();
    });
}

void Bodies::check_excluded_bodies() const {
    const auto n = static_cast<std::int64_t>(table_.size());
    for (const BodyPair& pair : rules_.excluded_bodies)
        for (const std::int32_t b : {pair.first, pair.second})
            if (b < 0 || b >= n)
                throw Error(ErrorCode::invalid_argument,
                            "excluded_bodies names body " + std::to_string(b) + " of " + std::to_string(n),
                            Element::body, b);
}

// Converts the pair filter to one of the groups of the local mesh. If Body::self of a body is false, excludes the pair
// of its group with itself.
void Bodies::exchange_filters() {
    const auto n = static_cast<std::int64_t>(table_.size());
    check_excluded_bodies();
    const auto alone = [](const Row& row) { return row.self != 0; };
    const bool all_self = std::all_of(table_.begin(), table_.end(), alone),
               none_self = std::none_of(table_.begin(), table_.end(), alone);
    group_filter_ = {};
    if (by_groups_) {
        check(all_self && rules_.bodies == PairScope::both && rules_.excluded_bodies.empty(),
              "ranks support a filter of groups or a filter of bodies (including Body::self), not both");
        group_filter_.groups = rules_.groups;
        group_filter_.excluded_groups = rules_.excluded_groups;
        return;
    }
    group_filter_.groups = rules_.bodies;
    for (const BodyPair& pair : rules_.excluded_bodies)
        group_filter_.excluded_groups.push_back({pair.first, pair.second});
    if (none_self && rules_.bodies == PairScope::both) {
        group_filter_.groups = PairScope::between;
        return;
    }
    if (rules_.bodies == PairScope::between) return;
    for (std::int32_t b = 0; b < n; ++b)
        if (!alone(table_[static_cast<std::size_t>(b)])) group_filter_.excluded_groups.push_back({b, b});
}

void Bodies::give_numbers() {
    std::size_t t = 0, v = 0;
    for (std::int32_t b = 0; b < outline_.bodies(); ++b) {
        const Shape& shape = outline_.shape(b);
        const std::int64_t id = id_of(b);
        const auto at = static_cast<std::size_t>(id);
        for (std::int64_t i = 0; i < shape.vertices.rows; ++i) vertex_ids_[v++] = first_vertex_[at] + i;
        for (std::int64_t i = 0; i < shape.triangles.rows; ++i, ++t) {
            triangle_ids_[t] = first_triangle_[at] + i;
            groups_[t] = !by_groups_            ? static_cast<std::int32_t>(id)
                         : shape.groups.empty() ? outline_.body(b).group
                                                : shape.groups[static_cast<std::size_t>(i)];
        }
    }
}

void Bodies::pose(ParallelFor& workers) {
    std::int64_t vertex = 0, triangle = 0;
    for (std::int32_t b = 0; b < outline_.bodies(); ++b) {
        try {
            pose_body(b, vertex, triangle, workers);
        } catch (const Error& error) {
            fail_with_id(error, b, id_of(b));
        }
        vertex += outline_.shape(b).vertices.rows;
        triangle += outline_.shape(b).triangles.rows;
    }
}

void Bodies::pose_body(std::int32_t body, std::int64_t first_vertex, std::int64_t first_triangle,
                       ParallelFor& workers) {
    const Shape& shape = outline_.shape(body);
    const std::int64_t n = shape.vertices.rows;
    bool finite = put(reader_of(shape), outline_.placement(body), first_vertex, n, start_, workers);
    if (end_view_.rows > 0)
        finite &= put(end_reader_of(shape), outline_.end_placement(body), first_vertex, n, end_, workers);
    if (!finite) fail_body_not_finite(outline_, body);
    with_corner_reader(shape, [&](auto corner) {
        for (std::int64_t t = 0; t < shape.triangles.rows; ++t)
            for (int k = 0; k < 3; ++k) {
                const std::int64_t v = corner(t, k);
                if (v < 0 || v >= n) fail_index(WorldOutline::name(body), t, v, n);
                corners_[static_cast<std::size_t>(3 * (first_triangle + t) + k)] =
                    static_cast<std::int32_t>(first_vertex + v);
            }
    });
}

void Bodies::count_edges(Transport& transport, CollectiveCheck& agree, const FeatureOwners& features) {
    if (!first_edge_.empty()) return;
    std::vector<std::int64_t> edges;
    agree(Phase::rows, [&] {
        edges.assign(table_.size(), 0);
        std::int64_t t = 0;
        for (const auto& [id, row] : kept_)
            for (const std::int64_t end = t + row.triangles; t < end; ++t)
                for (int k = 0; k < 3; ++k) edges[static_cast<std::size_t>(id)] += features.of(t).owned >> (3 + k) & 1;
    });
    transport.reduce(edges, Reduction::sum);
    agree(Phase::rows, [&] {
        first_edge_.assign(1, 0);
        for (const std::int64_t count : edges) first_edge_.push_back(first_edge_.back() + count);
    });
}

Bodies::Within Bodies::within(std::span<const std::int64_t> first, std::int32_t id) {
    const auto after = std::upper_bound(first.begin(), first.end(), std::int64_t{id});
    const auto body = static_cast<std::int32_t>(after - first.begin()) - 1;
    return {body, static_cast<std::int32_t>(id - first[static_cast<std::size_t>(body)])};
}

}  // namespace crumple::distribute
