// Kernels of the stages in plain C++, for machines without a supported SIMD instruction set; the version to read first.
// The arithmetic for one triangle is in geometry/, shared with devices.

#include <algorithm>
#include <limits>

#include "backends/cpu/stages/kernels.h"

namespace crumple::cpu {
namespace {

void balls(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
           std::int64_t ends, float more, Ball* ball) {
    const auto at = [&](std::int64_t row) { return to_float(points[static_cast<std::int32_t>(row)]); };
    for (std::int64_t t = begin; t < end; ++t) {
        const std::int32_t* c = corners + 3 * t;
        const Vec3f start[3] = {at(c[0]), at(c[1]), at(c[2])};
        if (ends) {
            const Vec3f stop[3] = {at(c[0] + ends), at(c[1] + ends), at(c[2] + ends)};
            ball[t] = swept_ball(start, stop, {});
        } else {
            ball[t] = ball_of(start[0], start[1], start[2]);
        }
        ball[t].r += more;
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
        for (int k = 0; k < centres.count; ++k) reach[j][k] = bisector_radius_factor(centres[j] - centres[k]);
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

std::int64_t sweep(const SortedLeaf& leaf, std::int64_t row, std::int64_t last, std::int64_t block_end,
                   std::uint16_t dummy, std::int64_t capacity, CandidateChunk& out) {
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
        while (count % out.group) add(row, dummy);
    }
    while (count % 16) add(out.rows, dummy);
    out.count = count;
    return row;
}

}  // namespace

const StageKernels scalar_stages{"scalar", balls, repeats_corner, assign, list_members, quantise, split_boxes, sweep};

}  // namespace crumple::cpu
