#include "least_work.h"

#include <algorithm>

#include "backends/cuda/stages/layout.h"
#include "crumple/options.h"
#include "filters/intersection/triangle_record.h"

namespace crumple::benchmark {
namespace {

template <class T>
constexpr double size = sizeof(T);

constexpr double index = size<std::int32_t>, corners = 3 * index, ball = size<Ball>, mask = size<std::uint64_t>;
constexpr double offset = size<unsigned long long>, bin_counter = size<std::uint32_t>;
constexpr double member = size<std::int32_t> + size<std::uint32_t>;  // id of triangle, index of item in the Level
constexpr double span_of_bins = size<std::uint32_t>, rank = size<std::uint32_t>, end = size<std::uint32_t>;
// Bytes per member that the sweep reads in order, and bytes per member that it gathers if the member's box overlaps
// another.
constexpr double streamed = size<cuda::CrossBox> + mask + end;
constexpr double gathered = size<Record> + index + size<std::uint16_t>;

}  // namespace

LeastWork least_work(std::int64_t vertices, bool float32, const Statistics& counted) {
    const auto number = [](std::int64_t n) { return static_cast<double>(n); };
    const double n = number(counted.triangles), v = number(vertices), members = number(counted.members);
    const double pairs = number(counted.pairs), survivors = number(counted.edge_tests);
    const double bins = cuda::bins * number(counted.leaves);
    const double units = std::max(members / 32, number(counted.interval_tests) / (32 * cuda::unit_columns));
    const double vertex = 3 * (float32 ? size<float> : size<double>);
    const double row = float32 ? size<cuda::Row<float>> : size<cuda::Row<double>>;
    const bool two_levels = counted.leaves > counted.clusters;
    // Numbers of gathered rows: both members of each pair, but no member twice.
    const double swept_rows = std::min(members, 2 * number(counted.box_overlaps));
    const double narrowed_rows = std::min(members, 2 * survivors), first_triangles = std::min(n, pairs);

    LeastWork work;
    const auto at = [&](Stage stage) -> Work& { return work.stage[static_cast<std::size_t>(stage)]; };

    // Checks vertices, then normalises them and makes balls, for which vertices are read once more.
    at(Stage::bounds) = {v * vertex + v * (vertex + row) + n * (corners + ball), 2};

    // At each level of clusters, a triangle's clusters are found and members are listed. Statistics have no number of
    // members of the first of two levels; it is at least the number of triangles.
    const auto level = [&](bool first, double items, double joined) {
        const double triangles = first ? 0 : items * index;
        return Work{triangles + n * ball + items * mask + joined * member, 1};
    };
    at(Stage::subdivide) = level(true, n, two_levels ? n : members);
    if (two_levels) at(Stage::subdivide) += level(false, n, members);

    // The longest path of the graph has no nodes of this stage: a parallel branch makes the frames for the next call.
    at(Stage::align) = {0, 0};
    const auto beside = [](std::int64_t fan_out) { return 1 + (fan_out > 1 ? 2 * FuzzyCMeans().max_iterations : 0); };
    work.beside = 1 + beside(counted.clusters) + (two_levels ? beside(counted.leaves / counted.clusters) : 0);

    // Three nodes: counts the members of each bin and sums the counts, writes members to their places in the order of
    // bins, and lists the units of the sweep.
    const double corners_of_members = n * corners + v * row;
    const double counting = bins * 3 * bin_counter + corners_of_members + members * (index + span_of_bins + rank);
    const double placing = bins * bin_counter + corners_of_members + n * mask +
                           members * (member + span_of_bins + rank + streamed + gathered);
    at(Stage::sort) = {counting + bins * 2 * bin_counter + placing + members * end + units * size<cuda::SweepUnit>, 3};

    at(Stage::sweep) = {members * streamed + units * size<cuda::SweepUnit> + swept_rows * gathered +
                            (two_levels ? n * mask : 0) + survivors * size<cuda::Candidate>,
                        1};

    // Two nodes: filters, and exact decisions of pairs that the filters leave unresolved. Both count colliding pairs
    // per first triangle.
    at(Stage::narrow) = {survivors * size<cuda::Candidate> + narrowed_rows * gathered + pairs * size<cuda::Hit> +
                             first_triangles * 2 * offset,
                         2};

    // Four nodes: prefix sums, which also list the parts of long buckets; filling buckets with the pairs of each first
    // triangle; ordering short buckets and sorting the parts of long ones; merging these parts.
    at(Stage::output) = {n * 2 * offset +
                             pairs * (size<cuda::Hit> + size<cuda::BucketedPair>)+first_triangles * offset + n +
                             (n + 1) * offset + pairs * (size<cuda::BucketedPair> + size<Pair>)+2 * n,
                         4};

    work.frame = {(n + 1) * offset, 1};  // batched clear of counters
    for (const Work& stage : work.stage) work.frame += stage;
    return work;
}

}  // namespace crumple::benchmark
