#pragma once

// Table of the arrays of an overlap query's result.

#include "crumple/overlaps.h"

namespace crumple {

/// Calls act(name, member pointer) for each array of Overlaps.
template <class Act>
void for_each_overlap_array(Act act) {
    act("world_hit", &Overlaps::world_hit);
    act("skipped", &Overlaps::skipped);
    act("bodies", &Overlaps::bodies);
    act("relation", &Overlaps::relation);
    act("volume", &Overlaps::volume);
    act("centroid", &Overlaps::centroid);
    act("area_vector", &Overlaps::area_vector);
    act("normal", &Overlaps::normal);
    act("mean_depth", &Overlaps::mean_depth);
    act("torque", &Overlaps::torque);
    act("torque_point", &Overlaps::torque_point);
    act("contact_area", &Overlaps::contact_area);
    act("box", &Overlaps::box);
    act("thickness", &Overlaps::thickness);
    act("withdrawals", &Overlaps::withdrawals);
    act("translation_low", &Overlaps::translation_low);
    act("translation_high", &Overlaps::translation_high);
    act("translation", &Overlaps::translation);
    act("depth_offsets", &Overlaps::depth_offsets);
    act("depth_vertices", &Overlaps::depth_vertices);
    act("depths", &Overlaps::depths);
    act("depth_points", &Overlaps::depth_points);
    act("depth_triangles", &Overlaps::depth_triangles);
    act("deepest", &Overlaps::deepest);
    act("depth_reached", &Overlaps::depth_reached);
    act("depth_bound", &Overlaps::depth_bound);
    act("union_volume", &Overlaps::union_volume);
    act("intersection_over_union", &Overlaps::intersection_over_union);
    act("difference_volume", &Overlaps::difference_volume);
    act("gradient_offsets", &Overlaps::gradient_offsets);
    act("gradient_vertices", &Overlaps::gradient_vertices);
    act("gradient", &Overlaps::gradient);
    act("curve_offsets", &Overlaps::curve_offsets);
    act("curve_closed", &Overlaps::curve_closed);
    act("curve_area_vector", &Overlaps::curve_area_vector);
    act("curve_torque", &Overlaps::curve_torque);
    act("curve_point_offsets", &Overlaps::curve_point_offsets);
    act("curve_points", &Overlaps::curve_points);
    act("curve_triangles", &Overlaps::curve_triangles);
    act("curve_regions", &Overlaps::curve_regions);
    act("region_offsets", &Overlaps::region_offsets);
    act("region_volume", &Overlaps::region_volume);
    act("region_centroid", &Overlaps::region_centroid);
    act("region_area_vector", &Overlaps::region_area_vector);
    act("region_normal", &Overlaps::region_normal);
    act("region_mean_depth", &Overlaps::region_mean_depth);
    act("region_thickness", &Overlaps::region_thickness);
    act("region_box", &Overlaps::region_box);
    act("region_is_contact", &Overlaps::region_is_contact);
    act("region_is_merged", &Overlaps::region_is_merged);
    act("region_pieces", &Overlaps::region_pieces);
    act("winding_offsets", &Overlaps::winding_offsets);
    act("winding_vertices", &Overlaps::winding_vertices);
    act("windings", &Overlaps::windings);
    act("body_volume", &Overlaps::body_volume);
    act("is_solid", &Overlaps::is_solid);
}

}  // namespace crumple
