#include "queries/checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "crumple/error.h"
#include "partition/fuzzy_c_means.h"

namespace crumple {
namespace {

constexpr const char* nothing_to_exclude = "excluded_groups need groups, and the mesh has none";
constexpr const char* no_groups =
    "filter.groups = between needs groups, and the mesh has none: nothing lies between different groups";

void check_method(const Method& m) {
    const auto& [x, y, z] = m.direction;
    const bool given = m.sweep == SweepDirection::given;
    check(m.sweep <= SweepDirection::given, "the sweep direction must be pca, x, y, z or given");
    check(std::isfinite(x) && std::isfinite(y) && std::isfinite(z), "the sweep direction must be finite");
    check(!given || x != 0 || y != 0 || z != 0, "the sweep direction must not be 0");
    check(given || (x == 0 && y == 0 && z == 0), "a vector of the sweep direction needs SweepDirection::given");
    check(m.membership <= Membership::threshold, "the membership rule must be ball, equation_5 or threshold");
    check(m.threshold >= 0 && m.threshold <= 1, "the membership threshold must be 0 to 1");
    check(m.threshold == 0 || m.membership == Membership::threshold,
          "a membership threshold needs the membership rule threshold");
}

void check_whole_bodies(const PairFilter& filter, const World& world) {
    const bool by_groups = filter.groups != PairScope::both || !filter.excluded_groups.empty();
    for (const Shape& shape : world.shapes)
        check(!by_groups || shape.groups.empty(),
              "a filter of groups needs shapes without groups of triangles: overlaps and containment are properties of "
              "whole bodies");
}

}  // namespace

void check(bool holds, const char* message) {
    if (!holds) throw Error(ErrorCode::invalid_argument, message, Element::option);
}

void check_options(const Options& o) {
    check(o.threads >= 0, "threads must be 0 (as many as the machine has) or more");
    check(o.threads <= 1024, "threads must be at most 1024");
    check(!o.executor || (o.executor->concurrency() >= 1 && o.executor->concurrency() <= 1024),
          "an executor must have 1 to 1024 workers");
    check(o.device >= 0, "device must be 0 or more");
    check(o.device == 0 || o.devices.empty(), "device must be 0 if devices are given");
    check(o.devices.size() <= 64, "devices must have at most 64 entries");
    for (auto d = o.devices.begin(); d != o.devices.end(); ++d)
        check(*d >= 0 && std::find(o.devices.begin(), d, *d) == d, "devices must be 0 or more, and all different");
    check(o.memory_limit >= 0, "memory_limit must be 0 (no limit) or a positive number of bytes");
    check(o.clusters >= 0 && o.clusters <= max_clusters, "clusters must be 0 (automatic) to 64");
    check(o.leaf_size >= 1, "leaf_size must be at least 1");
    const FuzzyCMeans& means = o.fuzzy_c_means;
    check(means.fuzziness > 1 && std::isfinite(means.fuzziness), "fuzziness must be finite and above 1");
    check(means.max_iterations >= 0 && means.first_iterations >= 0,
          "max_iterations and first_iterations must be 0 or more");
    check(means.stop >= 0 && means.first_stop >= 0, "stop and first_stop must be 0 or more");
    check_method(o.method);
}

void check_device_poses(const World& world) {
    check(world.poses.empty() && world.end_poses.empty(),
          "poses must be in device memory or in host memory, not in both");
    check(given(world.device_poses) || !given(world.device_end_poses),
          "poses at the start must be in device memory, like those at the end");
    for (const DevicePoses* poses : {&world.device_poses, &world.device_end_poses}) {
        if (poses == &world.device_end_poses && !given(*poses)) continue;  // the same as at the start
        if (poses->count != static_cast<std::int64_t>(world.bodies.size()))
            throw Error(ErrorCode::invalid_argument, "there are " + std::to_string(poses->count) + " poses for " +
                                                         std::to_string(world.bodies.size()) + " bodies");
        check(poses->data || poses->count == 0, "poses have no data");
        const std::size_t size = poses->type == ScalarType::float32 ? sizeof(float) : sizeof(double);
        check(reinterpret_cast<std::uintptr_t>(poses->data) % size == 0, "poses must be aligned to their number type");
    }
}

void check_on_device(const IntersectionQuery& query) {
    check(query.output != Output::body_pairs, "output must not be body_pairs: launches do not support it; use find()");
    check(!query.index, "index must be false: launches make offsets by world only");
    check(!query.containment, "containment must be false: launches do not support it");
}

void check_blocks(std::int64_t block_rows) {
    check(block_rows >= 1 && block_rows <= std::int64_t{1} << 40, "block_rows must be 1 to 2^40");
}

void check_in_blocks(const IntersectionQuery& q) {
    check(q.output == Output::pairs || q.output == Output::contacts,
          "output must be pairs or contacts: blocks list them");
}

void check_in_blocks(const ImpactQuery& q) {
    check(q.output == Output::pairs, "output must be pairs: blocks list them");
    check(!q.index, "index must be false: blocks have no offsets by feature");
    check(!q.triangle_pairs, "triangle_pairs must be false: blocks do not support them");
}

void check_in_blocks(const ProximityQuery& q) {
    check(q.output == Output::pairs, "output must be pairs: blocks list them");
    check(!q.index, "index must be false: blocks have no offsets by feature");
    check(!q.least, "least must be false: blocks have no least distances");
}

void check_in_blocks(const OverlapQuery& q) {
    check(q.output == Output::body_pairs || q.output == Output::pairs,
          "output must be body_pairs or pairs: blocks list them");
}

void check_query_options(const IntersectionQuery& q) {
    check(q.output <= Output::contacts && q.output != Output::first && q.output != Output::nearest,
          "output must be any, any_by_world, body_pairs, count, pairs or contacts");
    if (!q.containment) return;
    check(q.output <= Output::body_pairs,
          "output must be any, any_by_world or body_pairs with containment: a body inside another one has no pairs of "
          "triangles; use an OverlapQuery for its volume");
    check(q.kind == IntersectionKind::all,
          "kind must be all with containment; an overlap query with a min_volume leaves out bodies that only touch");
    check(q.open != OpenSurfaces::curves, "open must be error or skip with containment: curves is for overlaps only");
    check(!q.weld || q.neighbours == Neighbours::geometric, "neighbours must be geometric with containment and weld");
}

void check_containment(const IntersectionQuery& q, const World& world) {
    check_whole_bodies(q.filter, world);
    check(q.filter.bodies != PairScope::within, "filter.bodies must not be within: containment is between bodies");
}

void check_query_options(const ImpactQuery& q, bool world) {
    check(q.output == Output::any || q.output == Output::any_by_world || q.output == Output::first ||
              q.output == Output::pairs,
          "output must be any, any_by_world, first or pairs");
    check(!world || !q.index, "index must be false: only a single mesh has offsets by feature");
    check(q.min_distance >= 0 && std::isfinite(q.min_distance), "min_distance must be finite and 0 or more");
    check(q.min_distance_share >= 0 && q.min_distance_share < 1, "min_distance_share must be 0 or more, and below 1");
}

void check_query_options(const ProximityQuery& q, bool world) {
    check(q.output == Output::any || q.output == Output::any_by_world || q.output == Output::pairs,
          "output must be any, any_by_world or pairs");
    check(!world || !q.index, "index must be false: only a single mesh has offsets by feature");
    check(!world || !q.least, "least must be false: only a single mesh has least distances");
    check(q.radius >= 0 && std::isfinite(q.radius), "radius must be finite and 0 or more");
    check(!world || q.radii.empty(), "radii must be empty for a world; use Shape::radii");
    check(!world || (!q.rest.data && q.rest.rows == 0), "rest must be empty for a world; use Shape::rest");
    check(q.rings >= 0, "rings must be 0 or more");
    check(q.rest_radius >= 0 && std::isfinite(q.rest_radius), "rest_radius must be finite and 0 or more");
}

void check_query_options(const CandidateQuery& q, bool) {
    check(!q.kinds.empty(), "kinds must have at least one kind of candidates");
    for (const CandidateKind kind : q.kinds)
        check(static_cast<int>(kind) < candidate_kinds, "kinds must be values of CandidateKind");
    check(q.inflation >= 0 && std::isfinite(q.inflation), "inflation must be finite and 0 or more");
}

void check_query_options(const DistanceQuery& q) {
    check(q.output == Output::nearest || q.output == Output::pairs, "output must be nearest or pairs");
    check(q.radius >= 0, "radius must be 0 or more, or infinite");
    check(q.filter.bodies != PairScope::within, "filter.bodies must not be within: distances are between bodies");
}

void check_query_options(const OverlapQuery& q, const World& world) {
    check(q.output == Output::any || q.output == Output::any_by_world || q.output == Output::body_pairs ||
              q.output == Output::pairs,
          "output must be any, any_by_world, body_pairs or pairs");
    check_whole_bodies(q.filter, world);
    check(q.min_volume >= 0 && std::isfinite(q.min_volume), "min_volume must be finite and 0 or more");
    check(q.depth_tolerance >= 0 && std::isfinite(q.depth_tolerance), "depth_tolerance must be finite and 0 or more");
    for (const auto& [x, y, z] : q.directions) {
        check(std::isfinite(x) && std::isfinite(y) && std::isfinite(z), "directions must be finite");
        check(x != 0 || y != 0 || z != 0, "a direction must not be 0");
    }
    check(!q.first_free || !q.directions.empty(), "first_free needs directions");
    check(q.filter.bodies != PairScope::within, "filter.bodies must not be within: overlaps are between bodies");
}

void check_query(const MeshView& a, const MeshView* b, const IntersectionQuery& q) {
    check_query_options(q);
    check(q.filter.bodies == PairScope::both && q.filter.excluded_bodies.empty(),
          "a filter of bodies needs a world of bodies");
    check(q.filter.groups == PairScope::both || q.filter.groups == PairScope::between ||
              q.filter.groups == PairScope::within,
          "filter.groups must be both, between or within");
    // If a mesh has no triangles, this query is not refused for lack of groups, since that mesh cannot show whether it
    // has any. Of two meshes, one with groups suffices, because the other one is then in group 0.
    const auto lacks_groups = [](const MeshView& mesh) { return mesh.triangles.rows > 0 && mesh.groups.empty(); };
    if (!lacks_groups(a) || (b && !lacks_groups(*b))) return;
    check(q.filter.excluded_groups.empty(),
          b ? "excluded_groups need groups, and neither mesh has any" : nothing_to_exclude);
    check(q.filter.groups != PairScope::between,
          b ? "filter.groups = between needs groups, and neither mesh has any: nothing lies between different groups"
            : no_groups);
}

void check_groups(const PairFilter& rules, std::int64_t triangles, bool has_groups) {
    check(rules.groups != PairScope::between || has_groups || triangles == 0, no_groups);
    check(rules.excluded_groups.empty() || has_groups || triangles == 0, nothing_to_exclude);
}

}  // namespace crumple
