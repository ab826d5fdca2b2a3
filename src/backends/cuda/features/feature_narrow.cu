#include "backends/cuda/features/feature_narrow.h"

#include <algorithm>

#include "backends/cuda/device/block_counter.h"
#include "backends/cuda/device/warp_queue.h"
#include "backends/cuda/features/feature_decisions.h"
#include "filters/features/codimensional_tests.h"
#include "filters/features/feature_filters.h"
#include "filters/features/thresholds.h"

namespace crumple::cuda {
namespace {

/// Filter of tests: drops pairs of features that float32 proves to be too far apart, and pairs that vertex rings
/// exclude.
template <int moments>
struct TestFilter {
    PointRows points;
    std::int32_t ends;
    FeatureConditions asked;

    template <FeatureKind kind>
    __device__ bool keeps(const FeatureTest& test) const {
        return !far<kind>(test) && !(asked.rings.of && joined<kind>(test));
    }

   private:
    // Returns the sum of both features' radii, where a feature's radius is the largest of its vertices'. Without radii,
    // returns the query's distance. The sum needs no rounding up: its rounding error is less than what rounding up
    // added to the radii.
    template <FeatureKind kind>
    __device__ float distance(const std::int32_t (&v)[4]) const {
        const float* radius = asked.vertex_radius;
        if (!radius) return 2 * asked.inflation->half;
        const float second = radius[v[1]], last = max(radius[v[2]], radius[v[3]]);
        return kind == FeatureKind::edge_edge ? max(radius[v[0]], second) + last : radius[v[0]] + max(second, last);
    }
    template <FeatureKind kind>
    __device__ bool far(const FeatureTest& test) const {
        // A vertex against an edge or another vertex is handled as a vertex against a degenerate face.
        constexpr FeatureKind as = kind == FeatureKind::edge_edge ? kind : FeatureKind::vertex_face;
        FeatureVectors<moments> seen;
        for (int m = 0; m < moments; ++m) {
            const Vec3d from = points[test.vertex[0] + m * ends];
            for (int k = 0; k < 3; ++k) seen.to[m][k] = to_float(points[test.vertex[k + 1] + m * ends] - from);
        }
        float least = distance<kind>(test.vertex);
        if (asked.share > 0) least = max(least, share_to_filter(asked.share) * most_at_start<as>(seen));
        return surely_far<as>(seen, least);
    }
    template <FeatureKind kind>
    __device__ bool joined(const FeatureTest& test) const {
        constexpr int split = kind == FeatureKind::edge_edge ? 2 : 1;
        for (int i = 0; i < split; ++i)
            for (int k = split; k < 4; ++k)
                if (asked.rings.joined(asked.features.name(test.vertex[i]), asked.features.name(test.vertex[k])))
                    return true;
        return false;
    }
};

/// Tests of one kind in shared memory: those that wait for the filter, and those that it has kept.
struct TestPlaces {
    using Kept = ListQueue<FeatureTest, 64>;
    FeatureTest waiting[64];
    Kept::Places kept;
};

/// Queue of tests of one kind, which a warp filters 32 at a time.
template <FeatureKind kind, int moments>
class TestQueue {
   public:
    __device__ TestQueue(TestPlaces& places, const TestFilter<moments>& filter, const List<FeatureTest>& list)
        : waiting_(places.waiting), filter_(filter), list_(list), kept_(places.kept, list), lane_(threadIdx.x % 32) {}

    /// Queues the tests whose bits the lane passes; with `last`, also filters all tests that wait. All lanes of a warp
    /// call it together. Kernels call it from a single place for each queue, because its code is long.
    __device__ void add(const FeatureRecord<moments>* a, const FeatureRecord<moments>* b, unsigned bits, bool last) {
        for (;;) {
            const unsigned having = __ballot_sync(whole_warp, bits != 0);
            if (!having && !(last && count_)) break;
            if (bits) {
                const auto bit = static_cast<unsigned>(__ffs(static_cast<int>(bits)) - 1);
                write_test<kind>(*a, *b, bit,
                                 waiting_[count_ + static_cast<unsigned>(__popc(having & ((1u << lane_) - 1)))]);
                bits &= bits - 1;
            }
            count_ += static_cast<unsigned>(__popc(having));
            listed_ += static_cast<unsigned>(__popc(having));
            __syncwarp();
            if (count_ >= 32 || !having) test();
        }
    }
    /// Lists the last tests that the filter has kept. All threads of the block call it together.
    __device__ void list_rest(BlockShared& shared) { kept_.write(reserve_by_block(kept_.size(), list_.count, shared)); }
    __device__ unsigned long long listed() const { return listed_; }

   private:
    // Filters the last tests of the queue, up to 32.
    __device__ void test() {
        const unsigned n = min(count_, 32u);
        count_ -= n;
        FeatureTest test{};
        bool keep = false;
        if (lane_ < n) {
            test = waiting_[count_ + lane_];
            keep = filter_.template keeps<kind>(test);
        }
        kept_.add(keep, test);
    }

    FeatureTest* waiting_;
    const TestFilter<moments>& filter_;
    const List<FeatureTest>& list_;
    TestPlaces::Kept kept_;
    unsigned lane_, count_ = 0;
    unsigned long long listed_ = 0;
};

template <int threads>
struct ListShared {
    struct Warp {
        TestPlaces vertex_face, edge_edge;
    } warp[threads / 32];
    BlockShared block;
};

template <int threads, int moments>
__global__ void __launch_bounds__(threads) list_kernel(FeatureSurvivors<moments> survivors, TestFilter<moments> filter,
                                                       TestLists tests, FeatureHits hits, unsigned long long* listed) {
    auto& shared = dynamic_shared<ListShared<threads>>();
    auto& own = shared.warp[threadIdx.x / 32];
    TestQueue<FeatureKind::vertex_face, moments> vertex_face(own.vertex_face, filter, tests.of[0]);
    TestQueue<FeatureKind::edge_edge, moments> edge_edge(own.edge_edge, filter, tests.of[1]);
    const unsigned long long n = survivors.list.filled(), warps_end = (n + 31) / 32 * 32;
    bool last = false;
    for (unsigned long long i = grid_thread(); !last; i += grid_stride()) {
        last = i >= warps_end || has_ended(hits.end());
        const FeatureRecord<moments>*a = nullptr, *b = nullptr;
        TestsOfPair of_pair;
        if (i < n) {
            a = survivors.record + survivors.list.data[i].row;
            b = survivors.record + survivors.list.data[i].column;
            of_pair = tests_of_pair(*a, *b, [&](std::int32_t v) { return filter.asked.features.name(v); });
        }
        vertex_face.add(a, b, of_pair.vertex_face, last);
        edge_edge.add(a, b, of_pair.edge_edge, last);
    }
    vertex_face.list_rest(shared.block);
    edge_edge.list_rest(shared.block);
    add_by_block(threadIdx.x % 32 == 0 ? vertex_face.listed() + edge_edge.listed() : 0, listed, shared.block);
}

// Lists tests of all kinds, for scenes with codimensional edges and points. Each thread keeps its tests on its stack,
// not in a queue of its warp: such scenes are rods and particles, in which few pairs are near.
template <int moments>
__global__ void codimensional_tests_kernel(FeatureSurvivors<moments> survivors, TestFilter<moments> filter,
                                           TestLists tests, FeatureHits hits, unsigned long long* listed) {
    constexpr int most[feature_kinds] = {6, 9, 4, 1}, first[feature_kinds] = {0, 6, 15, 19};
    const unsigned long long n = survivors.list.filled(), warps_end = (n + 31) / 32 * 32;
    const FeatureTable& features = filter.asked.features;
    for (unsigned long long i = grid_thread(); i < warps_end && !has_ended(hits.end()); i += grid_stride()) {
        FeatureTest found[20];
        std::array<FeatureTest*, feature_kinds> next{found, found + first[1], found + first[2], found + first[3]};
        if (i < n)
            list_codimensional_tests(
                survivors.record[survivors.list.data[i].row], survivors.record[survivors.list.data[i].column], features,
                [&](std::int32_t v) { return features.name(v); }, next);
        const auto pass_on = [&]<FeatureKind kind>() {
            constexpr auto k = static_cast<std::size_t>(kind);
            const auto count = static_cast<int>(next[k] - (found + first[k]));
            for (int t = 0; t < most[k]; ++t) {
                const FeatureTest& test = found[first[k] + t];
                const bool has = t < count, keep = has && filter.template keeps<kind>(test);
                tally(has, listed);
                const unsigned long long place = append(keep, tests.of[k].count);
                if (keep && place < tests.of[k].capacity) tests.of[k].data[place] = test;
            }
        };
        pass_on.template operator()<FeatureKind::vertex_face>();
        pass_on.template operator()<FeatureKind::edge_edge>();
        pass_on.template operator()<FeatureKind::vertex_edge>();
        pass_on.template operator()<FeatureKind::vertex_vertex>();
    }
}

// Counts the lane's test if `is_hit`, by first feature, and lists it with its rank; if one hit is enough, only counts
// it in the list's counter. All lanes of a warp call it together.
__device__ void add(const FeatureHits& hits, bool is_hit, FeatureKind kind, const Pair& pair, const Decided& found) {
    if (hits.any) return tally(is_hit, hits.list.count);
    std::uint32_t first = 0, rank = 0;
    if (is_hit) {
        first = hits.firsts.joint(kind, pair.a);
        rank = static_cast<std::uint32_t>(atomicAdd(&hits.by_first[first], 1ull));
    }
    const unsigned long long place = append(is_hit, hits.list.count);
    if (is_hit && place < hits.list.capacity) hits.list.data[place] = {first, pair.b, rank, found.flag, found.value};
}

// Decides tests of one kind, one per thread. Appends left_open(test) to `open` for each test that is left open.
template <FeatureKind kind, class Decide, class Open, class LeftOpen>
__device__ void decide_each(const List<FeatureTest>& tests, const FeatureHits& hits, Decide decide,
                            const List<Open>& open, LeftOpen left_open) {
    const unsigned long long n = tests.filled(), warps_end = (n + 31) / 32 * 32;
    for (unsigned long long i = grid_thread(); i < warps_end && !has_ended(hits.end()); i += grid_stride()) {
        FeatureTest test{};
        Decided found{Outcome::apart};
        if (i < n) {
            test = tests.data[i];
            found = decide(test);
        }
        add(hits, found.outcome == Outcome::hit, kind, test.pair, found);
        const bool is_open = found.outcome == Outcome::open;
        const unsigned long long place = append(is_open, open.count);
        if (is_open && place < open.capacity) open.data[place] = left_open(test);
    }
}

// Calls work<kind>() for the two kinds that only codimensional features have, if `of_lists`, else for the two kinds of
// triangles' features.
template <bool of_lists, class Work>
__device__ void for_each_kind(Work work) {
    if constexpr (of_lists) {
        work.template operator()<FeatureKind::vertex_edge>();
        work.template operator()<FeatureKind::vertex_vertex>();
    } else {
        work.template operator()<FeatureKind::vertex_face>();
        work.template operator()<FeatureKind::edge_edge>();
    }
}

template <class Query, bool of_lists>
__global__ void __launch_bounds__(256)
    decide_kernel(Query query, TestLists tests, TestLists open, List<UnresolvedTest> beyond, FeatureHits hits) {
    for_each_kind<of_lists>([&]<FeatureKind kind>() {
        constexpr auto k = static_cast<std::size_t>(kind);
        const auto quick = [&](const FeatureTest& test) { return query.template quick<kind>(test); };
        if constexpr (Query::closely)
            decide_each<kind>(tests.of[k], hits, quick, open.of[k], [](const FeatureTest& test) { return test; });
        else
            decide_each<kind>(tests.of[k], hits, quick, beyond, [](const FeatureTest& test) {
                return UnresolvedTest{test, kind};
            });
    });
}

template <class Query, bool of_lists>
__global__ void __launch_bounds__(256)
    close_kernel(Query query, TestLists open, List<UnresolvedTest> beyond, FeatureHits hits) {
    for_each_kind<of_lists>([&]<FeatureKind kind>() {
        const auto close = [&](const FeatureTest& test) { return query.template close<kind>(test); };
        decide_each<kind>(open.of[static_cast<std::size_t>(kind)], hits, close, beyond, [](const FeatureTest& test) {
            return UnresolvedTest{test, kind};
        });
    });
}

__global__ void pack_kernel(ExactPoints points, FeatureConditions asked, const UnresolvedTest* tests, std::size_t count,
                            FeaturesToDecide* cases) {
    for (std::size_t i = grid_thread(); i < count; i += grid_stride()) {
        const UnresolvedTest open = tests[i];
        const auto& v = open.test.vertex;
        FeaturesToDecide& made = cases[i];
        made.kind = open.kind;
        made.pair = open.test.pair;
        made.points = points.moving(v);
        made.reach = distance_limit_of(open.kind, v, asked.radii, asked.distance, asked.strict);
        made.has_rest = asked.rest.knows(v[0], v[3]);
        for (std::size_t k = 0; k < 4; ++k) made.rest[k] = made.has_rest ? asked.rest(v[k]) : Vec3d{};
    }
}

__global__ void append_kernel(const RankedHit* found, std::size_t count, unsigned long long begin, FeatureHits hits) {
    for (std::size_t i = grid_thread(); i < count; i += grid_stride())
        if (begin + i < hits.list.capacity) hits.list.data[begin + i] = found[i];
    if (grid_thread() == 0) *hits.list.count = begin + count;
}

__global__ void rank_kernel(FeatureHits hits) {
    const unsigned long long n = hits.list.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride()) {
        RankedHit& hit = hits.list.data[i];
        hit.rank = static_cast<std::uint32_t>(atomicAdd(&hits.by_first[hit.first], 1ull));
    }
}

__global__ void radii_kernel(PreparedScene scene, const SceneBox* box, const double* radii, float* vertex,
                             float* triangle) {
    const Normaliser normaliser = normaliser_of(*box);
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    for (std::size_t v = grid_thread(); v < vertices; v += grid_stride()) vertex[v] = radius_of(normaliser, radii[v]);
    const auto triangles = static_cast<std::size_t>(scene.triangle_count());
    const auto of = [&](std::int32_t v) {
        return static_cast<std::uint32_t>(v) < vertices ? radius_of(normaliser, radii[v]) : 0;
    };
    for (std::size_t t = grid_thread(); t < triangles; t += grid_stride()) {
        const std::int32_t* c = scene.corners + 3 * t;
        triangle[t] = max(of(c[0]), max(of(c[1]), of(c[2])));
    }
}

__global__ void inflation_kernel(const SceneBox* box, double distance, double share, const float* radius,
                                 Inflation* inflation) {
    Inflation made = inflation_of(normaliser_of(*box), distance, share);
    made.radius = radius;
    *inflation = made;
}

// Calls work<Query>() with the type that decides tests of this query.
template <class Work>
void with_decision(const FeatureConditions& asked, Work work) {
    if (!asked.motion)
        work.template operator()<ProximityDecision>();
    else if (asked.separated())
        work.template operator()<MinDistanceDecision>();
    else
        work.template operator()<ImpactDecision>();
}

}  // namespace

template <int moments>
void list_tests(const Geometry& geometry, cudaStream_t stream, const FeatureSurvivors<moments>& survivors,
                const PointRows& points, std::int32_t ends, const FeatureConditions& asked, bool all_kinds,
                const TestLists& tests, const FeatureHits& hits, Counters* counters) {
    const TestFilter<moments> filter{points, ends, asked};
    if (all_kinds) {
        Launch{stream, geometry.blocks(survivors.list.capacity), geometry.threads}(
            codimensional_tests_kernel<moments>, survivors, filter, tests, hits, &counters->listed);
        return;
    }
    const auto list = [&]<int threads>() {
        constexpr auto kernel = list_kernel<threads, moments>;
        constexpr std::size_t shared = sizeof(ListShared<threads>);
        Geometry own = geometry;
        own.threads = threads;
        const unsigned blocks = std::min(own.blocks(survivors.list.capacity), own.fitting(kernel, shared));
        Launch{stream, blocks, threads, shared}(kernel, survivors, filter, tests, hits, &counters->listed);
    };
    // 256 threads would need more than 48 KiB of shared memory.
    geometry.threads == 64 ? list.template operator()<64>() : list.template operator()<128>();
}
template void list_tests(const Geometry&, cudaStream_t, const FeatureSurvivors<1>&, const PointRows&, std::int32_t,
                         const FeatureConditions&, bool, const TestLists&, const FeatureHits&, Counters*);
template void list_tests(const Geometry&, cudaStream_t, const FeatureSurvivors<2>&, const PointRows&, std::int32_t,
                         const FeatureConditions&, bool, const TestLists&, const FeatureHits&, Counters*);

void decide_tests(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                  const FeatureConditions& asked, bool all_kinds, const TestLists& tests, const TestLists& open,
                  const List<UnresolvedTest>& beyond, const FeatureHits& hits) {
    const auto most = [](const TestLists& lists, std::size_t begin) {
        return static_cast<std::size_t>(std::max(lists.of[begin].capacity, lists.of[begin + 1].capacity));
    };
    const auto decide = [&]<class Query, bool listed>() {
        const Query query({scene, is_aligned(scene)}, asked, hits.any);
        const auto fitting = [&](auto kernel, std::size_t capacity) {
            return Launch{stream, std::min(geometry.blocks(capacity), geometry.fitting(kernel)), geometry.threads};
        };
        constexpr std::size_t begin = listed ? 2 : 0;
        constexpr auto quick = decide_kernel<Query, listed>;
        fitting(quick, most(tests, begin))(quick, query, tests, open, beyond, hits);
        if constexpr (Query::closely) {
            constexpr auto close = close_kernel<Query, listed>;
            fitting(close, most(open, begin))(close, query, open, beyond, hits);
        }
    };
    with_decision(asked, [&]<class Query>() {
        decide.template operator()<Query, false>();
        if (all_kinds) decide.template operator()<Query, true>();
    });
}

void reserve_feature_stacks(const Geometry& geometry, cudaStream_t stream, Counters* counters) {
    TestLists none;
    for (std::size_t k = 0; k < feature_kinds; ++k) none.of[k] = {nullptr, &counters->tests[k], 0};
    const List<UnresolvedTest> beyond{nullptr, &counters->beyond, 0};
    FeatureHits hits{};
    hits.list.count = &counters->hits;
    FeatureConditions asked;
    const auto reserve = [&](bool motion, double distance) {
        asked.motion = motion, asked.distance = distance;
        decide_tests(geometry, stream, PreparedScene{}, asked, true, none, none, beyond, hits);
    };
    reserve(false, 1);
    reserve(true, 0);
    reserve(true, 1);
}

void gather_cases(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                  const FeatureConditions& asked, const UnresolvedTest* tests, std::size_t count,
                  FeaturesToDecide* cases) {
    Launch{stream, geometry.blocks(count), geometry.threads}(pack_kernel, ExactPoints{scene, is_aligned(scene)}, asked,
                                                             tests, count, cases);
}

void append_hits(const Geometry& geometry, cudaStream_t stream, const RankedHit* found, std::size_t count,
                 unsigned long long begin, const FeatureHits& hits) {
    Launch{stream, geometry.blocks(count), geometry.threads}(append_kernel, found, count, begin, hits);
}

void rank_hits(const Geometry& geometry, cudaStream_t stream, const FeatureHits& hits) {
    Launch{stream, geometry.blocks(hits.list.capacity), geometry.threads}(rank_kernel, hits);
}

void normalise_radii(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const SceneBox* box,
                     const double* radii, float* vertex, float* triangle) {
    const auto elements = static_cast<std::size_t>(std::max(scene.vertex_count(), scene.triangle_count()));
    Launch{stream, geometry.blocks(elements), geometry.threads}(radii_kernel, scene, box, radii, vertex, triangle);
}

void make_inflation(cudaStream_t stream, const SceneBox* box, double distance, double share, const float* radius,
                    Inflation* inflation) {
    Launch{stream, 1, 1}(inflation_kernel, box, distance, share, radius, inflation);
}

}  // namespace crumple::cuda
