// Overlap of a mesh with itself, whose triangles are distributed over the ranks. Each rank searches its parts for
// triangles that intersect, as for an IntersectionQuery; then one rank gets the pairs and the whole mesh:
//
//     query ... room   as for intersections
//     search           pairs of triangles that intersect, part by part
//     rows             pairs, triangles and vertices, to the rank of triangle 0
//     output           that rank makes the row, as Detector::combine does on a single machine
//
// The ranks do not share the sums: each needs the winding number at its triangle, which follows from rays through the
// whole surface and from crossings along paths on it.

#include <array>
#include <utility>

#include "distributed/overlaps/gathered_mesh.h"
#include "distributed/rank_detector.h"
#include "results/intersection_output.h"
#include "results/overlap_output.h"

namespace crumple::distribute {

const DistributedOverlaps& RankDetector::find(const LocalMesh& local, const OverlapQuery& query, std::stop_token stop) {
    overlaps_ = {};
    OverlapQuery with_itself = query;
    with_itself.self_overlaps = true;
    run(
        local, nullptr, [&] { return request_of_ranks(with_itself, local.mesh); }, [] {}, std::move(stop),
        [&] { find_overlap_of_mesh(with_itself); });
    overlaps_.statistics = statistics_;
    return overlaps_;
}

// Returns the rank that provided triangle 0, or 0 if there is none.
int RankDetector::rank_of_first_triangle() {
    const Ids& ids = local_.triangles();
    std::int64_t rank = 0;
    for (std::int64_t t = 0; t < local_.scene().triangle_count(); ++t)
        if (ids(t) == 0) rank = transport_.rank();
    reduce({&rank, 1}, Reduction::max);
    return static_cast<int>(rank);
}

void RankDetector::find_overlap_of_mesh(const OverlapQuery& query) {
    GatheredMesh whole(batches_, check_, engine_->memory(), rank_of_first_triangle());
    {
        Array<Pair> pairs(&engine_->memory());
        const auto each = [&](AssembledPart& part) {
            const Intersections& found = engine_->find(part.part(), IntersectionQuery(), part.memory(), stop_);
            pairs.grow_by(found.pairs.size());
            for (const auto& [a, b] : found.pairs)
                pairs.push_back({part.part().mesh.ids[static_cast<std::size_t>(a)],
                                 part.part().mesh.ids[static_cast<std::size_t>(b)]});
            add_pass(found.statistics, statistics_.search);
        };
        search(each, [] { return false; });
        add_up(static_cast<std::int64_t>(pairs.size()), false);
        whole.gather(pairs.span());
    }
    whole.gather(local_, float32_);
    check_(Phase::output, [&] {
        Overlaps& rows = overlaps_.rows;
        if (!whole.is_root()) return begin_rows(query, rows);
        engine_->find(whole.view(), query, whole.pairs(), stop_, rows);
        overlaps_.any = rows.any;
        rows.world_hit.clear();
        rows.statistics = {};
        rows.any = !rows.bodies.empty();
    });
    std::array<std::int64_t, 2> totals{std::int64_t{overlaps_.any},
                                       static_cast<std::int64_t>(overlaps_.rows.bodies.size())};
    reduce(totals, Reduction::sum);
    overlaps_.any = totals[0] > 0;
    overlaps_.count = totals[1];
}

}  // namespace crumple::distribute
