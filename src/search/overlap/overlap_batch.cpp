#include "search/overlap/overlap_batch.h"

#include <algorithm>
#include <utility>

namespace crumple {

Vec3d middle_of(const Bounds& a, const Bounds& b) {
    Vec3d middle;
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = 0.5 * max(a.low[axis], b.low[axis]) + 0.5 * min(a.high[axis], b.high[axis]);
        if (!(std::abs(middle[axis]) >= 0x1p-150)) middle[axis] = 0;
    }
    return middle;
}

std::vector<Pair> pairs_within(const ClosedSurface& surface, std::span<const Pair> found) {
    std::vector<Pair> pairs;
    for (const auto& [a, b] : found) {
        pairs.push_back({a, b});
        pairs.push_back({b, a});
    }
    std::vector<std::pair<std::int32_t, std::int32_t>> corners;  // vertex, triangle
    for (std::int32_t face = 0; face < surface.face_count(); ++face)
        for (std::size_t k = 0; k < 3; ++k) corners.emplace_back(surface.corners(face)[k], face);
    std::sort(corners.begin(), corners.end());
    for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
        while (end < corners.size() && corners[end].first == corners[begin].first) ++end;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = begin; j < end; ++j)
                if (corners[i].second != corners[j].second) pairs.push_back({corners[i].second, corners[j].second});
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

bool OverlapBatch::cross(OverlapDevice& device, std::span<const Row> rows, bool numbers, ParallelFor& workers) {
    of_row_.assign(rows.size(), -1);
    list_bodies(rows);
    std::size_t count = 0, points = 0, faces = 0;
    for (const Row& row : rows) count += row.pairs.size();
    for (const std::int32_t body : numbers_) {
        points += static_cast<std::size_t>(bodies_.outline().shape(body).vertices.rows);
        faces += index(bodies_.surface(body).face_count());
    }
    if (count < device.least_pairs(points, faces)) return false;
    device_ = &device;
    try {
        place(workers);
        list_pairs(rows);
        std::vector<DeviceSurface> surfaces;
        for (const auto& surface : surfaces_) {
            const PlacedSurface& placed = surface->placed;
            surfaces.push_back({{placed.points, static_cast<std::size_t>(placed.vertex_count)},
                                {placed.surface->corners(0), 3 * index(placed.surface->face_count())}});
        }
        memory_.add(pairs_.size() * (sizeof(Pair) + sizeof(PackedCrossings)));
        if (!rows_.empty() && device.cross(surfaces, rows_, pairs_, numbers, crossings_)) {
            memory_.add(bytes_of(crossings_.sums));
            return true;
        }
    } catch (const MemoryMeter::Exceeded&) {
    }
    surfaces_.clear();
    of_row_.assign(rows.size(), -1);
    return false;
}

void OverlapBatch::list_bodies(std::span<const Row> rows) {
    for (const Row& row : rows)
        if (!row.pairs.empty()) numbers_.insert(numbers_.end(), {row.bodies.first, row.bodies.second});
    std::sort(numbers_.begin(), numbers_.end());
    numbers_.erase(std::unique(numbers_.begin(), numbers_.end()), numbers_.end());
}

void OverlapBatch::place(ParallelFor& workers) {
    for (std::size_t i = 0; i < numbers_.size(); ++i)
        surfaces_.push_back(std::make_unique<Surface>(Surface{bodies_.metered_points(), {}}));
    workers.parallel_for(numbers_.size(), [&](std::size_t i) {
        surfaces_[i]->placed = bodies_.place(numbers_[i], surfaces_[i]->points);
    });
}

void OverlapBatch::list_pairs(std::span<const Row> rows) {
    const auto surface_of = [&](std::int32_t body) {
        return static_cast<std::int32_t>(std::lower_bound(numbers_.begin(), numbers_.end(), body) - numbers_.begin());
    };
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].pairs.empty()) continue;
        const auto [a, b] = rows[i].bodies;
        CrossedRow row;
        row.surface = {surface_of(a), surface_of(b)};
        row.begin = pairs_.size();
        const PlacedSurface &first = surface(row.surface[0]), &second = surface(row.surface[1]);
        if (!first.in_range || !second.in_range) continue;
        row.origin = middle_of(first.box, second.box);
        row.curves = a != b;
        if (a == b) {
            const std::vector<Pair> within = pairs_within(*first.surface, rows[i].pairs);
            pairs_.insert(pairs_.end(), within.begin(), within.end());
        } else {
            pairs_.insert(pairs_.end(), rows[i].pairs.begin(), rows[i].pairs.end());
        }
        row.end = pairs_.size();
        of_row_[i] = static_cast<std::int32_t>(rows_.size());
        rows_.push_back(row);
    }
}

RowOnDevice OverlapBatch::on_device(const CrossedRow& row) const {
    const auto i = static_cast<std::size_t>(&row - rows_.data());
    RowOnDevice found;
    found.device = device_;
    found.surface = row.surface;
    found.crossings = std::span(crossings_.pairs).subspan(row.begin, row.end - row.begin);
    found.sums =
        std::span(crossings_.sums).subspan(crossings_.offsets[i], crossings_.offsets[i + 1] - crossings_.offsets[i]);
    return found;
}

}  // namespace crumple
