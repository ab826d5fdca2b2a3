#include "stencils.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

#include "arguments.h"
#include "crumple/stencils.h"
#include "feature_files.h"
#include "gil.h"
#include "scene.h"
#include "views.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

VertexView view_of(const std::optional<Rows>& rows) {
    return rows ? rows_of_three(rows->data(), static_cast<std::int64_t>(rows->shape(0))) : VertexView{};
}

nb::tuple tuple_of_stencils(Stencils made) {
    Array<std::int64_t> first;
    first.resize_discard(made.first.size());
    std::copy(made.first.begin(), made.first.end(), first.begin());
    return nb::make_tuple(
        moved_to_numpy<std::int32_t>(std::move(made.vertices), 4u), moved_to_numpy<double>(std::move(made.weights), 4u),
        moved_to_numpy<double>(std::move(made.normals), 3u), moved_to_numpy<double>(std::move(made.distance)),
        moved_to_numpy<std::uint8_t>(std::move(made.normal_from)), moved_to_numpy<std::uint8_t>(std::move(made.type)),
        moved_to_numpy<std::int64_t>(std::move(first)), moved_to_numpy<std::int32_t>(std::move(made.multiplicity)),
        moved_to_numpy<std::int64_t>(std::move(made.row_of_pair)),
        moved_to_numpy<std::int64_t>(std::move(made.first_vertex)));
}

// Returns the stencils of a crumple.Impacts or a crumple.Proximities, as a tuple of the members of crumple.Stencils.
template <class Found>
nb::tuple stencils_of(nb::handle scene, const Found& found, const std::optional<Rows>& before,
                      const std::optional<Rows>& rest, nb::handle reduced, nb::handle parallel, nb::handle threads) {
    const StencilOptions options{view_of(before), view_of(rest), flag("reduced", reduced), real("parallel", parallel),
                                 integer<int>("threads", threads)};
    const BorrowedScene borrowed(scene);
    std::vector<Pose> poses, end_poses;
    const Scene view = borrowed.view(poses, end_poses);
    return tuple_of_stencils(without_gil([&] { return stencils(view, *found, options); }));
}

}  // namespace

void bind_stencils(nb::module_& module) {
    const auto bind = [&](const char* name, auto storage_of_result) {
        module.def(
            name,
            [storage_of_result](nb::handle scene, nb::handle result, const std::optional<Rows>& before,
                                const std::optional<Rows>& rest, nb::handle reduced, nb::handle parallel,
                                nb::handle threads) {
                return stencils_of(scene, storage_of_result(result), before, rest, reduced, parallel, threads);
            },
            "scene"_a, "result"_a, "before"_a.none(), "rest"_a.none(), "reduced"_a.none(), "parallel"_a.none(),
            "threads"_a.none());
    };
    bind("stencils_of_impacts", impacts_of);
    bind("stencils_of_proximities", proximities_of);
}

}  // namespace crumple::python
