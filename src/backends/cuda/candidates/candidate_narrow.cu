#include "backends/cuda/candidates/candidate_narrow.h"

#include <algorithm>

#include "backends/cuda/device/warp_queue.h"
#include "backends/cuda/stages/output_kernel.h"
#include "backends/cuda/stages/sort_kernel.h"
#include "backends/cuda/stages/sweep_kernel.h"
#include "filters/candidates/candidate_inflation.h"

namespace crumple::cuda {

template void sort_members(const Geometry&, cudaStream_t, const PreparedScene&, const Points&, int, const Segments&,
                           const Members&, const Frames&, const Ownership&, const Sorted&, const Widened<2>&,
                           const CandidateMembers&, const List<SweepUnit>&, Counters*);
template void sweep(const Geometry&, cudaStream_t, const PreparedScene&, const Sorted&, const List<SweepUnit>&,
                    const Ownership&, const PairSelection&, const OverlapAlone&, const List<Candidate>&, const Slice&,
                    Counters*);
template void make_offsets(const Geometry&, cudaStream_t, std::size_t, const CandidateOutput&, Counters*);
template void order_buckets(const Geometry&, cudaStream_t, std::size_t, const CandidateOutput&, Counters*, Counters*);

namespace {

// Counts a hit, and returns it with its rank among the hits with the same first feature.
__device__ RankedCandidate ranked(const CandidateHits& hits, CandidateKind kind, const Pair& pair) {
    const std::uint32_t first = hits.firsts.joint(kind, pair.a);
    return {first, pair.b, static_cast<std::uint32_t>(atomicAdd(&hits.by_first[first], 1ull))};
}

// Lists a hit. All lanes of a warp call it together.
__device__ void add(const CandidateHits& hits, bool is_hit, CandidateKind kind, const Pair& pair) {
    const unsigned long long place = append(is_hit, hits.list.count);
    if (is_hit && place < hits.list.capacity) hits.list.data[place] = ranked(hits, kind, pair);
}

// Returns the pair in the order of the result: by type of the features; if these are equal, the lower id first.
__device__ Pair listed(int lane_a, std::int32_t a, int lane_b, std::int32_t b) {
    const FeatureType of_a = type_of(lane_a), of_b = type_of(lane_b);
    const bool swapped = of_b < of_a || (of_a == of_b && b < a);
    return swapped ? Pair{b, a} : Pair{a, b};
}

// Returns the largest gap between two boxes on any axis; it is negative if they overlap.
__device__ float gap(const CandidateBox& a, const CandidateBox& b) {
    return max(largest(b.low - a.high), largest(a.low - b.high));
}

using HitQueue = ListQueue<RankedCandidate, 224>;

/// Pair of features: rows of their triangles, and the lane of each. Such a lane is the number of a feature in its
/// triangle: 0 to 2 for vertices, 3 to 5 for edges, 6 for the face (CandidateRecord). It has nothing to do with the
/// lanes of a warp.
struct LanePair {
    Candidate rows;
    std::uint32_t a, b;
};

template <int threads>
struct PairShared {
    struct Warp {
        WarpQueue<LanePair>::Places pairs;
        HitQueue::Places hits;
    } warp[threads / 32];
};

// Requested pairs of features of two triangles, one bit each: bit lanes * a + b for lane a of the first triangle and
// lane b of the second.
class SelectedLanes {
   public:
    static constexpr int lanes = candidate_lanes - 1;

    __device__ explicit SelectedLanes(const CandidateConditions& asked) {
        for (int a = 0; a < lanes; ++a)
            for (int b = 0; b < lanes; ++b) wanted_ |= std::uint64_t{asked.wants(kind_of(a, b))} << (lanes * a + b);
    }
    // Returns the requested pairs that the two triangles own and that have no vertex in common.
    __device__ std::uint64_t of(const CandidateMember& a, const CandidateMember& b) const {
        std::uint64_t pairs = 0;
        for (int lane = 0; lane < lanes; ++lane)
            if (a.owned >> lane & 1) pairs |= std::uint64_t{b.owned} << (lanes * lane);
        pairs &= wanted_;
        const SharedCorners shared(a.name, b.name);
        if (!shared.bits()) return pairs;
        for (std::uint64_t left = pairs; left; left &= left - 1) {
            const int both = __ffsll(static_cast<long long>(left)) - 1;
            if (shared.incident(both / lanes, both % lanes)) pairs &= ~(left & (0 - left));
        }
        return pairs;
    }

   private:
    std::uint64_t wanted_ = 0;
};

// Tests the features of pairs of triangles. Each lane of the warp takes a pair of triangles and finds the pairs of
// features to test, few of 49. These wait in a queue until there is one per lane of the warp.
template <int threads>
__global__ void __launch_bounds__(threads)
    pair_kernel(CandidateConditions asked, const CandidateMember* row, List<Candidate> survivors, CandidateHits hits,
                unsigned long long* tests_made) {
    auto& shared = dynamic_shared<PairShared<threads>>().warp[threadIdx.x / 32];
    WarpQueue<LanePair> pairs(shared.pairs);
    HitQueue found(shared.hits, hits.list);
    const SelectedLanes wanted(asked);
    unsigned long long tests = 0;
    const auto test = [&] {
        LanePair p{};
        const unsigned taken = pairs.take(p);
        bool is_hit = false;
        Pair pair{};
        const auto of_a = static_cast<int>(p.a), of_b = static_cast<int>(p.b);
        if (threadIdx.x % 32 < taken) {
            const CandidateMember &a = row[p.rows.row], &b = row[p.rows.column];
            const CandidateBox box_a = a.box[of_a], box_b = b.box[of_b];
            const float between = gap(box_a, box_b);
            is_hit = between < 0 ||
                     (between == 0 &&
                      inflated_boxes_overlap(asked.box(a.vertex, of_a), asked.box(b.vertex, of_b), asked.inflation));
            pair = listed(of_a, box_a.id, of_b, box_b.id);
        }
        tests += taken;
        found.add(is_hit, is_hit ? ranked(hits, kind_of(of_a, of_b), pair) : RankedCandidate{});
    };
    const unsigned long long n = survivors.filled(), warps_end = (n + 31) / 32 * 32;
    for (unsigned long long i = grid_thread(); i < warps_end; i += grid_stride()) {
        const Candidate c = i < n ? survivors.data[i] : Candidate{};
        std::uint64_t left = i < n ? wanted.of(row[c.row], row[c.column]) : 0;
        while (const unsigned having = __ballot_sync(whole_warp, left != 0)) {
            const auto both = static_cast<std::uint32_t>(__ffsll(static_cast<long long>(left)) - 1);
            pairs.add(left != 0, {c, both / SelectedLanes::lanes, both % SelectedLanes::lanes}, having);
            left &= left - 1;
            if (pairs.size() >= 32) test();
        }
    }
    while (pairs.size()) test();
    found.move();
    if (threadIdx.x % 32 == 0 && tests) atomicAdd(tests_made, tests);
}

__global__ void within_kernel(PreparedScene scene, PairSelection pairs, CandidateConditions asked, CandidateHits hits) {
    const auto n = static_cast<std::size_t>(scene.triangle_count()), warps_end = (n + 31) / 32 * 32;
    for (std::size_t i = grid_thread(); i < warps_end; i += grid_stride()) {
        const auto t = static_cast<std::int32_t>(i);
        const std::int32_t* corner = i < n ? scene.corners + 3 * i : nullptr;
        const std::int32_t group = i < n ? scene.group(t) : 0;
        const bool wanted = i < n && (pairs.all() || pairs(group, group));
        const unsigned owned = wanted ? asked.owned_lanes(t) : 0;
        const auto name = [&](int k) { return asked.features.name(corner[k]); };
        const auto id = [&](int lane) {
            return lane < 3 ? asked.features.point_of(t, lane)
                            : asked.features.edges_of[t][static_cast<std::size_t>(lane - 3)];
        };
        // True if the vertex, or one that is welded to it, belongs to the other feature.
        const auto incident = [&](int vertex, int lane) {
            for (int k = 0; k < 3; ++k)
                if ((corners_of(lane) >> k & 1) && name(k) == name(vertex)) return true;
            return false;
        };
        for (int a = 0; a < 3; ++a)
            for (int b = a + 1; b < 6; ++b) {
                const CandidateKind kind = kind_of(a, b);
                const bool is_hit = (owned >> a & owned >> b & 1) && asked.wants(kind) && !incident(a, b) &&
                                    inflated_boxes_overlap(asked.box(corner, a), asked.box(corner, b), asked.inflation);
                add(hits, is_hit, kind, is_hit ? listed(a, id(a), b, id(b)) : Pair{});
            }
    }
}

__global__ void bucket_kernel(CandidateHits hits, CandidateOutput out) {
    const unsigned long long n = hits.list.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride()) {
        const RankedCandidate hit = hits.list.data[i];
        const unsigned long long place = out.offsets[hit.first] + hit.rank;
        if (place < out.capacity) out.bucketed[place] = {static_cast<std::int32_t>(hit.first), hit.second};
    }
}

__global__ void normaliser_kernel(const SceneBox* box, double inflation, Inflation* widening, Normaliser* normaliser) {
    *normaliser = normaliser_of(*box);
    *widening = inflation_of_candidates(*normaliser, inflation);
}

}  // namespace

void find_candidates(const Geometry& geometry, cudaStream_t stream, const CandidateConditions& asked,
                     const CandidateMember* row, const List<Candidate>& survivors, const CandidateHits& hits,
                     Counters* counters) {
    const auto find = [&]<int threads>() {
        constexpr auto kernel = pair_kernel<threads>;
        constexpr std::size_t shared = sizeof(PairShared<threads>);
        const unsigned blocks = std::min(geometry.blocks(survivors.capacity), geometry.fitting(kernel, shared));
        Launch{stream, blocks, threads, shared}(kernel, asked, row, survivors, hits, &counters->listed);
    };
    geometry.threads == 64 ? find.template operator()<64>() : find.template operator()<256>();
}

void find_within(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const PairSelection& pairs,
                 const CandidateConditions& asked, const CandidateHits& hits) {
    if (!asked.wants(CandidateKind::vertex_vertex) && !asked.wants(CandidateKind::vertex_edge)) return;
    Launch{stream, geometry.blocks(static_cast<std::size_t>(scene.triangle_count())), geometry.threads}(
        within_kernel, scene, pairs, asked, hits);
}

void CandidateOutput::cut(ArenaLayout& c, const FirstOfKind& features, std::size_t most) {
    RowsByKind::cut(c, features, most, false);
    bucketed = c.take<BucketedPair>(most);
}

void write_feature_rows(const Geometry& geometry, cudaStream_t stream, const CandidateHits& hits,
                        const CandidateOutput& output, Counters* counters, Counters* told) {
    make_offsets(geometry, stream, output.firsts.all(), output, counters);
    Launch{stream, geometry.blocks(hits.list.capacity), geometry.threads}(bucket_kernel, hits, output);
    order_buckets(geometry, stream, output.firsts.all(), output, counters, told);
}

void make_normaliser(cudaStream_t stream, const SceneBox* box, double inflation, Inflation* widening,
                     Normaliser* normaliser) {
    Launch{stream, 1, 1}(normaliser_kernel, box, inflation, widening, normaliser);
}

}  // namespace crumple::cuda
