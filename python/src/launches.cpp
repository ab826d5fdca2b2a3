#include "launches.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "arguments.h"
#include "arrays.h"
#include "feature_search.h"
#include "gil.h"
#include "names.h"
#include "query.h"
#include "world.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// What launches are given, which lives until the second launch after it: each is waited for by then.
struct LaunchedMeshes {
    LaunchedMeshes(const SharedDetector& detector, const nb::tuple& one, const std::optional<nb::tuple>& other,
                   void* stream)
        : meshes(one, other, stream) {
        check_device(detector, meshes.first.device());
        if (other) check_device(detector, meshes.second->device());
    }
    BorrowedMeshes meshes;
};

struct LaunchedFeatures {
    LaunchedFeatures(const SharedDetector& detector, const nb::tuple& mesh, const nb::tuple& lists, nb::handle at_end,
                     void* stream)
        : start(detector, mesh, lists, stream) {
        if (!at_end.is_none()) end.emplace(at_end, start.mesh);
    }
    AskedOfMesh start;
    std::optional<BorrowedEnd> end;
    std::optional<AskedOfVertices> vertices;
};

// Returns the CUDA stream with this address. None is the legacy default stream: null.
void* stream_of(nb::handle address) {
    if (address.is_none()) return nullptr;
    return reinterpret_cast<void*>(integer<std::uintptr_t>("stream", address));
}

// Has launch(detector) start work on what is given, and keeps that.
template <class Given, class Launch>
void launch(SharedDetector& detector, std::shared_ptr<Given> given, Launch launch) {
    const SharedDetector::Turn turn(detector);
    without_gil([&] { detector.call([&](Detector& by, std::stop_token) { launch(by); }); }, detector.stop());
    detector.keep(std::move(given));
}

void launch_meshes(nb::handle self, const nb::tuple& first, const std::optional<nb::tuple>& second,
                   const IntersectionQuery& query, nb::handle stream) {
    SharedDetector& detector = detector_of(self);
    const auto given = std::make_shared<LaunchedMeshes>(detector, first, second, stream_of(stream));
    launch(detector, given, [&](Detector& by) { by.launch(given->meshes.scene(), query); });
}

void launch_impacts(nb::handle self, const nb::tuple& mesh, nb::handle end, const ImpactQuery& question,
                    const nb::tuple& lists, nb::handle stream) {
    SharedDetector& detector = detector_of(self);
    if (end.is_none()) refuse("launch_impacts needs the vertices at the end");
    const auto given = std::make_shared<LaunchedFeatures>(detector, mesh, lists, end, stream_of(stream));
    launch(detector, given,
           [&](Detector& by) { by.launch(given->start.view.moving_to(given->end->view()), question); });
}

void launch_near(nb::handle self, const nb::tuple& mesh, const ProximityQuery& question, nb::handle radii,
                 nb::handle rest, const nb::tuple& lists, nb::handle stream) {
    SharedDetector& detector = detector_of(self);
    const auto given = std::make_shared<LaunchedFeatures>(detector, mesh, lists, nb::none(), stream_of(stream));
    given->vertices.emplace(question, given->start.mesh, radii, rest);
    launch(detector, given, [&](Detector& by) { by.launch(given->start.view, given->vertices->question); });
}

void launch_candidates(nb::handle self, const nb::tuple& mesh, nb::handle end, const CandidateQuery& question,
                       const nb::tuple& lists, nb::handle stream) {
    SharedDetector& detector = detector_of(self);
    const auto given = std::make_shared<LaunchedFeatures>(detector, mesh, lists, end, stream_of(stream));
    launch(detector, given, [&](Detector& by) {
        by.launch(given->end ? given->start.view.moving_to(given->end->view()) : given->start.view, question);
    });
}

struct LaunchedWorld {
    LaunchedWorld(const SharedDetector& detector, nb::handle world, nb::handle poses, void* stream)
        : bodies(given_world(world).bodies), at(poses, *bodies, BorrowedPoses::When::start, stream) {
        if (at.device() == BorrowedArray::on_host)
            refuse("launch takes poses in CUDA memory: find takes those of the host");
        check_device(detector, at.device());
    }
    std::shared_ptr<const Bodies> bodies;
    BorrowedPoses at;
};

void launch_world(nb::handle self, nb::handle world, nb::handle poses, const IntersectionQuery& question,
                  nb::handle excluded, nb::handle stream) {
    SharedDetector& detector = detector_of(self);
    const auto given = std::make_shared<LaunchedWorld>(detector, world, poses, stream_of(stream));
    IntersectionQuery asked = question;
    asked.filter.excluded_bodies = excluded_bodies(*given->bodies, excluded);
    World view{given->bodies->shapes, given->bodies->bodies, {}};
    view.device_poses = given->at.on_device(*given->bodies);
    launch(detector, given, [&](Detector& by) { by.launch(view, asked); });
}

// Arrays of the device: of each its address, shape, and type as NumPy writes it.
class ArraysThere {
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

// One of these for DLPack, which keeps the detector. Not read-only, for not everybody knows such capsules: who writes
// to it spoils the answer alone.
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

// Waits, and gives what `tell` makes of the answer.
template <class Wait, class Tell>
nb::tuple wait_with(nb::handle self, Wait wait, Tell tell) {
    SharedDetector& detector = detector_of(self);
    const SharedDetector::Turn turn(detector);
    const auto found = without_gil(
        [&] { return detector.call([&](Detector& by, std::stop_token stop) { return wait(by, std::move(stop)); }); },
        detector.stop());
    ArraysThere there;
    const nb::tuple told = tell(found, there);
    return nb::make_tuple(told, there.arrays(), Statistics(found.statistics));
}

nb::tuple wait(nb::handle self) {
    return wait_with(
        self, [](Detector& by, std::stop_token stop) { return DeviceIntersections(by.wait(std::move(stop))); },
        [](const DeviceIntersections& found, ArraysThere& there) {
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
            if (found.complete && (found.pairs || !found.of_worlds))
                there.put<std::int32_t>("pairs", found.pairs, n, 2);
            if (found.complete && found.contact_kinds) {
                there.put<std::uint8_t>("contact_kinds", found.contact_kinds, n);
                there.put<std::int64_t>("contact_offsets", found.contact_offsets, n + 1);
                there.put<double>("contact_points", found.contact_points, found.contact_point_count, 3);
            }
            return found.of_worlds ? nb::make_tuple(found.complete, found.pairs_needed, n, found.any)
                                   : nb::make_tuple(found.complete, found.pairs_needed, n);
        });
}

void put_edges(const DeviceFeatures& found, ArraysThere& there) {
    if (found.complete) there.put<std::int32_t>("edges", found.edges, found.edge_count, 2);
}

// The members of crumple.FirstImpact.
nb::object told(const FirstImpact& first) {
    if (!first.found) return nb::none();
    const std::string_view kind = feature_kind_name(first.kind);
    return nb::make_tuple(nb::str(kind.data(), kind.size()), nb::make_tuple(first.pair.a, first.pair.b), nb::none(),
                          first.toi, first.start);
}

nb::tuple wait_impacts(nb::handle self) {
    return wait_with(
        self, [](Detector& by, std::stop_token stop) { return DeviceImpacts(by.wait<ImpactQuery>(std::move(stop))); },
        [](const DeviceImpacts& found, ArraysThere& there) {
            put_edges(found, there);
            for (std::size_t k = 0; k < found.lists.size() && found.complete; ++k) {
                const DeviceImpactList& list = found.lists[k];
                const std::string name(feature_kind_name(static_cast<FeatureKind>(k)));
                there.put<std::int32_t>(plural_of_kind(name), list.pairs, list.count, 2);
                there.put<double>(name + "_toi", list.toi, list.count);
                there.put<std::uint8_t>(name + "_start", list.start, list.count);
            }
            return nb::make_tuple(found.complete, found.rows_needed, found.count, found.any, told(found.first));
        });
}

nb::tuple wait_near(nb::handle self) {
    return wait_with(
        self,
        [](Detector& by, std::stop_token stop) { return DeviceProximities(by.wait<ProximityQuery>(std::move(stop))); },
        [](const DeviceProximities& found, ArraysThere& there) {
            put_edges(found, there);
            for (std::size_t k = 0; k < found.lists.size() && found.complete; ++k) {
                const DeviceProximityList& list = found.lists[k];
                const std::string name(feature_kind_name(static_cast<FeatureKind>(k)));
                there.put<std::int32_t>(plural_of_kind(name), list.pairs, list.count, 2);
                there.put<double>(name + "_squared_distance", list.squared_distance, list.count);
                there.put<std::uint8_t>(name + "_touching", list.touching, list.count);
            }
            return nb::make_tuple(found.complete, found.rows_needed, found.count, found.any);
        });
}

nb::tuple wait_candidates(nb::handle self) {
    return wait_with(
        self,
        [](Detector& by, std::stop_token stop) { return DeviceCandidates(by.wait<CandidateQuery>(std::move(stop))); },
        [](const DeviceCandidates& found, ArraysThere& there) {
            put_edges(found, there);
            for (std::size_t k = 0; k < found.lists.size() && found.complete; ++k) {
                const std::string name(candidate_kind_name(static_cast<CandidateKind>(k)));
                there.put<std::int32_t>(plural_of_kind(name), found.lists[k].pairs, found.lists[k].count, 2);
            }
            return nb::make_tuple(found.complete, found.rows_needed, found.count);
        });
}

}  // namespace

void bind_launches(nb::class_<SharedDetector>& detector) {
    detector.def("_launch", launch_meshes, "first"_a, "second"_a.none(), "query"_a, "stream"_a.none())
        .def("_launch_world", launch_world, "world"_a, "poses"_a.none(), "question"_a, "excluded"_a.none(),
             "stream"_a.none())
        .def("_launch_impacts", launch_impacts, "mesh"_a, "end"_a.none(), "question"_a, "lists"_a, "stream"_a.none())
        .def("_launch_near", launch_near, "mesh"_a, "question"_a, "radii"_a.none(), "rest"_a.none(), "lists"_a,
             "stream"_a.none())
        .def("_launch_candidates", launch_candidates, "mesh"_a, "end"_a.none(), "question"_a, "lists"_a,
             "stream"_a.none())
        .def("_dlpack_capsule", dlpack_capsule, "address"_a, "shape"_a, "type"_a)
        .def("_wait", wait)
        .def("_wait_impacts", wait_impacts)
        .def("_wait_near", wait_near)
        .def("_wait_candidates", wait_candidates);
}

}  // namespace crumple::python
