#include "calls.h"

#include <concepts>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include "arguments.h"
#include "gil.h"
#include "queries.h"
#include "results.h"
#include "scene.h"
#include "views.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

/// Converted arguments of a call, and exclusive use of the detector as long as this object lives.
template <class Query>
struct Call {
    Call(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded)
        : detector(detector_of(self)),
          given(detector, scene),
          asked(query, given, excluded),
          turn(detector),
          view(given.view(detector)) {}

    SharedDetector& detector;
    const BorrowedScene given;
    const BorrowedQuery<Query> asked;
    const SharedDetector::Turn turn;
    const Scene view;
};

// Returns a NumPy array that owns a copy of the values, of shape (n,) or, with one number of `columns`, (n, columns).
template <class Number, class Value, class... Columns>
nb::object to_numpy(const Array<Value>& values, Columns... columns) {
    import_numpy();
    const auto given = new std::vector<Number>(values.begin(), values.end());
    const nb::capsule owner(given, [](void* p) noexcept { delete static_cast<std::vector<Number>*>(p); });
    const std::size_t rows = given->size() / (std::size_t{1} * ... * columns);
    return nb::cast(nb::ndarray<nb::numpy, Number>(given->data(), {rows, std::size_t{columns}...}, owner));
}

// Converts a free step to a tuple of the members of crumple.FreeStep. Positions are float32 if the mesh is, both at the
// start and at the end; else float64.
nb::object tuple_of_step(const FreeStep& step, const Scene& scene) {
    const auto* mesh = std::get_if<MeshView>(&scene.source());
    const bool single = mesh && mesh->vertices.type == ScalarType::float32 && mesh->end.type == ScalarType::float32;
    const nb::object none = nb::none();
    return nb::make_tuple(
        step.share, single ? to_numpy<float>(step.positions, 3u) : to_numpy<double>(step.positions, 3u),
        tuple_of(step.first),
        step.intersects ? nb::object(nb::make_tuple(step.intersecting.a, step.intersecting.b)) : none,
        step.intersects && !mesh
            ? nb::object(nb::make_tuple(step.intersecting_bodies.first, step.intersecting_bodies.second))
            : none,
        step.vertex_shares.empty() ? none : to_numpy<double>(step.vertex_shares),
        step.body_shares.empty() ? none : to_numpy<double>(step.body_shares),
        step.first_vertex.empty() ? none : to_numpy<std::int64_t>(step.first_vertex));
}

template <class Query>
nb::object find(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded) {
    const Call<Query> call(self, scene, query, excluded);
    const auto find_in = [&](auto work) { return without_gil(work, call.detector.stop()); };
    if constexpr (std::same_as<Query, FreeStepQuery>) {
        return tuple_of_step(find_in([&] { return call.detector.find(call.view, call.asked.query); }), call.view);
    } else if constexpr (std::same_as<Query, FirstImpactQuery>) {
        return tuple_of(find_in([&] { return call.detector.find(call.view, call.asked.query); }));
    } else {
        using Result = typename Query::Result;
        SharedDetector& detector = call.detector;
        Shown<Result> result{detector.storage<Result>()};
        find_in([&] { detector.find(call.view, call.asked.query, *result.storage); });
        return nb::cast(std::move(result));
    }
}

template <class Query>
bool supports(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded) {
    const Call<Query> call(self, scene, query, excluded);
    return call.detector.call([&](Detector& by, std::stop_token) { return by.supports(call.view, call.asked.query); });
}

template <class Query>
bool any(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded) {
    const Call<Query> call(self, scene, query, excluded);
    return without_gil([&] { return call.detector.any(call.view, call.asked.query); }, call.detector.stop());
}

template <class Query>
std::vector<Part> partition(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded,
                            nb::handle count) {
    const int parts = integer<int>("count", count);
    const Call<Query> call(self, scene, query, excluded);
    return without_gil([&] { return call.detector.partition(call.view, call.asked.query, parts); },
                       call.detector.stop());
}

// Returns the arrays of a clustering by the names of its members, and `complete`.
nb::dict cluster(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded) {
    const Call<IntersectionQuery> call(self, scene, query, excluded);
    const auto found = new Clustering;
    const nb::capsule owner(found, [](void* p) noexcept { delete static_cast<Clustering*>(p); });
    *found = without_gil([&] { return call.detector.cluster(call.view); }, call.detector.stop());
    import_numpy();
    nb::dict arrays;
    const auto numbers = [&]<class Number>(const char* name, std::vector<Number>& values) {
        arrays[name] = nb::ndarray<nb::numpy, Number>(values.data(), {values.size()}, owner);
    };
    const auto vectors = [&](const char* name, std::vector<Clustering::Vector>& values) {
        arrays[name] = nb::ndarray<nb::numpy, double>(values.data(), {values.size(), 3}, owner);
    };
    vectors("centres", found->centres);
    numbers("offsets", found->offsets);
    numbers("clusters", found->clusters);
    numbers("nearest_cluster", found->nearest_cluster);
    numbers("leaf_cluster", found->leaf_cluster);
    vectors("leaf_centres", found->leaf_centres);
    arrays["axes"] = nb::ndarray<nb::numpy, double>(found->axes.data(), {found->axes.size(), 3, 3}, owner);
    numbers("leaf_offsets", found->leaf_offsets);
    numbers("members", found->members);
    numbers("nearest_leaf", found->nearest_leaf);
    arrays["complete"] = found->complete;
    return arrays;
}

// Returns a copy of the rows of an array (n, 2).
template <class Row>
Array<Row> copy_of_rows(nb::handle given) {
    static_assert(sizeof(Row) == 2 * sizeof(std::int32_t));
    using Rows = nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
    const auto rows = nb::cast<Rows>(given);
    Array<Row> array;
    array.resize_discard(rows.shape(0));
    if (!array.empty()) std::memcpy(static_cast<void*>(array.data()), rows.data(), array.size() * sizeof(Row));
    return array;
}

// Finds overlaps from the results of all parts: tuples (index, count, self_overlaps, pairs, bodies).
nb::object combine(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded, const nb::list& results) {
    std::vector<Overlaps> parts;
    for (const nb::handle result : results) {
        Overlaps& part = parts.emplace_back();
        part.part = {nb::cast<std::int32_t>(result[0]), nb::cast<std::int32_t>(result[1]), nb::cast<bool>(result[2])};
        part.part_pairs = copy_of_rows<Pair>(result[3]);
        part.part_bodies = copy_of_rows<BodyPair>(result[4]);
    }
    const Call<OverlapQuery> call(self, scene, query, excluded);
    SharedDetector& detector = call.detector;
    Shown<Overlaps> result{detector.storage<Overlaps>()};
    without_gil([&] { detector.combine(call.view, call.asked.query, parts, *result.storage); }, detector.stop());
    return nb::cast(std::move(result));
}

// Counts the rows of a block. block.count is not used, because it includes the rows of all earlier blocks.
template <class Block>
std::int64_t rows_of(const Block& block) {
    std::int64_t rows = 0;
    for (const auto& list : block.lists) rows += static_cast<std::int64_t>(list.pairs.size());
    return rows;
}
std::int64_t rows_of(const Intersections& block) { return static_cast<std::int64_t>(block.pairs.size()); }
std::int64_t rows_of(const Overlaps& block) { return static_cast<std::int64_t>(block.bodies.size()); }

/// Runs a streamed search. Calls the Python function `take` with a copy of each block, with the GIL.
template <class Query>
Statistics stream(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded, nb::handle take,
                  nb::handle block_rows) {
    using Block = typename Query::Result;
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const Call<Query> call(self, scene, query, excluded);
    const auto consume_copy = [&](const Block& block) {
        Shown<Block> copy{std::make_shared<Block>(block)};
        copy.storage->count = rows_of(block);
        const nb::object shown = nb::cast(std::move(copy));
        PyObject* const done =
            in_python([&] { return PyObject_CallFunctionObjArgs(take.ptr(), shown.ptr(), nullptr); });
        if (!done) throw nb::python_error();
        Py_DECREF(done);
    };
    const auto deliver = [&](Detector& by, auto& sink, std::stop_token stop) {
        return by.stream(call.view, call.asked.query, sink, rows, std::move(stop));
    };
    SharedDetector& detector = call.detector;
    return without_gil([&] { return detector.stream<Block>(consume_copy, deliver); }, detector.stop());
}

template <class Query>
void bind_find(nb::class_<SharedDetector>& detector, const std::string& name) {
    detector.def(("_find_" + name).c_str(), find<Query>, "scene"_a, "query"_a, "excluded"_a.none());
    detector.def(("_supports_" + name).c_str(), supports<Query>, "scene"_a, "query"_a, "excluded"_a.none());
}

template <class Query>
void bind_any(nb::class_<SharedDetector>& detector, const std::string& name) {
    detector.def(("_any_" + name).c_str(), any<Query>, "scene"_a, "query"_a, "excluded"_a.none());
}

template <class Query>
void bind_stream(nb::class_<SharedDetector>& detector, const std::string& name) {
    detector.def(("_stream_" + name).c_str(), stream<Query>, "scene"_a, "query"_a, "excluded"_a.none(), "take"_a,
                 "block_rows"_a.none());
}

template <class Query>
void bind_partition(nb::class_<SharedDetector>& detector, const std::string& name) {
    detector.def(("_partition_" + name).c_str(), partition<Query>, "scene"_a, "query"_a, "excluded"_a.none(),
                 "count"_a.none());
}

template <class Query>
void bind_pairs(nb::class_<SharedDetector>& detector, const std::string& name) {
    bind_find<Query>(detector, name);
    bind_stream<Query>(detector, name);
    bind_any<Query>(detector, name);
    bind_partition<Query>(detector, name);
}

}  // namespace

void bind_calls(nb::class_<SharedDetector>& detector) {
    bind_pairs<IntersectionQuery>(detector, "intersections");
    bind_pairs<ImpactQuery>(detector, "impacts");
    bind_pairs<ProximityQuery>(detector, "proximities");
    bind_find<CandidateQuery>(detector, "candidates");
    bind_stream<CandidateQuery>(detector, "candidates");
    bind_find<DistanceQuery>(detector, "distances");
    bind_find<OverlapQuery>(detector, "overlaps");
    bind_any<OverlapQuery>(detector, "overlaps");
    bind_stream<OverlapQuery>(detector, "overlaps");
    bind_partition<OverlapQuery>(detector, "overlaps");
    detector.def("_combine_overlaps", combine, "scene"_a, "query"_a, "excluded"_a.none(), "results"_a);
    bind_find<FirstImpactQuery>(detector, "first_impact");
    bind_find<FreeStepQuery>(detector, "free_step");
    detector.def("_cluster_intersections", cluster, "scene"_a, "query"_a, "excluded"_a.none());
}

}  // namespace crumple::python
