// Kernels of intersection queries in plain C++, for machines without a supported SIMD instruction set; the version to
// read first. The arithmetic for one triangle or pair is in filters/intersection/, shared with devices.

#include "backends/cpu/intersections/intersection_kernels.h"

#include <algorithm>

#include "backends/cpu/stages/align.h"
#include "filters/intersection/pair_filters.h"

namespace crumple::cpu {
namespace {

void build(const BuildInput& in, Record* record, Boxes& boxes, LeafBounds& bounds) {
    bounds = {};
    for (std::int64_t i = 0; i < in.members; ++i) {
        const std::int32_t* corner = in.corners + 3 * static_cast<std::int64_t>(in.triangle[i]);
        const Vec3d p[3] = {in.points[corner[0]], in.points[corner[1]], in.points[corner[2]]};
        const InFrame<3> member(p, in.frame);
        record[i] = record_of(p, corner, member);
        add_box(member, i, boxes, bounds);
    }
}

void scatter(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted) {
    for (std::int64_t i = 0; i < n; ++i) {
        Record& out = sorted[position[i]];
        out = record[i];
        scale_plane(out, scale);
    }
}

void filter(const Record* record, const CandidateChunk& candidates, const PointRows& points, const NarrowPolicy& policy,
            float reach, Verdicts& verdicts) {
    verdicts.hit.resize_discard(static_cast<std::size_t>(candidates.count));
    verdicts.undecided.resize_discard(static_cast<std::size_t>(candidates.count));
    verdicts.edge_tests = verdicts.double_tests = 0;
    std::size_t hits = 0, undecided = 0;
    const Record* rows = record + candidates.rows;
    const Record* columns = record + candidates.columns;
    for (std::int64_t k = 0; k < candidates.count; ++k) {
        const std::uint32_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const Record &a = rows[i], &b = columns[j];
        const PairSigns signs = pair_signs(a, b);
        const NextStep kind = classify(signs, policy);
        if (kind == NextStep::apart) continue;
        ++verdicts.edge_tests;
        const Verdict verdict = filter_in_float(a, b, signs, kind, policy, points, reach);
        if (verdict == Verdict::collides) verdicts.hit[hits++] = j << 16 | i;
        if (verdict != Verdict::undecided) continue;
        ++verdicts.double_tests;
        if (!filter_in_double(a, b, signs, points)) verdicts.undecided[undecided++] = j << 16 | i;
    }
    verdicts.hit.resize(hits);
    verdicts.undecided.resize(undecided);
}

void triangles_of_pairs(const std::uint32_t* packed, std::size_t count, const RowLink* rows, const RowLink* columns,
                        Pair* out) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t a = rows[packed[i] & 0xffff].triangle, b = columns[packed[i] >> 16].triangle;
        out[i] = {std::min(a, b), std::max(a, b)};
    }
}

}  // namespace

const IntersectKernels scalar_intersect{"scalar", 1, build, scatter, filter, triangles_of_pairs};

}  // namespace crumple::cpu
