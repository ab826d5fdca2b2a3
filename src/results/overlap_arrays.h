#pragma once

// Table of the arrays of an overlap query's result.

#include <cstdint>

#include "crumple/overlaps.h"

namespace crumple {

/// Lists of an overlap query's result. An array has one or several elements for each element of its list. `offsets` are
/// the arrays of for_each_overlap_list.
enum class OverlapLevel : std::uint8_t {
    worlds,
    skipped,
    bodies,
    rows,
    depths,
    gradient,
    windings,
    regions,
    curves,
    points,
    offsets,
    part_pairs,
};
inline constexpr std::size_t overlap_levels = 12;

/// Calls act(list, parent, offsets) for each list whose elements belong to an element of a parent list, parents first:
/// element i of the parent has the elements [offsets[i], offsets[i + 1]) of the list.
template <class Act>
void for_each_overlap_list(Act act) {
    using Level = OverlapLevel;
    act(Level::depths, Level::rows, &Overlaps::depth_offsets);
    act(Level::gradient, Level::rows, &Overlaps::gradient_offsets);
    act(Level::windings, Level::rows, &Overlaps::winding_offsets);
    act(Level::regions, Level::rows, &Overlaps::region_offsets);
    act(Level::curves, Level::rows, &Overlaps::curve_offsets);
    act(Level::points, Level::curves, &Overlaps::curve_point_offsets);
}

/// Calls act(name, member pointer, list) for each array of Overlaps.
template <class Act>
void for_each_overlap_array(Act act) {
    using Level = OverlapLevel;
    act("world_hit", &Overlaps::world_hit, Level::worlds);
    act("skipped", &Overlaps::skipped, Level::skipped);
    act("bodies", &Overlaps::bodies, Level::rows);
    act("relation", &Overlaps::relation, Level::rows);
    act("volume", &Overlaps::volume, Level::rows);
    act("centroid", &Overlaps::centroid, Level::rows);
    act("area_vector", &Overlaps::area_vector, Level::rows);
    act("normal", &Overlaps::normal, Level::rows);
    act("mean_depth", &Overlaps::mean_depth, Level::rows);
    act("torque", &Overlaps::torque, Level::rows);
    act("torque_point", &Overlaps::torque_point, Level::rows);
    act("contact_area", &Overlaps::contact_area, Level::rows);
    act("box", &Overlaps::box, Level::rows);
    act("thickness", &Overlaps::thickness, Level::rows);
    act("withdrawals", &Overlaps::withdrawals, Level::rows);
    act("first_free", &Overlaps::first_free, Level::rows);
    act("translation_low", &Overlaps::translation_low, Level::rows);
    act("translation_high", &Overlaps::translation_high, Level::rows);
    act("translation", &Overlaps::translation, Level::rows);
    act("depth_offsets", &Overlaps::depth_offsets, Level::offsets);
    act("depth_vertices", &Overlaps::depth_vertices, Level::depths);
    act("depths", &Overlaps::depths, Level::depths);
    act("depth_points", &Overlaps::depth_points, Level::depths);
    act("depth_triangles", &Overlaps::depth_triangles, Level::depths);
    act("deepest", &Overlaps::deepest, Level::rows);
    act("depth_reached", &Overlaps::depth_reached, Level::rows);
    act("depth_bound", &Overlaps::depth_bound, Level::rows);
    act("union_volume", &Overlaps::union_volume, Level::rows);
    act("intersection_over_union", &Overlaps::intersection_over_union, Level::rows);
    act("difference_volume", &Overlaps::difference_volume, Level::rows);
    act("gradient_offsets", &Overlaps::gradient_offsets, Level::offsets);
    act("gradient_vertices", &Overlaps::gradient_vertices, Level::gradient);
    act("gradient", &Overlaps::gradient, Level::gradient);
    act("curve_offsets", &Overlaps::curve_offsets, Level::offsets);
    act("curve_closed", &Overlaps::curve_closed, Level::curves);
    act("curve_area_vector", &Overlaps::curve_area_vector, Level::curves);
    act("curve_torque", &Overlaps::curve_torque, Level::curves);
    act("curve_point_offsets", &Overlaps::curve_point_offsets, Level::offsets);
    act("curve_points", &Overlaps::curve_points, Level::points);
    act("curve_triangles", &Overlaps::curve_triangles, Level::points);
    act("curve_regions", &Overlaps::curve_regions, Level::curves);
    act("region_offsets", &Overlaps::region_offsets, Level::offsets);
    act("region_volume", &Overlaps::region_volume, Level::regions);
    act("region_centroid", &Overlaps::region_centroid, Level::regions);
    act("region_area_vector", &Overlaps::region_area_vector, Level::regions);
    act("region_normal", &Overlaps::region_normal, Level::regions);
    act("region_mean_depth", &Overlaps::region_mean_depth, Level::regions);
    act("region_thickness", &Overlaps::region_thickness, Level::regions);
    act("region_box", &Overlaps::region_box, Level::regions);
    act("region_is_contact", &Overlaps::region_is_contact, Level::regions);
    act("region_is_merged", &Overlaps::region_is_merged, Level::regions);
    act("region_pieces", &Overlaps::region_pieces, Level::regions);
    act("winding_offsets", &Overlaps::winding_offsets, Level::offsets);
    act("winding_vertices", &Overlaps::winding_vertices, Level::windings);
    act("windings", &Overlaps::windings, Level::windings);
    act("body_volume", &Overlaps::body_volume, Level::bodies);
    act("is_solid", &Overlaps::is_solid, Level::bodies);
    act("part_pairs", &Overlaps::part_pairs, Level::part_pairs);
    act("part_bodies", &Overlaps::part_bodies, Level::part_pairs);
}

}  // namespace crumple
