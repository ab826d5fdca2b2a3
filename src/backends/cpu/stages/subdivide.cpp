#include "backends/cpu/stages/subdivide.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace crumple::cpu {
namespace {

constexpr std::int64_t chunk = 4096;
constexpr std::size_t samples1 = 1024;            // sample points for the centres of the first level
constexpr std::size_t samples2_per_cluster = 32;  // sample points per centre of the second level

bool pays(std::int64_t memberships, std::int64_t members, int clusters) {
    return splitting_pays(static_cast<double>(memberships), static_cast<double>(members), clusters);
}

int choose_clusters(std::int64_t n, const Options& options) {
    if (options.clusters > 0) return options.clusters;
    // Up to 8 leaves make one level. For more, there are about as many clusters as each has leaves.
    const std::int64_t leaves = std::max<std::int64_t>(1, (n + options.leaf_size - 1) / options.leaf_size);
    const auto balanced = static_cast<std::int64_t>(std::ceil(std::sqrt(static_cast<double>(leaves))));
    return static_cast<int>(std::clamp<std::int64_t>(balanced, std::min<std::int64_t>(leaves, 8), max_clusters));
}

FuzzyOptions fuzzy(const Options& options, bool first) {
    const FuzzyCMeans& means = options.fuzzy_c_means;
    return {means.fuzziness, first ? means.first_iterations : means.max_iterations,
            first ? means.first_stop : means.stop};
}

// Writes the members of clusters [begin, end), cluster by cluster, in the order of triangles: prefix sums of the counts
// give each chunk of triangles its places. Members are found by testing one bit of all masks after another in SIMD
// lanes: the exit of a loop over the bits of one mask would be mispredicted.
void scatter_members(std::int64_t n, int begin, int end, const StageKernels& kernels, Workers& workers,
                     Subdivision& s) {
    const auto chunks = static_cast<std::size_t>((n + chunk - 1) / chunk);
    s.place.resize_discard(chunks * max_clusters);
    std::int64_t total = 0;
    for (int k = begin; k < end; ++k) {
        s.first[static_cast<std::size_t>(k)] = total;
        for (std::size_t c = 0; c < chunks; ++c) {
            const std::size_t cell = c * max_clusters + static_cast<std::size_t>(k);
            s.place[cell] = total;
            total += s.histogram[cell];
        }
    }
    s.first[static_cast<std::size_t>(end)] = total;
    // Member positions are int32. After Exceeded, callers repeat the search with Call::low_memory, one cluster at a
    // time, which has no more members than there are triangles.
    if (total > std::numeric_limits<std::int32_t>::max()) throw MemoryMeter::Exceeded{};
    s.id.resize_discard(static_cast<std::size_t>(total));
    s.mask2.resize_discard(static_cast<std::size_t>(total));
    workers.parallel_for(chunks, [&](std::size_t c, std::size_t) {
        const std::int64_t first = static_cast<std::int64_t>(c) * chunk, last = std::min(n, first + chunk);
        std::array<std::int32_t, chunk + padding> some;
        for (int k = begin; k < end; ++k) {
            const std::size_t cell = c * max_clusters + static_cast<std::size_t>(k);
            if (s.histogram[cell] == 0) continue;
            const std::int64_t count = kernels.list_members(s.mask1.data(), first, last, k, some.data());
            std::copy_n(some.begin(), count, s.id.begin() + s.place[cell]);
        }
    });
}

// Computes the masks of the first level and their histogram; returns the number of memberships.
std::int64_t assign_all(const Array<Ball>& balls, std::int64_t n, const std::uint8_t* included,
                        const StageKernels& kernels, Workers& workers, const Centres& centres, Subdivision& s) {
    const auto chunks = static_cast<std::size_t>((n + chunk - 1) / chunk);
    s.histogram.assign(chunks * max_clusters, 0);
    workers.parallel_for(chunks, [&](std::size_t c, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(c) * chunk, end = std::min(n, begin + chunk);
        std::int64_t* count = s.histogram.data() + c * max_clusters;
        if (assign_members(s.membership, kernels, balls.data() + begin, end - begin,
                           included ? included + begin : nullptr, centres, s.mask1.data() + begin, count))
            s.may_lose = true;
        if (!included) return;
        for (std::int64_t t = begin; t < end; ++t) {
            if (included[t]) continue;
            for (std::uint64_t mask = s.mask1[t]; mask; mask &= mask - 1) --count[std::countr_zero(mask)];
            s.mask1[t] = 0;
        }
    });
    std::int64_t total = 0;
    for (std::int64_t count : s.histogram) total += count;
    return total;
}

// Lists the members of each child among [begin, end), child after child. Works in chunks, so that a chunk's masks stay
// in the cache.
void list_children(std::int64_t begin, std::int64_t end, int children, const std::int64_t* sizes,
                   const StageKernels& kernels, const Array<std::uint64_t>& mask, Array<std::int32_t>& list) {
    std::int64_t next[max_clusters];
    std::exclusive_scan(sizes, sizes + children, next, std::int64_t{0});
    list.resize_discard(static_cast<std::size_t>(std::accumulate(sizes, sizes + children, std::int64_t{0})));
    std::array<std::int32_t, chunk + padding> some;
    for (std::int64_t m = begin; m < end; m += chunk) {
        for (int child = 0; child < children; ++child) {
            const std::int64_t count =
                kernels.list_members(mask.data(), m, std::min(end, m + chunk), child, some.data());
            std::copy_n(some.begin(), count, list.begin() + next[child]);
            next[child] += count;
        }
    }
}

// Splits a cluster if it has more than 1.5 times Options::leaf_size members, and splitting pays: writes its members'
// masks and the children's sizes and lists. Returns the number of children, 0 if it stays whole.
int split_cluster(int cluster, const Array<Ball>& balls, const Options& options, const StageKernels& kernels,
                  Centres& centres, Subdivision& s, std::array<std::int64_t, max_clusters>& sizes) {
    const auto k = static_cast<std::size_t>(cluster);
    const std::int64_t begin = s.first[k], members = s.first[k + 1] - begin;
    if (2 * members <= 3 * static_cast<std::int64_t>(options.leaf_size)) return 0;
    const auto count =
        static_cast<int>(std::min<std::int64_t>(max_clusters, (members + options.leaf_size - 1) / options.leaf_size));
    const std::size_t samples = static_cast<std::size_t>(
        std::min<std::int64_t>(members, static_cast<std::int64_t>(samples2_per_cluster) * count));
    const auto point = [&](std::size_t i) {
        const Ball& ball =
            balls[s.id[static_cast<std::size_t>(begin) + i * static_cast<std::size_t>(members) / samples]];
        return Vec3f{ball.x, ball.y, ball.z};
    };
    const bool first = centres.count != count;
    if (first) start_centres(count, samples, point, centres);
    fuzzy_c_means(samples, point, fuzzy(options, first), centres);
    sizes.fill(0);
    Ball gathered[chunk];
    bool loses = false;
    for (std::int64_t m = begin; m < begin + members; m += chunk) {
        const std::int64_t n = std::min(chunk, begin + members - m);
        for (std::int64_t i = 0; i < n; ++i) gathered[i] = balls[s.id[m + i]];
        loses |= assign_members(s.membership, kernels, gathered, n, nullptr, centres, s.mask2.data() + m, sizes.data());
    }
    const std::int64_t total = std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0});
    if (!pays(total, members, count)) return 0;
    if (loses) s.may_lose = true;
    list_children(begin, begin + members, count, sizes.data(), kernels, s.mask2, s.members2[k]);
    return count;
}

}  // namespace

void place_clusters(const Array<Ball>& balls, std::int64_t n, const std::uint8_t* included, const Options& options,
                    const StageKernels& kernels, Workers& workers, WarmCentres& warm, Subdivision& s) {
    Centres& centres = warm.level1;
    std::int64_t members = n;
    if (included) {
        // Counted first, because under a memory limit arrays grow by no more than is requested.
        members = 0;
        for (std::int64_t t = 0; t < n; ++t) members += included[t];
        std::int32_t* next = s.included.resize_discard(static_cast<std::size_t>(members));
        for (std::int64_t t = 0; t < n; ++t)
            if (included[t]) *next++ = static_cast<std::int32_t>(t);
    }
    const auto samples = static_cast<std::size_t>(std::min<std::int64_t>(members, samples1));
    const auto sample = [&](std::size_t i) {
        auto t = static_cast<std::size_t>(i * static_cast<std::uint64_t>(members) / samples);
        if (included) t = static_cast<std::size_t>(s.included[t]);
        return Vec3f{balls[t].x, balls[t].y, balls[t].z};
    };
    s.sample.resize_discard(samples);
    for (std::size_t i = 0; i < samples; ++i) s.sample[i] = sample(i);
    const auto point = [&](std::size_t i) { return s.sample[i]; };

    s.membership = membership_of(options, balls, n, included);
    const int wanted = choose_clusters(members, options);
    s.mask1.resize_discard(static_cast<std::size_t>(n + padding));
    for (int count = wanted;; count /= 2) {
        // Cached centres may be fewer than choose_clusters() returned when they were started, if more did not pay. They
        // are reused unless it now returns fewer than there are, or at least twice as many as it returned then.
        const bool first = centres.count == 0 || centres.count > count || wanted >= 2 * warm.wanted;
        if (first) {
            warm.wanted = wanted;
            start_centres(
                samples ? count : 1, std::max<std::size_t>(samples, 1),
                [&](std::size_t i) { return samples ? point(i) : Vec3f{}; }, centres);
        }
        count = centres.count;
        if (count > 1) fuzzy_c_means(samples, point, fuzzy(options, first), centres);
        s.clusters = count;
        s.may_lose = false;
        const std::int64_t total = assign_all(balls, n, included, kernels, workers, centres, s);
        if (count == 1 || options.clusters > 0 || pays(total, members, count)) break;
    }
}

void gather_leaves(const Array<Ball>& balls, std::int64_t n, int begin, int end, const Options& options,
                   const StageKernels& kernels, Workers& workers, WarmCentres& warm, Subdivision& s) {
    scatter_members(n, begin, end, kernels, workers, s);

    std::array<std::array<std::int64_t, max_clusters>, max_clusters> sizes;
    std::array<int, max_clusters> children{};
    workers.parallel_for(static_cast<std::size_t>(end - begin), [&](std::size_t i, std::size_t) {
        const std::size_t k = static_cast<std::size_t>(begin) + i;
        children[k] = split_cluster(static_cast<int>(k), balls, options, kernels, warm.level2[k], s, sizes[k]);
    });

    s.leaves.clear();
    for (int cluster = begin; cluster < end; ++cluster) {
        const auto k = static_cast<std::size_t>(cluster);
        if (children[k] == 0) s.leaves.push_back({cluster, -1, s.first[k], s.first[k + 1] - s.first[k]});
        std::int64_t first = 0;
        for (std::int32_t child = 0; child < children[k]; ++child) {
            const std::int64_t size = sizes[k][static_cast<std::size_t>(child)];
            s.leaves.push_back({cluster, child, first, size});
            first += size;
        }
    }
    // Largest first, so that the last tasks of a parallel loop are short ones.
    std::sort(s.leaves.begin(), s.leaves.end(), [](const Leaf& a, const Leaf& b) {
        return a.size != b.size ? a.size > b.size
                                : (a.cluster != b.cluster ? a.cluster < b.cluster : a.child < b.child);
    });
}

}  // namespace crumple::cpu
