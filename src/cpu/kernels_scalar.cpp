// Plain C++ for every kernel: what a machine without a known SIMD instruction set runs, and the text to read first. The
// filter knows only the plane test here and leaves the rest to exact arithmetic (geometry/decide.h).

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "cpu/big.h"
#include "cpu/kernels.h"

namespace crumple::cpu {
namespace {

Vec3d point(const PointRows& points, std::int32_t vertex) {
    const auto i = 4 * static_cast<std::int64_t>(vertex);
    if (points.f) return {points.f[i], points.f[i + 1], points.f[i + 2]};
    return {points.d[i], points.d[i + 1], points.d[i + 2]};
}

Vec3f to_float(Vec3d p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; }

void balls(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end, Ball* ball) {
    for (std::int64_t t = begin; t < end; ++t) {
        Vec3f p[3];
        for (int k = 0; k < 3; ++k) p[k] = to_float(point(points, corners[3 * t + k]));
        const Vec3f c = (1.0f / 3.0f) * (p[0] + p[1] + p[2]);
        float r2 = 0;
        for (const Vec3f& corner : p) r2 = max(r2, dot(corner - c, corner - c));
        ball[t] = {c.x, c.y, c.z, std::sqrt(r2) * ball_factor + ball_slack};
    }
}

void assign(const Ball* ball, std::int64_t n, const Centres& centres, std::uint64_t* mask, std::int64_t* count) {
    // Bisector rule: d_k^2 - d_min^2 <= 2 r |v_k - v_min|, with factors that cover the roundings (docs/subdivide.md).
    float reach[max_clusters][max_clusters];
    for (int j = 0; j < centres.count; ++j)
        for (int k = 0; k < centres.count; ++k) {
            const Vec3f d = centres[j] - centres[k];
            reach[j][k] = 2.00001f * std::sqrt(dot(d, d)) + 1e-22f;
        }
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
            if (!(d2[k] > best * 1.000002f + ball[i].r * reach[nearest][k]))
                mask[i] |= std::uint64_t{1} << k, ++count[k];
    }
}

void build(const RecordInput& in, Record* record, Boxes& boxes, LeafBounds& bounds) {
    constexpr float most = std::numeric_limits<float>::max();
    bounds = {{most, most, most}, {-most, -most, -most}, 0, 0};
    const Vec3d origin{in.frame.origin.x, in.frame.origin.y, in.frame.origin.z};
    for (std::int64_t i = 0; i < in.members; ++i) {
        const std::int32_t* corner = in.corners + 3 * static_cast<std::int64_t>(in.triangle[i]);
        const Vec3d p[3] = {point(in.points, corner[0]), point(in.points, corner[1]), point(in.points, corner[2])};
        const Vec3f q[3] = {to_float(p[0] - origin), to_float(p[1] - origin), to_float(p[2] - origin)};
        const float reach = max(largest(abs(q[0])), max(largest(abs(q[1])), largest(abs(q[2]))));
        const bool big = reach > in.frame.big;

        Vec3f low{most, most, most}, high{-most, -most, -most};
        for (const Vec3f& corner_point : q) {
            const Vec3f turned{dot(in.frame.axis[0], corner_point), dot(in.frame.axis[1], corner_point),
                               dot(in.frame.axis[2], corner_point)};
            low = min(low, turned);
            high = max(high, turned);
        }
        if (!big) {
            bounds.low = min(bounds.low, low);
            bounds.high = max(bounds.high, high);
            bounds.reach = max(bounds.reach, reach);
        }
        boxes.low[static_cast<std::size_t>(i)] = {low.x, low.y, low.z, 0};
        boxes.high[static_cast<std::size_t>(i)] = {high.x, high.y, high.z, 0};

        // The plane, normalised by the sum of its products' magnitudes, in which the error bound is expressed.
        const Vec3f a = to_float(p[1] - p[0]), b = to_float(p[2] - p[0]);
        Vec3f n = cross(a, b);
        const float sum = (std::abs(a.y * b.z) + std::abs(a.z * b.y)) + (std::abs(a.z * b.x) + std::abs(a.x * b.z)) +
                          (std::abs(a.x * b.y) + std::abs(a.y * b.x)) + 1e-30f;
        n = {n.x / sum, n.y / sum, n.z / sum};
        record[i] = {{q[0].x, q[1].x, q[2].x, n.x},
                     {q[0].y, q[1].y, q[2].y, n.y},
                     {q[0].z, q[1].z, q[2].z, n.z},
                     {corner[0], corner[1], corner[2]},
                     dot(n, q[0])};
        if (big) {
            const Vec3d relative[3] = {p[0] - origin, p[1] - origin, p[2] - origin};
            make_big(relative, p[1] - p[0], p[2] - p[0], reach, record[i], boxes.low[static_cast<std::size_t>(i)],
                     boxes.high[static_cast<std::size_t>(i)]);
            bounds.reach = max(bounds.reach, 0x1p-28f * reach);
            ++bounds.big;
        }
    }
}

void quantise(const BoxCorner* corner, std::int64_t n, const float base[4], const float scale[4],
              QuantisedCorner* out) {
    const auto to_16_bits = [&](float value, int axis) {
        return static_cast<std::uint16_t>(std::clamp((value - base[axis]) * scale[axis], 0.0f, 65534.0f));
    };
    for (std::int64_t i = 0; i < n; ++i)
        out[i] = {to_16_bits(corner[i].x, 0), to_16_bits(corner[i].y, 1), to_16_bits(corner[i].z, 2), 0};
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
        out.x[3] *= scale;
        out.y[3] *= scale;
        out.z[3] *= scale;
        out.c *= scale;
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

// Whether all corners of `other` that the two do not share lie, for certain, on one side of the plane of `plane`.
bool plane_separates(const Record& plane, const Record& other, const bool shared[3]) {
    bool above = true, below = true;
    for (int k = 0; k < 3; ++k) {
        const float side = plane.x[3] * other.x[k] + plane.y[3] * other.y[k] + plane.z[3] * other.z[k] - plane.c;
        above = above && (shared[k] || side > 1);
        below = below && (shared[k] || side < -1);
    }
    return above || below;
}

void filter(const SortedLeaf& leaf, const Candidates& candidates, const PointRows&, const NarrowPolicy& policy, float,
            Verdicts& verdicts) {
    verdicts.hit.clear();
    verdicts.undecided.resize_discard(static_cast<std::size_t>(candidates.count));
    std::size_t undecided = 0;
    const Record* rows = leaf.record.data() + candidates.rows;
    const Record* columns = leaf.record.data() + candidates.columns;
    for (std::int64_t k = 0; k < candidates.count; ++k) {
        const std::uint32_t i = candidates.row[k], j = candidates.column[k];
        const Record &a = rows[i], &b = columns[j];
        if (b.id[0] < 0) continue;  // padding
        bool shared_a[3] = {}, shared_b[3] = {}, neighbours = false;
        for (int s = 0; s < 3; ++s)
            for (int t = 0; t < 3; ++t)
                if (a.id[s] == b.id[t]) shared_a[s] = shared_b[t] = neighbours = true;
        if (policy.skip_neighbours && neighbours) continue;
        const bool all = shared_a[0] && shared_a[1] && shared_a[2];
        if (!all && !(shared_b[0] && shared_b[1] && shared_b[2]) &&
            (plane_separates(a, b, shared_b) || plane_separates(b, a, shared_a)))
            continue;
        verdicts.undecided[undecided++] = j << 16 | i;
    }
    verdicts.undecided.resize(undecided);
    verdicts.edge_tests = verdicts.double_tests = static_cast<std::int64_t>(undecided);
}

void name_pairs(const std::uint32_t* packed, std::size_t count, const RowLink* rows, const RowLink* columns,
                Pair* out) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t a = rows[packed[i] & 0xffff].triangle, b = columns[packed[i] >> 16].triangle;
        out[i] = {std::min(a, b), std::max(a, b)};
    }
}

}  // namespace

const Kernels scalar_kernels{"scalar", balls, assign, build, quantise, split_boxes, scatter, sweep, filter, name_pairs};

}  // namespace crumple::cpu
