#include "launches.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "arguments.h"
#include "arrays.h"
#include "gil.h"
#include "names.h"
#include "queries.h"
#include "results.h"
#include "scene.h"
#include "views.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// Returns the CUDA stream with this address. For None returns null, the legacy default stream.
void* stream_of(nb::handle address) {
    if (address.is_none()) return nullptr;
    return reinterpret_cast<void*>(integer<std::uintptr_t>("stream", address));
}

// Converted arguments of a launch. SharedDetector::keep() keeps them alive until the second launch after this one,
// which waits for this one if necessary.
template <class Query>
struct Launched {
    Launched(const SharedDetector& detector, nb::handle scene, nb::handle query, nb::handle excluded, void* stream)
        : given(detector, scene, stream), asked(query, given, excluded) {}
    BorrowedScene given;
    BorrowedQuery<Query> asked;
};

template <class Query>
LaunchTicket<Query> launch(nb::handle self, nb::handle scene, nb::handle query, nb::handle excluded,
                           nb::handle stream) {
    SharedDetector& detector = detector_of(self);
    auto launched = std::make_shared<Launched<Query>>(detector, scene, query, excluded, stream_of(stream));
    const SharedDetector::Turn turn(detector);
    const Scene view = launched->given.view(detector);
    const auto start = [&](Detector& by, std::stop_token) { return by.launch(view, launched->asked.query); };
    const auto ticket = without_gil([&] { return detector.call(start); }, detector.stop());
    detector.keep(std::move(launched));
    return ticket;
}

// Builder of a dict that describes arrays in device memory, by name: (address, shape, type as NumPy writes it).
class DeviceArrays {
   public:
    template <class Number, class Element>
    void put(const std::string& name, const Element* data, std::int64_t rows, std::size_t columns = 0) {
        static_assert(sizeof(Element) % sizeof(Number) == 0);
        const nb::tuple shape = columns ? nb::make_tuple(rows, columns) : nb::make_tuple(rows);
        arrays_[name.c_str()] = nb::make_tuple(reinterpret_cast<std::uintptr_t>(data), shape, type<Number>());
    }
    nb::dict arrays() const { return arrays_; }

   private:
    template <class Number>
    static const char* type() {
        if constexpr (std::is_same_v<Number, double>) return "<f8";
        if constexpr (std::is_same_v<Number, std::int64_t>) return "<i8";
        if constexpr (std::is_same_v<Number, std::int32_t>) return "<i4";
        return "|u1";
    }
    nb::dict arrays_;
};

// Returns a DLPack capsule of an array that a DeviceArrays describes. The capsule keeps the detector alive. It is not
// read-only, because some packages refuse read-only capsules; writing to the array changes only this result.
nb::object dlpack_capsule(nb::handle detector, std::uintptr_t address, const nb::tuple& shape,
                          const std::string& type) {
    const std::size_t dimensions = shape.size();
    std::array<std::size_t, 2> of{};
    for (std::size_t i = 0; i < std::min<std::size_t>(dimensions, 2); ++i) of[i] = nb::cast<std::size_t>(shape[i]);
    const nb::dlpack::dtype number = type == "<f8"   ? nb::dtype<double>()
                                     : type == "<i8" ? nb::dtype<std::int64_t>()
                                     : type == "<i4" ? nb::dtype<std::int32_t>()
                                                     : nb::dtype<std::uint8_t>();
    return nb::cast(nb::ndarray<>(reinterpret_cast<void*>(address), dimensions, of.data(), detector, nullptr, number,
                                  nb::device::cuda::value, detector_of(detector).options().first_device()));
}

// Returns (complete, rows needed, count, any, first) of a result; `first` is None except for impacts.
template <class Result>
nb::tuple summary_tuple(const Result& found, std::int64_t needed, bool any, nb::object first = nb::none()) {
    return nb::make_tuple(found.complete, needed, found.count, any, first);
}

nb::tuple put(const DeviceIntersections& found, DeviceArrays& there) {
    const std::int64_t n = found.count;
    if (found.complete && found.of_worlds) {
        there.put<std::uint8_t>("world_hit", found.world_hit, found.worlds);
        there.put<std::int64_t>("world_counts", found.world_counts, found.worlds);
        there.put<std::int64_t>("world_offsets", found.world_offsets, found.worlds + 1);
        if (found.pairs) there.put<std::int32_t>("bodies", found.bodies, n, 2);
    } else if (found.complete) {
        there.put<std::int64_t>("offsets", found.offsets, found.hit_count + 1);
        there.put<std::uint8_t>("hit", found.hit, found.hit_count);
        if (found.hit_second) there.put<std::uint8_t>("hit_second", found.hit_second, found.hit_second_count);
    }
    if (found.complete && (found.pairs || !found.of_worlds)) there.put<std::int32_t>("pairs", found.pairs, n, 2);
    if (found.complete && found.contact_kinds) {
        there.put<std::uint8_t>("contact_kinds", found.contact_kinds, n);
        there.put<std::int64_t>("contact_offsets", found.contact_offsets, n + 1);
        there.put<double>("contact_points", found.contact_points, found.contact_point_count, 3);
    }
    return summary_tuple(found, found.pairs_needed, found.any);
}

void put_list(const std::string& name, const DeviceImpactList& list, DeviceArrays& there) {
    there.put<double>(name + "_toi", list.toi, list.count);
    there.put<std::uint8_t>(name + "_start", list.start, list.count);
}
void put_list(const std::string& name, const DeviceProximityList& list, DeviceArrays& there) {
    there.put<double>(name + "_squared_distance", list.squared_distance, list.count);
    there.put<std::uint8_t>(name + "_touching", list.touching, list.count);
}
template <class List>
void put_list(const std::string&, const List&, DeviceArrays&) {}

// Adds the arrays of a result about features. name_of_list(k) returns the name of kind k.
template <class Result, class NameOf>
void put_features(const Result& found, NameOf name_of_list, DeviceArrays& there) {
    if (!found.complete) return;
    there.put<std::int32_t>("edges", found.edges, found.edge_count, 2);
    for (std::size_t k = 0; k < found.lists.size(); ++k) {
        const std::string name(name_of_list(k));
        there.put<std::int32_t>(plural_of_kind(name), found.lists[k].pairs, found.lists[k].count, 2);
        put_list(name, found.lists[k], there);
    }
}

std::string_view feature_name(std::size_t k) { return feature_kind_name(static_cast<FeatureKind>(k)); }

nb::tuple put(const DeviceImpacts& found, DeviceArrays& there) {
    put_features(found, feature_name, there);
    return summary_tuple(found, found.rows_needed, found.any, tuple_of(found.first));
}
nb::tuple put(const DeviceProximities& found, DeviceArrays& there) {
    put_features(found, feature_name, there);
    return summary_tuple(found, found.rows_needed, found.any);
}
nb::tuple put(const DeviceCandidates& found, DeviceArrays& there) {
    put_features(
        found, [](std::size_t k) { return candidate_kind_name(static_cast<CandidateKind>(k)); }, there);
    return summary_tuple(found, found.rows_needed, found.count > 0);
}

// Waits for a launch of the detector `of`. Returns (numbers and flags of the result, its arrays by name, statistics).
template <class Query>
nb::tuple wait(const LaunchTicket<Query>& ticket, nb::handle of) {
    SharedDetector& detector = detector_of(of);
    const SharedDetector::Turn turn(detector);
    const auto wait_on_device = [&](Detector&, std::stop_token stop) {
        return typename Query::DeviceResult(ticket.wait(std::move(stop)));
    };
    const auto found = without_gil([&] { return detector.call(wait_on_device); }, detector.stop());
    DeviceArrays there;
    const nb::tuple values = put(found, there);
    return nb::make_tuple(values, there.arrays(), Statistics(found.statistics));
}

template <class Query>
void bind(nb::class_<SharedDetector>& detector, const std::string& name) {
    nb::class_<LaunchTicket<Query>>(detector, ("_ticket_" + name).c_str()).def("wait", wait<Query>, "detector"_a);
    detector.def(("_launch_" + name).c_str(), launch<Query>, "scene"_a, "query"_a, "excluded"_a.none(),
                 "stream"_a.none());
}

}  // namespace

void bind_launches(nb::class_<SharedDetector>& detector) {
    bind<IntersectionQuery>(detector, "intersections");
    bind<ImpactQuery>(detector, "impacts");
    bind<ProximityQuery>(detector, "proximities");
    bind<CandidateQuery>(detector, "candidates");
    detector.def("_dlpack_capsule", dlpack_capsule, "address"_a, "shape"_a, "type"_a);
}

}  // namespace crumple::python
