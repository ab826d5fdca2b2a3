#include "feature_pairs.h"

#include <cstdint>
#include <utility>

#include <nanobind/ndarray.h>

#include "arguments.h"
#include "arrays.h"
#include "crumple/feature_pairs.h"
#include "gil.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using FindImpacts = PairImpacts (*)(const VertexView&, const VertexView&, const PairMotion&, std::stop_token);
using FindDistances = PairDistances (*)(const VertexView&, int, std::stop_token);

VertexView view_of(const Rows& rows) { return rows_of_three(rows.data(), static_cast<std::int64_t>(rows.shape(0))); }

// The array as NumPy's, which owns it from now on.
template <class Number, class Element, class... Columns>
nb::object give(Array<Element> array, Columns... columns) {
    import_numpy();
    const auto given = new Array<Element>(std::move(array));
    const nb::capsule owner(given, [](void* p) noexcept { delete static_cast<Array<Element>*>(p); });
    void* const data = given->data();
    return nb::cast(
        nb::ndarray<nb::numpy, Number>(static_cast<Number*>(data), {given->size(), std::size_t{columns}...}, owner));
}

template <FindImpacts find>
nb::tuple impacts(const Rows& start, const Rows& end, nb::handle min_distance, nb::handle min_distance_share,
                  nb::handle threads) {
    const PairMotion question{real("min_distance", min_distance), real("min_distance_share", min_distance_share),
                              integer<int>("threads", threads)};
    PairImpacts answer = without_gil([&] { return find(view_of(start), view_of(end), question, {}); });
    return nb::make_tuple(give<bool>(std::move(answer.hit)), give<double>(std::move(answer.toi)),
                          give<bool>(std::move(answer.start)));
}

template <FindDistances find>
nb::tuple distances(const Rows& points, nb::handle threads) {
    const int wanted = integer<int>("threads", threads);
    PairDistances answer = without_gil([&] { return find(view_of(points), wanted, {}); });
    return nb::make_tuple(give<double>(std::move(answer.squared_distance)), give<bool>(std::move(answer.touching)),
                          give<std::uint8_t>(std::move(answer.type)), give<double>(std::move(answer.at), 2u));
}

}  // namespace

void bind_feature_pairs(nb::module_& module) {
    const auto bind_impacts = [&](const char* name, auto function) {
        module.def(name, function, "start"_a, "end"_a, "min_distance"_a.none(), "min_distance_share"_a.none(),
                   "threads"_a.none());
    };
    bind_impacts("vertex_face_impacts", impacts<vertex_face_impacts>);
    bind_impacts("edge_edge_impacts", impacts<edge_edge_impacts>);
    bind_impacts("vertex_edge_impacts", impacts<vertex_edge_impacts>);
    bind_impacts("vertex_vertex_impacts", impacts<vertex_vertex_impacts>);
    module.def("vertex_face_distances", distances<vertex_face_distances>, "points"_a, "threads"_a.none());
    module.def("edge_edge_distances", distances<edge_edge_distances>, "points"_a, "threads"_a.none());
    module.def("vertex_edge_distances", distances<vertex_edge_distances>, "points"_a, "threads"_a.none());
    module.def("vertex_vertex_distances", distances<vertex_vertex_distances>, "points"_a, "threads"_a.none());
}

}  // namespace crumple::python
