#include "checks/pair_items.h"

#include <algorithm>
#include <cmath>

namespace crumple::checks {
namespace {

BoundingBox box_of(const std::array<double, 6>& box) { return {{box[0], box[1], box[2]}, {box[3], box[4], box[5]}}; }

void widen(BoundingBox& box, const BoundingBox& by) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], by.low[k]);
        box.high[k] = std::max(box.high[k], by.high[k]);
    }
}

/// Returns the regions of row `i` that have a volume.
std::vector<ItemPlace> regions_of(const Overlaps& found, std::size_t i) {
    std::vector<ItemPlace> places;
    for (std::int64_t r = found.region_offsets[i]; r < found.region_offsets[i + 1]; ++r) {
        if (found.region_is_contact[r]) continue;
        ItemPlace& place = places.emplace_back();
        place.centre = found.region_centroid[r];
        place.box = box_of(found.region_box[r]);
        place.volume = found.region_volume[r];
        place.mean_depth = found.region_mean_depth[r];
        place.thickness = found.region_thickness[r];
        place.pieces = found.region_pieces[r];
    }
    return places;
}

}  // namespace

void PairItems::add(const Overlaps& found, const std::vector<BodyPart>& parts) {
    for (std::size_t i = 0; i < found.bodies.size(); ++i) {
        const auto [first, second] = found.bodies[i];
        if (first == second) continue;
        CheckItem& row = item({parts[static_cast<std::size_t>(first)], parts[static_cast<std::size_t>(second)]});
        row.kind = kind_of(found.relation[i]);
        row.volume = found.volume[i];
        row.mean_depth = found.mean_depth[i];
        row.depth_reached = found.depth_reached[i];
        row.depth_bound = found.depth_bound[i];
        row.contact_area = found.contact_area[i];
        row.places = regions_of(found, i);
        for (const ItemPlace& place : row.places)
            for (std::size_t side = 0; side < 2; ++side)
                row.pieces[side] = std::max(row.pieces[side], place.pieces[side]);
        if (!std::isnan(found.box[i][0])) row.box = box_of(found.box[i]);
        if (!std::isnan(found.centroid[i][0])) row.centre = found.centroid[i];
        if (row.kind == ItemKind::overlapping && std::max(row.pieces[0], row.pieces[1]) > 1)
            row.kind = ItemKind::piercing;
        if (row.kind == ItemKind::overlapping || row.kind == ItemKind::piercing)
            row.is_ignored = row.depth_bound <= options_.ignore_below;
        if (row.kind == ItemKind::touching) row.is_ignored = options_.ignore_below > 0;
        // Bodies of an assembly may touch. Shells of one body that touch are one surface that touches itself.
        row.is_finding = !row.is_ignored && !(row.kind == ItemKind::touching && row.first.shell < 0);
    }
}

void PairItems::add(const CrossingPlace& place, const PartPair& pair) {
    CheckItem& row = item(pair);
    row.rows.insert(row.rows.end(), place.rows.begin(), place.rows.end());
    row.count += place.triangles;
    const bool has_regions = !row.places.empty() && row.places[0].triangles == 0;
    if (has_regions) return;
    ItemPlace& added = row.places.emplace_back();
    added.centre = place.centre;
    added.box = place.box;
    added.triangles = place.triangles;
    if (row.places.size() == 1) row.box = place.box;
    widen(*row.box, place.box);
    row.centre = middle_of(*row.box);
}

void PairItems::add_duplicate(const PartPair& pair) {
    CheckItem& row = item(pair);
    row.kind = ItemKind::duplicate;
    row.is_finding = true;
}

void PairItems::add(const Distances& found) {
    const double clearance = *options_.clearance;
    for (std::size_t i = 0; i < found.bodies.size(); ++i) {
        const double distance = std::sqrt(found.squared_distance[i]);
        if (!(distance < clearance)) continue;
        const PartPair pair({found.bodies[i].first}, {found.bodies[i].second});
        const bool is_new = !items_.contains(pair);
        CheckItem& row = item(pair);
        row.clearance = found.touching[i] ? 0 : distance;
        row.closest = found.points[i];
        if (!row.is_ignored) row.is_finding = true;
        if (!is_new) continue;
        row.kind = ItemKind::near;
        row.box.emplace();
        for (std::size_t k = 0; k < 3; ++k) {
            row.box->low[k] = std::min(row.closest[0][k], row.closest[1][k]);
            row.box->high[k] = std::max(row.closest[0][k], row.closest[1][k]);
        }
        row.centre = middle_of(*row.box);
    }
}

std::vector<CheckItem> PairItems::items() && {
    std::vector<CheckItem> items;
    for (auto& [pair, item] : items_) items.push_back(std::move(item));
    return items;
}

}  // namespace crumple::checks
