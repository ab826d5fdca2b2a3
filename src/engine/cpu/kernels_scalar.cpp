// Plain C++ for every kernel: what a machine without a known SIMD instruction set runs, and the text to read first. The
// arithmetic for one triangle or pair is in geometry/, shared with devices.

#include <algorithm>
#include <bit>
#include <limits>

#include "engine/cpu/kernels.h"
#include "questions/intersect/filters.h"

namespace crumple::cpu {
namespace {

void balls(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end, Ball* ball) {
    for (std::int64_t t = begin; t < end; ++t) {
        const std::int32_t* corner = corners + 3 * t;
        ball[t] = ball_of(to_float(points[corner[0]]), to_float(points[corner[1]]), to_float(points[corner[2]]));
    }
}

bool repeats_corner(const std::int32_t* corners, std::int64_t begin, std::int64_t end) {
    bool repeats = false;
    for (const std::int32_t* c = corners + 3 * begin; c != corners + 3 * end; c += 3)
        repeats |= (c[0] == c[1]) | (c[1] == c[2]) | (c[2] == c[0]);
    return repeats;
}

void assign(const Ball* ball, std::int64_t n, const Centres& centres, std::uint64_t* mask, std::int64_t* count) {
    float reach[max_clusters][max_clusters];
    for (int j = 0; j < centres.count; ++j)
        for (int k = 0; k < centres.count; ++k) reach[j][k] = bisector_reach(centres[j] - centres[k]);
    for (std::int64_t i = 0; i < n; ++i) {
        float d2[max_clusters], best = std::numeric_limits<float>::infinity();
        int nearest = 0;
        for (int k = 0; k < centres.count; ++k) {
            const Vec3f d = Vec3f{ball[i].x, ball[i].y, ball[i].z} - centres[k];
            d2[k] = dot(d, d);
            if (d2[k] < best) best = d2[k], nearest = k;
        }
        mask[i] = 0;
        for (int k = 0; k < centres.count; ++k)
            if (joins(d2[k], best, ball[i].r, reach[nearest][k])) mask[i] |= std::uint64_t{1} << k, ++count[k];
    }
}

std::int64_t list_members(const std::uint64_t* mask, std::int64_t begin, std::int64_t end, int child,
                          std::int32_t* member) {
    std::int32_t* next = member;
    for (std::int64_t m = begin; m < end; ++m)
        if (mask[m] >> child & 1) *next++ = static_cast<std::int32_t>(m);
    return next - member;
}

void build(const RecordInput& in, Record* record, Boxes& boxes, LeafBounds& bounds) {
    constexpr float most = std::numeric_limits<float>::max();
    bounds = {{most, most, most}, {-most, -most, -most}, 0, 0};
    for (std::int64_t i = 0; i < in.members; ++i) {
        const std::int32_t* corner = in.corners + 3 * static_cast<std::int64_t>(in.triangle[i]);
        const Vec3d p[3] = {in.points[corner[0]], in.points[corner[1]], in.points[corner[2]]};
        const Member member = member_of(p, corner, in.frame);
        record[i] = member.record;
        boxes.low[static_cast<std::size_t>(i)] = {member.low.x, member.low.y, member.low.z, 0};
        boxes.high[static_cast<std::size_t>(i)] = {member.high.x, member.high.y, member.high.z, 0};
        bounds.reach = max(bounds.reach, member.reach);
        bounds.big += member.big;
        if (member.big) continue;
        bounds.low = min(bounds.low, member.low);
        bounds.high = max(bounds.high, member.high);
    }
}

void quantise(const Boxes& boxes, std::int64_t n, const Quantisation& by, QuantisedBox* out) {
    const auto to_16_bits = [](float value, float base, float scale) {
        return static_cast<std::uint16_t>(std::clamp((value - base) * scale, 0.0f, 65534.0f));
    };
    for (std::int64_t i = 0; i < n; ++i) {
        const BoxCorner &low = boxes.low[i], &high = boxes.high[i];
        const auto low_of = [&](float value, int axis) { return to_16_bits(value, by.base_low[axis], by.scale[axis]); };
        const auto high_of = [&](float value, int axis) {
            return to_16_bits(value, by.base_high[axis], by.scale[axis]);
        };
        out[i] = {{low_of(low.y, 1), high_of(high.y, 1), low_of(low.z, 2), high_of(high.z, 2)},
                  {},
                  low_of(low.x, 0),
                  high_of(high.x, 0)};
    }
}

void split_boxes(const RowBox* box, std::int64_t rows, SortedLeaf& sorted) {
    for (std::int64_t row = 0; row < rows + padding / 2; ++row) {
        sorted.low_y[row] = box[row].low_y;
        sorted.high_y[row] = box[row].high_y;
        sorted.low_z[row] = box[row].low_z;
        sorted.high_z[row] = box[row].high_z;
    }
}

void scatter(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted) {
    for (std::int64_t i = 0; i < n; ++i) {
        Record& out = sorted[position[i]];
        out = record[i];
        scale_plane(out, scale);
    }
}

std::int64_t sweep(const SortedLeaf& leaf, std::int64_t row, std::int64_t last, std::int64_t block_end,
                   std::uint16_t dummy, std::int64_t capacity, Candidates& out) {
    out.dummy = dummy;
    std::int64_t count = out.count;
    const auto add = [&](std::int64_t i, std::int64_t column) {
        out.row[static_cast<std::size_t>(count)] = static_cast<std::uint16_t>(i - out.rows);
        out.column[static_cast<std::size_t>(count++)] = static_cast<std::uint16_t>(column);
    };
    for (; row < last && count < capacity; ++row) {
        const std::int64_t first = count;
        const std::int64_t end = std::min<std::int64_t>(leaf.link[row].end, block_end);
        for (std::int64_t j = std::max(leaf.begin_of(row), out.columns); j < end; ++j) {
            const bool apart = leaf.low_y[j] > leaf.high_y[row] || leaf.low_y[row] > leaf.high_y[j] ||
                               leaf.low_z[j] > leaf.high_z[row] || leaf.low_z[row] > leaf.high_z[j];
            if (!apart && !(leaf.lower[row] & leaf.lower[j])) add(row, j - out.columns);
        }
        out.pairs += count - first;
        while (count % 4) add(row, dummy);
    }
    while (count % 16) add(out.rows, dummy);
    out.count = count;
    return row;
}

void filter(const SortedLeaf& leaf, const Candidates& candidates, const PointRows& points, const NarrowPolicy& policy,
            float reach, Verdicts& verdicts) {
    verdicts.hit.resize_discard(static_cast<std::size_t>(candidates.count));
    verdicts.undecided.resize_discard(static_cast<std::size_t>(candidates.count));
    verdicts.edge_tests = verdicts.double_tests = 0;
    std::size_t hits = 0, undecided = 0;
    const Record* rows = leaf.record.data() + candidates.rows;
    const Record* columns = leaf.record.data() + candidates.columns;
    for (std::int64_t k = 0; k < candidates.count; ++k) {
        const std::uint32_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const Record &a = rows[i], &b = columns[j];
        const PairSigns signs = pair_signs(a, b);
        const PairKind kind = classify(signs, policy);
        if (kind == PairKind::apart) continue;
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

void name_pairs(const std::uint32_t* packed, std::size_t count, const RowLink* rows, const RowLink* columns,
                Pair* out) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t a = rows[packed[i] & 0xffff].triangle, b = columns[packed[i] >> 16].triangle;
        out[i] = {std::min(a, b), std::max(a, b)};
    }
}

}  // namespace

const Kernels scalar_kernels{"scalar", balls,       repeats_corner, assign, list_members, build,
                             quantise, split_boxes, scatter,        sweep,  filter,       name_pairs};

}  // namespace crumple::cpu
