#include "backends/cuda/intersections/intersection_narrow.h"

#include <algorithm>

#include "backends/cuda/device/block_counter.h"
#include "backends/cuda/device/warp_queue.h"
#include "exact/intersection/intersection_decision.h"
#include "filters/intersection/pair_filters.h"

namespace crumple::cuda {
namespace {

// Records the lane's pair if it collides; `a` must be less than `b`. `second`: number of triangles of the first of two
// meshes, else 0. `reserve(is_hit)` reserves places for the hits in the list, like append(). All lanes of a warp call
// it together.
template <class Reserve>
__device__ void add(const Hits& hits, bool is_hit, std::int32_t a, std::int32_t b, std::int32_t second,
                    Reserve reserve) {
    if (hits.mode == Hits::Mode::any) return tally(is_hit, hits.list.count);
    unsigned long long rank = 0;
    if (is_hit) rank = atomicAdd(&hits.by_first[a], 1ull);
    if (hits.mode == Hits::Mode::fill) {
        if (is_hit) hits.bucketed[rank] = {a, b - second};
        return;
    }
    const unsigned long long place = reserve(is_hit);
    if (is_hit && hits.mode == Hits::Mode::list && place < hits.list.capacity)
        hits.list.data[place] = {a, b, static_cast<std::uint32_t>(rank)};
}

__device__ void add(const Hits& hits, bool is_hit, std::int32_t a, std::int32_t b, std::int32_t second) {
    add(hits, is_hit, a, b, second, [&](bool hit) { return append(hit, hits.list.count); });
}

// Records a candidate if it is a hit; only counts it, by world, in Hits::Mode::by_world.
__device__ void add(const Hits& hits, bool is_hit, const Pair& pair, std::int32_t second, const Sorted& sorted,
                    const Candidate& c) {
    if (hits.mode != Hits::Mode::by_world) return add(hits, is_hit, pair.a, pair.b, second);
    if (is_hit) atomicAdd(hits.worlds.of(sorted.leaf[c.row]), 1ull);
}

// Returns true if the candidate's world already has a hit, so that it need not be decided. Lanes of a warp may get
// different results, so the caller must not skip warp-wide operations because of it.
__device__ bool is_decided(const Hits& hits, const Sorted& sorted, const Candidate& c) {
    return hits.mode == Hits::Mode::by_world && atomicAdd(hits.worlds.of(sorted.leaf[c.row]), 0ull) != 0;
}

__device__ std::int32_t second_of(const PreparedScene& scene) {
    return static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
}

__device__ Pair pair_of(const Sorted& sorted, const Candidate& c) {
    const std::int32_t a = sorted.row[c.row].triangle, b = sorted.row[c.column].triangle;
    return {min(a, b), max(a, b)};
}

template <int threads>
struct FilterShared {
    struct Warp {
        WarpQueue<Candidate>::Places open, found;
    } warp[threads / 32];
    unsigned sizes[2][threads / 32];
    BlockShared block;
};

// Runs the filters in float32, then in float64. Few pairs need float64, and few collide: both are queued until there is
// one for each lane. At the end the warps of a block put together what their queues still have, because otherwise each
// warp would run the filters in float64 for a few lanes. Hits are not queued if one hit ends the work.
template <int threads>
__global__ void __launch_bounds__(threads, 768 / threads)
    filter_kernel(PreparedScene scene, Sorted sorted, RecordRows records, PointRows points, Frames frames,
                  NarrowPolicy policy, List<Candidate> survivors, List<Candidate> undecided, Hits hits,
                  unsigned long long* doubles) {
    const unsigned long long n = survivors.filled(), warps_end = (n + 31) / 32 * 32;
    if (std::uint64_t{blockIdx.x} * threads >= n) return;  // most blocks of a small scene have no survivor
    auto& shared = dynamic_shared<FilterShared<threads>>();
    auto& own = shared.warp[threadIdx.x / 32];
    WarpQueue<Candidate> open(own.open), found(own.found);
    unsigned long long double_tests = 0;
    const unsigned lane = threadIdx.x % 32;
    const bool waits = hits.mode != Hits::Mode::any && hits.mode != Hits::Mode::by_world;
    const auto in_float = [&](const Candidate& c) {
        // Copies, so that records are loaded four words at a time.
        const Record a = records.record[c.row], b = records.record[c.column];
        const PairSigns signs = pair_signs(a, b);
        const float reach = frames.extent_of(sorted.leaf[c.row]);
        return filter_in_float(a, b, signs, classify(signs, policy), policy, points, reach);
    };
    const auto apart_in_double = [&](const Candidate& c) {
        const Record a = records.record[c.row], b = records.record[c.column];
        return filter_in_double(a, b, pair_signs(a, b), points);
    };
    const auto add_found = [&] {
        Candidate c{};
        const bool has = lane < found.take(c);
        add(hits, has, has ? pair_of(sorted, c) : Pair{}, second_of(scene), sorted, c);
    };
    const auto open_of = [&](unsigned warp) { return shared.warp[warp].open; };
    const auto found_of = [&](unsigned warp) { return shared.warp[warp].found; };
    const auto decide_in_double = [&](bool has, const Candidate& c) {
        const bool left = has && !apart_in_double(c);
        const unsigned long long place = append(left, undecided.count);
        if (left && place < undecided.capacity) undecided.data[place] = c;
        double_tests += has;
    };
    bool more = true;
    for (unsigned long long i = grid_thread(); more; i += grid_stride()) {
        more = i < warps_end && !has_ended(hits.end());
        if (more) {
            const Candidate c = i < n ? survivors.data[i] : Candidate{};
            const Verdict verdict = i < n ? in_float(c) : Verdict::apart;
            found.add(verdict == Verdict::collides, c);
            open.add(verdict == Verdict::undecided, c);
            if (found.size() >= 32 || (found.size() && !waits)) add_found();
            if (open.size() < 32) continue;
        }
        Candidate c{};
        const bool has = more ? lane < open.take(c) : distribute_rest(open, shared.sizes[0], open_of, c);
        decide_in_double(has, c);
    }
    add_by_block(double_tests, doubles, shared.block);
    if (!waits) return;
    Candidate c{};
    const bool has = distribute_rest(found, shared.sizes[1], found_of, c);
    const Pair pair = has ? pair_of(sorted, c) : Pair{};
    add(hits, has, pair.a, pair.b, second_of(scene), [&](bool hit) {
        const unsigned hitting = __ballot_sync(whole_warp, hit);
        return reserve_by_block(static_cast<unsigned>(__popc(hitting)), hits.list.count, shared.block) +
               static_cast<unsigned>(__popc(hitting & ((1u << lane) - 1)));
    });
}

// Makes the exact decision, with expansions if necessary. Few pairs come here, so registers and stack do not matter.
// Pairs are spread over as many warps as possible, because lanes that diverge wait for each other.
__global__ void exact_kernel(PreparedScene scene, Sorted sorted, Neighbours neighbours, IntersectionKind intersections,
                             List<Candidate> undecided, List<Pair> beyond, Hits hits) {
    // Works for a grid of one thread, too: tests/ptx interprets the kernel like that.
    const unsigned long long n = undecided.filled(), warps = (grid_stride() + 31) / 32, warp = grid_thread() / 32;
    for (unsigned long long begin = warp; begin < n && !has_ended(hits.end()); begin += grid_stride()) {
        const unsigned long long i = begin + threadIdx.x % 32 * warps;
        Verdict verdict = Verdict::apart;
        Pair pair{};
        Candidate candidate{};
        if (i < n) candidate = undecided.data[i];
        if (i < n && !is_decided(hits, sorted, candidate)) {
            pair = pair_of(sorted, candidate);
            ExactSigns signs;
            verdict = decide(scene.triangle(pair.a), scene.triangle(pair.b), neighbours, intersections, signs);
        }
        add(hits, verdict == Verdict::collides, pair, second_of(scene), sorted, candidate);
        const unsigned long long place = append(verdict == Verdict::undecided, beyond.count);
        if (verdict == Verdict::undecided && place < beyond.capacity) beyond.data[place] = pair;
    }
}

__global__ void add_kernel(PreparedScene scene, const Pair* pairs, std::size_t n, Hits hits) {
    const std::size_t warps_end = (n + 31) / 32 * 32;
    for (std::size_t i = grid_thread(); i < warps_end; i += grid_stride())
        add(hits, i < n, i < n ? pairs[i].a : 0, i < n ? pairs[i].b : 0, second_of(scene));
}

__global__ void append_kernel(const Pair* pairs, std::size_t n, unsigned long long begin, List<Hit> hits) {
    for (std::size_t i = grid_thread(); i < n; i += grid_stride())
        if (begin + i < hits.capacity) hits.data[begin + i] = {pairs[i].a, pairs[i].b, 0};
    if (grid_thread() == 0) *hits.count = begin + n;
}

__global__ void rank_kernel(List<Hit> hits, unsigned long long* by_first) {
    const unsigned long long n = hits.filled();
    for (unsigned long long i = grid_thread(); i < n; i += grid_stride())
        hits.data[i].rank = static_cast<std::uint32_t>(atomicAdd(&by_first[hits.data[i].a], 1ull));
}

}  // namespace

void narrow(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
            const RecordRows& records, const Points& points, const Frames& frames, const NarrowPolicy& policy,
            const List<Candidate>& survivors, const List<Candidate>& undecided, const List<Pair>& beyond,
            const Hits& hits, unsigned long long* doubles) {
    const Neighbours neighbours = policy.skip_adjacent ? Neighbours::skip : Neighbours::geometric;
    const IntersectionKind intersections = policy.proper ? IntersectionKind::proper : IntersectionKind::all;
    const auto filter = [&]<int threads>() {
        constexpr auto kernel = filter_kernel<threads>;
        constexpr std::size_t shared = sizeof(FilterShared<threads>);
        const unsigned blocks = std::min(geometry.blocks(survivors.capacity), geometry.fitting(kernel, shared));
        Launch{stream, blocks, threads, shared}(kernel, scene, sorted, records, points.rows(), frames, policy,
                                                survivors, undecided, hits, doubles);
    };
    geometry.threads == 64 ? filter.template operator()<64>() : filter.template operator()<256>();
    decide_exactly(geometry, stream, scene, sorted, neighbours, intersections, undecided, beyond, hits);
}

void decide_exactly(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Sorted& sorted,
                    Neighbours neighbours, IntersectionKind intersections, const List<Candidate>& undecided,
                    const List<Pair>& beyond, const Hits& hits) {
    // One block per multiprocessor suffices: the kernel needs many registers, and few pairs reach it.
    const unsigned blocks = std::min(geometry.blocks(undecided.capacity), std::max(1u, geometry.multiprocessors));
    Launch{stream, blocks, geometry.threads}(exact_kernel, scene, sorted, neighbours, intersections, undecided, beyond,
                                             hits);
}

void reserve_exact_stack(const Geometry& geometry, cudaStream_t stream, Counters* counters) {
    decide_exactly(geometry, stream, PreparedScene{}, Sorted{}, Neighbours::geometric, IntersectionKind::all,
                   {nullptr, &counters->undecided, 0}, {nullptr, &counters->beyond, 0}, Hits{});
}

void append_hits(const Geometry& geometry, cudaStream_t stream, const Pair* pairs, std::size_t count,
                 unsigned long long begin, const List<Hit>& hits) {
    Launch{stream, geometry.blocks(count), geometry.threads}(append_kernel, pairs, count, begin, hits);
}

void rank_hits(const Geometry& geometry, cudaStream_t stream, const List<Hit>& hits, unsigned long long* by_first) {
    Launch{stream, geometry.blocks(hits.capacity), geometry.threads}(rank_kernel, hits, by_first);
}

void add_hits(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs,
              std::size_t count, const Hits& hits) {
    Launch{stream, geometry.blocks(count), geometry.threads}(add_kernel, scene, pairs, count, hits);
}

}  // namespace crumple::cuda
