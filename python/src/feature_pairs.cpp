#include "feature_pairs.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>

#include "arguments.h"
#include "arrays.h"
#include "crumple/feature_pairs.h"
#include "crumple/rigid_motion.h"
#include "gil.h"
#include "names.h"
#include "views.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

VertexView view_of(const Rows& rows) { return rows_of_three(rows.data(), static_cast<std::int64_t>(rows.shape(0))); }

nb::tuple impacts(nb::handle kind, const Rows& start, const Rows& end, nb::handle min_distance,
                  nb::handle min_distance_share, nb::handle approaching_only, nb::handle threads) {
    const FeatureKind of = named(feature_kind_names, "kind", kind);
    const PairImpactQuery query{real("min_distance", min_distance), real("min_distance_share", min_distance_share),
                                integer<int>("threads", threads), flag("approaching_only", approaching_only)};
    PairImpacts answer = without_gil([&] { return pair_impacts(of, view_of(start), view_of(end), query); });
    return nb::make_tuple(moved_to_numpy<bool>(std::move(answer.hit)), moved_to_numpy<double>(std::move(answer.toi)),
                          moved_to_numpy<bool>(std::move(answer.start)));
}

nb::tuple distances(nb::handle kind, const Rows& points, nb::handle threads) {
    const FeatureKind of = named(feature_kind_names, "kind", kind);
    const int wanted = integer<int>("threads", threads);
    PairDistances answer = without_gil([&] { return pair_distances(of, view_of(points), wanted); });
    return nb::make_tuple(
        moved_to_numpy<double>(std::move(answer.squared_distance)), moved_to_numpy<bool>(std::move(answer.touching)),
        moved_to_numpy<std::uint8_t>(std::move(answer.type)), moved_to_numpy<double>(std::move(answer.at), 2u));
}

using Poses = nb::ndarray<const double, nb::shape<-1, 3, 4>, nb::c_contig, nb::device::cpu>;
using Radii = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::span<const Pose> poses_of(const Poses& poses) {
    return {reinterpret_cast<const Pose*>(poses.data()), poses.shape(0)};
}

nb::tuple rigid_motion(const Poses& start, const Poses& end, const Radii& radii, nb::handle tolerance) {
    const double within = real("tolerance", tolerance);
    RigidMotion motion = cut_rigid_motion(poses_of(start), poses_of(end), {radii.data(), radii.shape(0)}, within);
    import_numpy();
    const auto given = new std::vector<Pose>(std::move(motion.poses));
    const nb::capsule owner(given, [](void* p) noexcept { delete static_cast<std::vector<Pose>*>(p); });
    const std::size_t moments = static_cast<std::size_t>(motion.pieces) + 1;
    return nb::make_tuple(nb::cast(nb::ndarray<nb::numpy, double>(given->data()->rows.data(),
                                                                  {moments, given->size() / moments, 3, 4}, owner)),
                          motion.min_distance);
}

}  // namespace

void bind_feature_pairs(nb::module_& module) {
    module.def("pair_impacts", impacts, "kind"_a.none(), "start"_a, "end"_a, "min_distance"_a.none(),
               "min_distance_share"_a.none(), "approaching_only"_a.none(), "threads"_a.none());
    module.def("rigid_motion", rigid_motion, "start"_a, "end"_a, "radii"_a, "tolerance"_a.none());
    module.def("pair_distances", distances, "kind"_a.none(), "points"_a, "threads"_a.none());
}

}  // namespace crumple::python
