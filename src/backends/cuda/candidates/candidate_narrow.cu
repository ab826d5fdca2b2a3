#include "backends/cuda/candidates/candidate_narrow.h"

#include <algorithm>

#include "backends/cuda/stages/output_kernel.h"
#include "backends/cuda/stages/sort_kernel.h"
#include "backends/cuda/stages/sweep_kernel.h"
#include "filters/candidates/candidate_inflation.h"

namespace crumple::cuda {

template void sort_members(const Geometry&, cudaStream_t, const PreparedScene&, const Points&, int, const Segments&,
                           const Members&, const Frames&, const Ownership&, const Sorted&, const Widened<2>&,
                           const CandidateRows&, const List<Unit>&, Counters*);
template void sweep(const Geometry&, cudaStream_t, const PreparedScene&, const Sorted&, const List<Unit>&,
                    const Ownership&, const WantedPairs&, const OverlapAlone&, const List<Candidate>&, const Slice&,
                    Counters*);
template void make_offsets(const Geometry&, cudaStream_t, std::size_t, const CandidateOutput&, Counters*);
template void order_buckets(const Geometry&, cudaStream_t, std::size_t, const CandidateOutput&, Counters*, Counters*);

namespace {

// All lanes of a warp call it together.
__device__ void add(const CandidateHits& hits, bool is_hit, CandidateKind kind, const Pair& pair) {
    const unsigned long long place = append(is_hit, hits.list.count);
    if (!is_hit) return;
    const std::uint32_t first = hits.firsts.joint(kind, pair.a);
    const auto rank = static_cast<std::uint32_t>(atomicAdd(&hits.by_first[first], 1ull));
    atomicAdd(&hits.by_tile[first / offset_tile], 1ull);
    if (place < hits.list.capacity) hits.list.data[place] = {first, pair.b, rank};
}

// The pair as it is listed: by the type of its features, or the lesser first.
__device__ Pair listed(int lane_a, std::int32_t a, int lane_b, std::int32_t b) {
    const FeatureType of_a = type_of(lane_a), of_b = type_of(lane_b);
    const bool swapped = of_b < of_a || (of_a == of_b && b < a);
    return swapped ? Pair{b, a} : Pair{a, b};
}

// The largest gap between two lanes' boxes on any axis.
__device__ float gap(const CandidateRecord& a, int lane_a, const CandidateRecord& b, int lane_b) {
    float most = -beyond;
    for (int axis = 0; axis < 3; ++axis) {
        most = max(most, b.low[axis][lane_b] - a.high[axis][lane_a]);
        most = max(most, a.low[axis][lane_a] - b.high[axis][lane_b]);
    }
    return most;
}

// A warp takes a pair of triangles, and a lane one or two of the 49 pairs of what they have: what is read of the
// records lies side by side.
__global__ void pair_kernel(AskedOfCandidates asked, const CandidateRecord* record, List<Candidate> survivors,
                            CandidateHits hits, unsigned long long* listed_count) {
    constexpr int features = candidate_lanes - 1, all = features * features;
    const auto lane = static_cast<int>(threadIdx.x % 32);
    const unsigned long long n = survivors.filled();
    unsigned long long tests = 0;
    for (unsigned long long i = grid_thread() / 32; i < n; i += grid_stride() / 32) {
        const CandidateRecord &a = record[survivors.data[i].row], &b = record[survivors.data[i].column];
        const SharedCorners shared(a, b);
        for (int first = 0; first < all; first += 32) {
            const int both = first + lane, of_a = both / features, of_b = both % features;
            const CandidateKind kind = kind_of(of_a, of_b);
            bool is_hit = false;
            if (both < all && (a.owned >> of_a & b.owned >> of_b & 1) && asked.wants(kind) &&
                !shared.incident(of_a, of_b)) {
                ++tests;
                const float between = gap(a, of_a, b, of_b);
                is_hit = between < 0 ||
                         (between == 0 &&
                          grown_boxes_overlap(asked.box(a.vertex, of_a), asked.box(b.vertex, of_b), asked.inflation));
            }
            add(hits, is_hit, kind, is_hit ? listed(of_a, a.id[of_a], of_b, b.id[of_b]) : Pair{});
        }
    }
    for (int lanes = 16; lanes > 0; lanes /= 2) tests += __shfl_xor_sync(whole_warp, tests, lanes);
    if (lane == 0 && tests) atomicAdd(listed_count, tests);
}

__global__ void within_kernel(PreparedScene scene, WantedPairs pairs, AskedOfCandidates asked, CandidateHits hits) {
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
        // Whether a vertex is on the other feature, by name.
        const auto incident = [&](int vertex, int lane) {
            for (int k = 0; k < 3; ++k)
                if ((corners_of(lane) >> k & 1) && name(k) == name(vertex)) return true;
            return false;
        };
        for (int a = 0; a < 3; ++a)
            for (int b = a + 1; b < 6; ++b) {
                const CandidateKind kind = kind_of(a, b);
                const bool is_hit = (owned >> a & owned >> b & 1) && asked.wants(kind) && !incident(a, b) &&
                                    grown_boxes_overlap(asked.box(corner, a), asked.box(corner, b), asked.inflation);
                add(hits, is_hit, kind, is_hit ? listed(a, id(a), b, id(b)) : Pair{});
            }
    }
}

__global__ void bucket_kernel(CandidateHits hits, CandidateOutput out) {
    const unsigned long long n = hits.list.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride()) {
        const RankedCandidate hit = hits.list.data[i];
        const unsigned long long place = out.offsets[hit.first] + hit.rank;
        if (place < out.capacity) out.second[place] = hit.second;
    }
}

__global__ void normaliser_kernel(const SceneBox* box, double inflation, Inflation* widening, Normaliser* normaliser) {
    *normaliser = normaliser_of(*box);
    *widening = inflation_of_candidates(*normaliser, inflation);
}

}  // namespace

void find_candidates(const Geometry& geometry, cudaStream_t stream, const AskedOfCandidates& asked,
                     const CandidateRecord* record, const List<Candidate>& survivors, const CandidateHits& hits,
                     Counters* counters) {
    const unsigned blocks = std::min(geometry.blocks(32 * survivors.capacity), geometry.fitting(pair_kernel));
    Launch{stream, blocks, geometry.threads}(pair_kernel, asked, record, survivors, hits, &counters->listed);
}

void find_within(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const WantedPairs& pairs,
                 const AskedOfCandidates& asked, const CandidateHits& hits) {
    if (!asked.wants(CandidateKind::vertex_vertex) && !asked.wants(CandidateKind::vertex_edge)) return;
    Launch{stream, geometry.blocks(static_cast<std::size_t>(scene.triangle_count())), geometry.threads}(
        within_kernel, scene, pairs, asked, hits);
}

void CandidateOutput::cut(Cutter& c, const FirstOfKind& features, std::size_t room) {
    RowsByKind::cut(c, features, room, false);
    second = c.take<Key>(room);
}

void write_answer(const Geometry& geometry, cudaStream_t stream, const CandidateHits& hits,
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
