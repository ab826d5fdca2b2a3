// Compares impacts, proximities and candidates of worlds with those of all bodies as one soup, filtered by worlds and
// pair filter, body by body.

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "candidates/compare_candidates.h"
#include "features/compare_features.h"
#include "features/moving_worlds.h"
#include "features/tested_detectors.h"
#include "features/triangle_pairs.h"
#include "queries/feature_request.h"

namespace crumple::test {
namespace {

/// A row of a result, in the order of results. `world`: world of the pair; pairs of bodies that are in all worlds come
/// last.
struct Line {
    std::size_t kind;
    std::int64_t world;
    std::int32_t first_body, first, second_body, second;
    double value;
    bool flag;
    friend auto operator<=>(const Line&, const Line&) = default;
    friend std::ostream& operator<<(std::ostream& out, const Line& line) {
        return out << candidate_kind_name(static_cast<CandidateKind>(line.kind)) << ' ' << line.first << " of body "
                   << line.first_body << " with " << line.second << " of body " << line.second_body << " of world "
                   << line.world << ": " << line.value << ' ' << line.flag;
    }
};

// Impacts and proximities have the first two kinds of candidates. Candidates have neither value nor flag.
static_assert(static_cast<int>(CandidateKind::edge_edge) == static_cast<int>(FeatureKind::edge_edge));
template <class List>
double value_of(const List& list, std::size_t i) {
    if constexpr (std::is_same_v<List, CandidateList>)
        return 0;
    else
        return values_of(list)[i];
}
template <class List>
bool flag_of(const List& list, std::size_t i) {
    if constexpr (std::is_same_v<List, CandidateList>)
        return false;
    else
        return flags_of(list)[i] != 0;
}

constexpr auto of_triangles = static_cast<std::size_t>(CandidateKind::face_face);
constexpr std::int64_t in_all_worlds = std::numeric_limits<std::int32_t>::max();

/// All bodies as one soup at their posed coordinates, and the body of each feature.
class Together {
   public:
    explicit Together(const World& world) : world_(world) {
        for (std::size_t b = 0; b < world.bodies.size(); ++b) {
            const Shape& shape = shape_of(b);
            const auto first = static_cast<std::int32_t>(soup_.start.size());
            first_vertex_.push_back(first);
            first_triangle_.push_back(static_cast<std::int32_t>(soup_.triangles.size()));
            const auto& end_poses = world.end_poses.empty() ? world.poses : world.end_poses;
            for (std::int64_t v = 0; v < shape.vertices.rows; ++v)
                soup_.vertex(posed(shape.vertices, v, world.poses, b),
                             posed(shape.end.data ? shape.end : shape.vertices, v, end_poses, b));
            std::set<Edge> edges;
            for (std::int64_t t = 0; t < shape.triangles.rows; ++t) {
                std::array<std::int32_t, 3> corner{};
                std::memcpy(corner.data(), static_cast<const char*>(shape.triangles.data) + t * 12, 12);
                const std::int32_t group =
                    shape.groups.empty() ? world.bodies[b].group : shape.groups[static_cast<std::size_t>(t)];
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::int32_t v = corner[k], w = corner[(k + 1) % 3];
                    vertex_group_.emplace(first + v, group);
                    if (v == w) continue;
                    edges.insert({std::min(v, w), std::max(v, w)});
                    edge_group_.emplace(Edge{first + std::min(v, w), first + std::max(v, w)}, group);
                }
                triangle_group_.push_back(group);
                soup_.triangles.push_back({first + corner[0], first + corner[1], first + corner[2]});
            }
            edges_.emplace_back(edges.begin(), edges.end());
        }
    }
    const MovingSoup<>& soup() const { return soup_; }
    const std::vector<std::vector<Edge>>& edges() const { return edges_; }

    /// Returns the rows of a result about the soup that pass the filter.
    template <class Result>
    std::vector<Line> lines(const Result& result, const PairFilter& filter) const {
        std::vector<Line> lines;
        for (std::size_t kind = 0; kind < result.lists.size(); ++kind) {
            const auto& list = result.lists[kind];
            const FeatureTypes types = types_of(static_cast<CandidateKind>(kind));
            for (std::size_t i = 0; i < list.pairs.size(); ++i) {
                const Place a = place(result, types.first, list.pairs[i].a),
                            b = place(result, types.second, list.pairs[i].b);
                if (passes(a, b, filter)) lines.push_back(line(kind, a, b, value_of(list, i), flag_of(list, i)));
            }
        }
        std::sort(lines.begin(), lines.end());
        return lines;
    }

    /// Returns the rows of the pairs of triangles that pass the filter, from impacts whose features pass it.
    std::vector<Line> triangle_lines(const Impacts& all, bool weld, const PairFilter& filter) const {
        Impacts impacts;
        impacts.edges = all.edges;
        for (std::size_t kind = 0; kind < feature_kinds; ++kind) {
            const FeatureTypes types = types_of(static_cast<CandidateKind>(kind));
            const ImpactList& list = all.lists[kind];
            for (std::size_t i = 0; i < list.pairs.size(); ++i) {
                const Pair pair = list.pairs[i];
                if (!passes(place(all, types.first, pair.a), place(all, types.second, pair.b), filter)) continue;
                impacts.lists[kind].pairs.push_back(pair);
                impacts.lists[kind].toi.push_back(list.toi[i]);
                impacts.lists[kind].start.push_back(list.start[i]);
            }
        }
        std::vector<Line> lines;
        for (const auto& [pair, found] : triangle_pairs_of(soup_, impacts, weld)) {
            const Place a = triangle(pair.a), b = triangle(pair.b);
            if (passes(a, b, filter)) lines.push_back(line(of_triangles, a, b, found.toi, found.start));
        }
        std::sort(lines.begin(), lines.end());
        return lines;
    }

   private:
    struct Place {
        std::size_t body;
        std::int32_t index, group;
    };

    template <class Result>
    Place place(const Result& result, FeatureType type, std::int32_t i) const {
        return type == FeatureType::vertex ? vertex(i)
               : type == FeatureType::edge ? edge(result.edges[i])
                                           : triangle(i);
    }
    Line line(std::size_t kind, const Place& a, const Place& b, double value, bool flag) const {
        const std::int32_t in = std::max(world_.bodies[a.body].world, world_.bodies[b.body].world);
        return {kind,
                in < 0 ? in_all_worlds : in,
                static_cast<std::int32_t>(a.body),
                a.index,
                static_cast<std::int32_t>(b.body),
                b.index,
                value,
                flag};
    }
    const Shape& shape_of(std::size_t b) const {
        return world_.shapes[static_cast<std::size_t>(world_.bodies[b].shape)];
    }
    PointOf<double> posed(const VertexView& view, std::int64_t v, std::span<const Pose> poses, std::size_t b) const {
        const bool narrow = view.type == ScalarType::float32;
        PointOf<double> p{}, out{};
        for (std::size_t k = 0; k < 3; ++k) {
            const char* at = static_cast<const char*>(view.data) + v * view.row_stride;
            p[k] = narrow ? reinterpret_cast<const float*>(at)[k] : reinterpret_cast<const double*>(at)[k];
        }
        if (poses.empty() || poses[b] == Pose()) return p;
        for (std::size_t k = 0; k < 3; ++k) {
            const double* r = poses[b].rows.data() + 4 * k;
            out[k] = ((r[0] * p[0] + r[1] * p[1]) + r[2] * p[2]) + r[3];
            if (narrow) out[k] = static_cast<float>(out[k]);
        }
        return out;
    }
    static std::size_t body_of(std::int32_t index, const std::vector<std::int32_t>& first) {
        return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), index) - first.begin()) - 1;
    }
    Place vertex(std::int32_t v) const {
        const std::size_t b = body_of(v, first_vertex_);
        return {b, v - first_vertex_[b], vertex_group_.at(v)};
    }
    Place triangle(std::int32_t t) const {
        const std::size_t b = body_of(t, first_triangle_);
        return {b, t - first_triangle_[b], triangle_group_[static_cast<std::size_t>(t)]};
    }
    Place edge(const Edge& e) const {
        const std::size_t b = body_of(e.a, first_vertex_);
        const Edge inside{e.a - first_vertex_[b], e.b - first_vertex_[b]};
        const auto at = std::lower_bound(edges_[b].begin(), edges_[b].end(), inside);
        return {b, static_cast<std::int32_t>(at - edges_[b].begin()), edge_group_.at(e)};
    }
    bool passes(const Place& a, const Place& b, const PairFilter& filter) const {
        const Body &p = world_.bodies[a.body], &q = world_.bodies[b.body];
        if (p.world != q.world && p.world != -1 && q.world != -1) return false;
        if (a.body == b.body ? !p.self || filter.bodies == PairScope::between : filter.bodies == PairScope::within)
            return false;
        if (a.group == b.group ? filter.groups == PairScope::between : filter.groups == PairScope::within) return false;
        const auto names = [](const auto& excluded, std::int64_t x, std::int64_t y) {
            return std::any_of(excluded.begin(), excluded.end(), [&](const auto& e) {
                return (e.first == x && e.second == y) || (e.first == y && e.second == x);
            });
        };
        return !names(filter.excluded_bodies, static_cast<std::int64_t>(a.body), static_cast<std::int64_t>(b.body)) &&
               !names(filter.excluded_groups, a.group, b.group);
    }

    World world_;
    MovingSoup<> soup_;
    std::vector<std::int32_t> first_vertex_, first_triangle_, triangle_group_;
    std::vector<std::vector<Edge>> edges_;
    std::map<std::int32_t, std::int32_t> vertex_group_;
    std::map<Edge, std::int32_t> edge_group_;
};

template <class List>
void add_lines(const World& world, std::size_t kind, const List& list, std::vector<Line>& lines) {
    EXPECT_EQ(list.bodies.size(), list.pairs.size());
    for (std::size_t i = 0; i < list.pairs.size(); ++i) {
        const auto [a, b] = list.bodies[i];
        const auto in = [&](std::int32_t body) { return world.bodies[static_cast<std::size_t>(body)].world; };
        const std::int64_t of = std::max(in(a), in(b)) < 0 ? in_all_worlds : std::max(in(a), in(b));
        lines.push_back({kind, of, a, list.pairs[i].a, b, list.pairs[i].b, value_of(list, i), flag_of(list, i)});
    }
}
template <class Result>
std::vector<Line> lines_of(const World& world, const Result& result) {
    std::vector<Line> lines;
    for (std::size_t kind = 0; kind < result.lists.size(); ++kind) add_lines(world, kind, result.lists[kind], lines);
    return lines;
}

void expect_same(const std::vector<Line>& found, const std::vector<Line>& expected) {
    for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
        ASSERT_EQ(found[i], expected[i]) << "line " << i;
    ASSERT_EQ(found.size(), expected.size());
}
template <class Result>
void expect_edges(const Result& result, const std::vector<std::vector<Edge>>& expected) {
    ASSERT_EQ(result.first_edge.size(), expected.size() + 1);
    for (std::size_t b = 0; b < expected.size(); ++b) {
        const auto edges =
            result.edges.span().subspan(static_cast<std::size_t>(result.first_edge[b]),
                                        static_cast<std::size_t>(result.first_edge[b + 1] - result.first_edge[b]));
        EXPECT_EQ(std::vector<Edge>(edges.begin(), edges.end()), expected[b]) << "body " << b;
    }
    EXPECT_EQ(result.first_edge.back(), static_cast<std::int64_t>(result.edges.size()));
}
/// Returns, for each world with rows, the row with the lowest value, and of several the first.
std::map<std::int64_t, Line> first_by_world(const std::vector<Line>& lines) {
    std::map<std::int64_t, Line> first;
    for (const Line& line : lines) {
        const auto [at, fresh] = first.emplace(line.world, line);
        if (!fresh && line.value < at->second.value) at->second = line;
    }
    return first;
}
void expect_first(const FirstImpact& found, const Line* expected) {
    ASSERT_EQ(found.found, expected != nullptr);
    if (!expected) return;
    const Line line{static_cast<std::size_t>(found.kind),
                    expected->world,
                    found.bodies.first,
                    found.pair.a,
                    found.bodies.second,
                    found.pair.b,
                    found.toi,
                    found.start};
    EXPECT_EQ(line, *expected);
}

class FeaturesOfWorlds : public testing::TestWithParam<unsigned> {
   protected:
    void compare(const WorldKind& kind) {
        const auto moving = moving_world(GetParam(), kind);
        const World world = moving->view();
        const Together together(world);
        const MovingSoup<>& soup = together.soup();
        Detector detector({.backend = tested_backend, .threads = 2, .leaf_size = 8});
        Detector single({.backend = Backend::cpu, .threads = 1});
        for (unsigned i = 0; i < 3; ++i) {
            SCOPED_TRACE(testing::Message() << "question " << i);
            const IntersectionQuery drawn = random_query(5 * GetParam() + i, kind.bodies);
            ImpactQuery motion{.weld = drawn.weld, .filter = drawn.filter};
            const Impacts& all = single.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.weld = drawn.weld});
            const std::vector<Line> lines = together.lines(all, drawn.filter);
            expect_impacts(detector, world, motion, lines, together.edges());
            expect_triangle_pairs(detector, world, motion, lines,
                                  together.triangle_lines(all, drawn.weld, drawn.filter));
            ProximityQuery near{.radius = i * 0.05, .weld = drawn.weld, .filter = drawn.filter};
            const std::vector<Line> near_lines = together.lines(
                single.find(soup.view(), ProximityQuery{.radius = near.radius, .weld = near.weld}), drawn.filter);
            const Proximities& nearby = detector.find(world, near);
            expect_same(lines_of(world, nearby), near_lines);
            expect_edges(nearby, together.edges());
            EXPECT_EQ(nearby.any, !near_lines.empty());
            EXPECT_EQ(nearby.count, static_cast<std::int64_t>(near_lines.size()));
            expect_hits(nearby.world_hit, near_lines);
            near.output = Output::any_by_world;
            expect_hits(detector.find(world, near).world_hit, near_lines);
            near.output = Output::any;
            EXPECT_EQ(detector.find(world, near).any, !near_lines.empty());
            const CandidateQuery candidates{
                .kinds = all_candidate_kinds(), .inflation = i * 0.05, .weld = drawn.weld, .filter = drawn.filter};
            CandidateQuery of_soup = candidates;
            of_soup.filter = {};
            const std::vector<Line> candidate_lines =
                together.lines(single.find(soup.view().moving_to(soup.end_view()), of_soup), drawn.filter);
            const Candidates& lists = detector.find(world, candidates);
            expect_same(lines_of(world, lists), candidate_lines);
            expect_edges(lists, together.edges());
            EXPECT_EQ(lists.count, static_cast<std::int64_t>(candidate_lines.size()));
            if (!HasFatalFailure()) compare_radii(world, together, near.filter, detector, single);
            if (HasFatalFailure()) return;
        }
    }

    static void expect_triangle_pairs(Detector& detector, const World& world, ImpactQuery motion,
                                      std::vector<Line> lines, const std::vector<Line>& of_triangles_alone) {
        motion.triangle_pairs = true;
        const Impacts& impacts = detector.find(world, motion);
        expect_same(lines_of(world, impacts), lines);
        std::vector<Line> found;
        add_lines(world, of_triangles, impacts.triangle_pairs, found);
        expect_same(found, of_triangles_alone);
        lines.insert(lines.end(), of_triangles_alone.begin(), of_triangles_alone.end());
        EXPECT_EQ(impacts.any, !lines.empty());
        expect_hits(impacts.world_hit, lines);
        motion.output = Output::any_by_world;
        expect_hits(detector.find(world, motion).world_hit, lines);
    }

    // Compares proximities of worlds with those of the soup, with radii, rings of adjacent triangles, and rest shapes.
    // The shape at the end of the step is used as the rest shape.
    static void compare_radii(const World& world, const Together& together, const PairFilter& filter,
                              Detector& detector, Detector& single) {
        Dice dice(GetParam());
        std::vector<std::vector<double>> of_shape;
        for (const Shape& shape : world.shapes) {
            of_shape.emplace_back(static_cast<std::size_t>(shape.vertices.rows));
            for (double& r : of_shape.back()) r = dice.chance(0.3) ? 0 : dice.between(0, 0.1);
        }
        std::vector<Shape> shapes(world.shapes.begin(), world.shapes.end());
        std::vector<double> radii;
        for (std::size_t s = 0; s < shapes.size(); ++s)
            if (s != 1) shapes[s].radii = of_shape[s];
        for (const Body& body : world.bodies) {
            const auto s = static_cast<std::size_t>(body.shape);
            const std::size_t before = radii.size();
            radii.insert(radii.end(), of_shape[s].begin(), of_shape[s].end());
            if (s == 1) std::fill(radii.begin() + static_cast<std::ptrdiff_t>(before), radii.end(), 0);
        }
        const World with_radii{shapes, world.bodies, world.poses};
        for (const bool weld : {false, true}) {
            const Proximities& all =
                single.find(together.soup().view(), ProximityQuery{.radii = radii, .weld = weld, .rings = 1});
            const ProximityQuery query{.weld = weld, .rings = 1, .filter = filter};
            expect_same(lines_of(world, detector.find(with_radii, query)), together.lines(all, filter));
        }
        for (std::size_t s = 0; s < shapes.size(); ++s)
            if (s != 2) shapes[s].rest = world.shapes[s].end;
        const bool any_rest = std::any_of(shapes.begin(), shapes.end(), [](const Shape& s) { return s.rest.data; });
        Detector brute({.backend = Backend::reference});
        const ProximityQuery query{.rest_radius = any_rest ? 0.1 : 0, .filter = filter};
        const Proximities& expected = brute.find(with_radii, query);
        EXPECT_TRUE(same_features(detector.find(with_radii, query), expected));
    }

    // Expects each world with rows to have an entry in an array per world.
    static void expect_entries(std::size_t size, const std::map<std::int64_t, Line>& first) {
        for (const auto& [world, line] : first) {
            if (world == in_all_worlds) continue;
            EXPECT_LT(world, static_cast<std::int64_t>(size));
        }
    }
    static void expect_hits(const Array<std::uint8_t>& hits, const std::vector<Line>& lines) {
        const auto first = first_by_world(lines);
        expect_entries(hits.size(), first);
        for (std::size_t w = 0; w < hits.size(); ++w)
            EXPECT_EQ(hits[w] != 0, first.count(static_cast<std::int64_t>(w)) > 0) << "world " << w;
    }
    static void expect_firsts(const Impacts& impacts, const std::vector<Line>& lines) {
        const auto first = first_by_world(lines);
        expect_entries(impacts.world_first.size(), first);
        for (std::size_t w = 0; w < impacts.world_first.size(); ++w) {
            const auto at = first.find(static_cast<std::int64_t>(w));
            expect_first(impacts.world_first[w], at == first.end() ? nullptr : &at->second);
        }
        const auto least = std::min_element(lines.begin(), lines.end(),
                                            [](const Line& a, const Line& b) { return a.value < b.value; });
        expect_first(impacts.first, lines.empty() ? nullptr : &*least);
        expect_hits(impacts.world_hit, lines);
        EXPECT_EQ(impacts.any, !lines.empty());
    }
    static void expect_impacts(Detector& detector, const World& world, ImpactQuery motion,
                               const std::vector<Line>& lines, const std::vector<std::vector<Edge>>& edges) {
        const Impacts& impacts = detector.find(world, motion);
        expect_same(lines_of(world, impacts), lines);
        expect_edges(impacts, edges);
        expect_firsts(impacts, lines);
        EXPECT_EQ(impacts.count, static_cast<std::int64_t>(lines.size()));
        motion.output = Output::first;
        detector.find(world, motion);
        expect_firsts(impacts, lines);
        expect_edges(impacts, edges);
        motion.output = Output::any_by_world;
        expect_hits(detector.find(world, motion).world_hit, lines);
        motion.output = Output::any;
        EXPECT_EQ(detector.find(world, motion).any, !lines.empty());
    }
};

TEST_P(FeaturesOfWorlds, results_of_bodies_match_one_soup) { compare({.bodies = 6, .triangles = 12}); }
TEST_P(FeaturesOfWorlds, results_of_several_worlds_match_one_soup) {
    compare({.bodies = 10, .worlds = 4, .triangles = 10, .everywhere = 0.3, .reach = 0.5});
}
TEST_P(FeaturesOfWorlds, results_of_bodies_in_all_worlds_match_one_soup) {
    compare({.bodies = 5, .triangles = 8, .everywhere = 1});
}
TEST_P(FeaturesOfWorlds, results_of_one_body_match_one_soup) { compare({.bodies = 1, .triangles = 30}); }
TEST_P(FeaturesOfWorlds, worlds_without_bodies_have_no_results) { compare({.bodies = 0}); }

INSTANTIATE_TEST_SUITE_P(Seeds, FeaturesOfWorlds, testing::Range(0u, played ? 3u : 12u));

TEST(FeaturesOfWorlds, static_worlds_have_impacts_at_the_start_only) {
    Detector detector({.backend = tested_backend}), brute({.backend = Backend::reference});
    std::int64_t impacts = 0;
    for (unsigned seed = 0; seed < (played ? 2u : 5u); ++seed) {
        const auto random = random_world(seed, {.bodies = 4, .triangles = 16, .reach = 0.5});
        const World world{random->shapes, random->bodies, random->poses};
        for (const auto& [distance, share] : {std::pair(0.0, 0.0), {0.1, 0.0}, {0.05, 0.5}}) {
            const ImpactQuery query{.min_distance = distance, .min_distance_share = share};
            const Impacts& expected = brute.find(world, query);
            const Impacts& found = detector.find(world, query);
            EXPECT_TRUE(same_features(found, expected)) << "seed " << seed << ", distance " << distance;
            for (const ImpactList& list : found.lists)
                for (std::size_t i = 0; i < list.toi.size(); ++i) EXPECT_TRUE(list.toi[i] == 0 && list.start[i] == 1);
            impacts += found.count;
            ImpactQuery approaching = query;
            approaching.approaching_only = true;
            EXPECT_FALSE(detector.any(world, approaching));
        }
    }
    EXPECT_GT(impacts, 100);
}

/// With a filter about groups, a mesh is not searched in place. Like a body of a world, it is first copied to a scene
/// of posed bodies. The result must still be that of a mesh.
TEST(FeaturesOfOneMesh, results_with_group_filters_have_offsets_and_no_bodies) {
    MovingSoup<> soup = moving_grid(4, 30, 24, 5);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(static_cast<std::int32_t>(t % 3));
    Detector detector({.backend = tested_backend}), plain({.backend = Backend::cpu});
    ImpactQuery motion{.index = true};
    ProximityQuery near{.radius = 1, .index = true};
    // No triangle is in group 7, so nothing is excluded.
    motion.filter.excluded_groups = near.filter.excluded_groups = {{7, 7}};
    EXPECT_TRUE(same_features(detector.find(soup.view().moving_to(soup.end_view()), motion),
                              plain.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.index = true})));
    EXPECT_TRUE(same_features(detector.find(soup.view(), near),
                              plain.find(soup.view(), ProximityQuery{.radius = 1, .index = true})));
    motion.filter.groups = PairScope::within;
    const Impacts& within = detector.find(soup.view().moving_to(soup.end_view()), motion);
    EXPECT_GT(within.count, 0);
    EXPECT_TRUE(within.vertex_faces().bodies.empty());
    EXPECT_EQ(within.vertex_faces().offsets.size(), soup.start.size() + 1);
}

}  // namespace
}  // namespace crumple::test
