#pragma once

// Binding of the arrays of an overlap query's result, which crumple.Overlaps and crumple.mpi.Overlaps have in common.

#include <cstdint>

#include "crumple/overlaps.h"
#include "held_binding.h"

namespace crumple::python {

/// Binds all arrays. overlaps(result) returns the Overlaps that has them.
template <class Binding, class OverlapsOf>
void bind_overlap_arrays(Binding& result, OverlapsOf overlaps) {
    using Result = typename Binding::Result;
    const auto array = [&]<class Number>(Number, const char* name, auto member, auto... columns) {
        result.template array<Number>(
            name, [=](const Result& r) -> auto& { return overlaps(r).*member; }, columns...);
    };
    constexpr std::int32_t index = 0;
    constexpr std::int64_t offset = 0;
    constexpr double number = 0;
    constexpr std::uint8_t relation = 0;
    constexpr bool flag = false;
    array(flag, "world_hit", &Overlaps::world_hit);
    array(index, "bodies", &Overlaps::bodies, 2U);
    array(index, "skipped", &Overlaps::skipped);
    array(relation, "relation", &Overlaps::relation);
    array(number, "volume", &Overlaps::volume);
    array(number, "centroid", &Overlaps::centroid, 3U);
    array(number, "area_vector", &Overlaps::area_vector, 3U);
    array(number, "normal", &Overlaps::normal, 3U);
    array(number, "mean_depth", &Overlaps::mean_depth);
    array(number, "torque", &Overlaps::torque, 3U);
    array(number, "contact_area", &Overlaps::contact_area);
    array(number, "gradient", &Overlaps::gradient, 3U);
    array(number, "body_volume", &Overlaps::body_volume);
    array(offset, "gradient_offsets", &Overlaps::gradient_offsets);
    array(index, "gradient_vertices", &Overlaps::gradient_vertices, 2U);
    array(offset, "curve_offsets", &Overlaps::curve_offsets);
    array(flag, "curve_closed", &Overlaps::curve_closed);
    array(number, "curve_area_vector", &Overlaps::curve_area_vector, 3U);
    array(number, "curve_torque", &Overlaps::curve_torque, 3U);
    array(offset, "curve_point_offsets", &Overlaps::curve_point_offsets);
    array(number, "curve_points", &Overlaps::curve_points, 3U);
    array(index, "curve_triangles", &Overlaps::curve_triangles, 2U);
    array(offset, "winding_offsets", &Overlaps::winding_offsets);
    array(index, "winding_vertices", &Overlaps::winding_vertices, 2U);
    array(index, "windings", &Overlaps::windings);
    array(flag, "is_solid", &Overlaps::is_solid);
    array(number, "torque_point", &Overlaps::torque_point, 3U);
    array(number, "box", &Overlaps::box, 6U);
    array(number, "thickness", &Overlaps::thickness);
    array(offset, "depth_offsets", &Overlaps::depth_offsets);
    array(index, "depth_vertices", &Overlaps::depth_vertices, 2U);
    array(number, "depths", &Overlaps::depths);
    array(number, "depth_points", &Overlaps::depth_points, 3U);
    array(index, "depth_triangles", &Overlaps::depth_triangles);
    array(offset, "deepest", &Overlaps::deepest);
    array(number, "depth_reached", &Overlaps::depth_reached);
    array(number, "depth_bound", &Overlaps::depth_bound);
    array(number, "union_volume", &Overlaps::union_volume);
    array(number, "intersection_over_union", &Overlaps::intersection_over_union);
    array(number, "difference_volume", &Overlaps::difference_volume, 2U);
    array(number, "withdrawals", &Overlaps::withdrawals);
    array(number, "first_free", &Overlaps::first_free);
    array(number, "translation_low", &Overlaps::translation_low);
    array(number, "translation_high", &Overlaps::translation_high);
    array(number, "translation", &Overlaps::translation, 3U);
    array(offset, "region_offsets", &Overlaps::region_offsets);
    array(number, "region_volume", &Overlaps::region_volume);
    array(number, "region_centroid", &Overlaps::region_centroid, 3U);
    array(number, "region_area_vector", &Overlaps::region_area_vector, 3U);
    array(number, "region_normal", &Overlaps::region_normal, 3U);
    array(number, "region_mean_depth", &Overlaps::region_mean_depth);
    array(number, "region_thickness", &Overlaps::region_thickness);
    array(number, "region_box", &Overlaps::region_box, 6U);
    array(flag, "region_is_contact", &Overlaps::region_is_contact);
    array(flag, "region_is_merged", &Overlaps::region_is_merged);
    array(index, "region_pieces", &Overlaps::region_pieces, 2U);
    array(offset, "curve_regions", &Overlaps::curve_regions);
    array(index, "part_pairs", &Overlaps::part_pairs, 2U);
    array(index, "part_bodies", &Overlaps::part_bodies, 2U);
}

}  // namespace crumple::python
