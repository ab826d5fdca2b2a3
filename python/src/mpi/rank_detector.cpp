#include "mpi/rank_detector.h"

#include <array>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "arguments.h"
#include "errors.h"
#include "gil.h"
#include "mpi/rank_results.h"
#include "options.h"
#include "queries.h"
#include "signals.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// Converts a number to an MPI handle: a pointer in Open MPI, an integer in MPICH.
template <class Handle>
Handle handle_of(std::uintptr_t number) {
    if constexpr (std::is_pointer_v<Handle>)
        return reinterpret_cast<Handle>(number);  // NOLINT(performance-no-int-to-ptr)
    else
        return static_cast<Handle>(number);
}

template <class Handle>
std::uintptr_t number_of(Handle handle) {
    if constexpr (std::is_pointer_v<Handle>)
        return reinterpret_cast<std::uintptr_t>(handle);
    else
        return static_cast<std::uintptr_t>(handle);
}

std::string mpi_library() {
    std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
    int length = 0;
    MPI_Get_library_version(text.data(), &length);
    return text.data();  // up to the terminating 0, which some libraries include in `length`
}

// C++ exception that replaces a Python exception: the collective error check can throw it on all ranks, including ranks
// on which no Python exception was raised. Its message has the class and the message of the Python exception.
struct Interrupted final : std::runtime_error {
    using std::runtime_error::runtime_error;
};

std::string name_of_class(nb::handle exception) { return nb::cast<std::string>(exception.type().attr("__name__")); }

// Converts a Python exception to one that can be thrown on other ranks: a crumple.Error to the same Error, any other to
// Interrupted, with only its class name if its message cannot be read.
std::exception_ptr failure_of(nb::handle exception) {
    std::string words = name_of_class(exception);
    try {
        if (const std::optional<Error> error = error_of(exception)) return std::make_exception_ptr(*error);
        words += std::string(": ") + nb::str(exception).c_str();
    } catch (const nb::python_error&) {
    }
    return std::make_exception_ptr(Interrupted(words));
}

DistributedOptions distributed_options(const nb::dict& detector, nb::handle parts, nb::handle batch_bytes) {
    return {.detector = options_of(detector),
            .parts = integer<int>("parts", parts),
            .batch_bytes = integer<std::int64_t>("batch_bytes", batch_bytes)};
}

}  // namespace

BorrowedLocalMesh::BorrowedLocalMesh(const RankDetector& detector, const nb::tuple& given, nb::handle triangles,
                                     nb::handle vertices)
    : mesh(given),
      triangle_ids(triangles, "triangle", mesh.view().triangles.rows),
      vertex_ids(vertices, "vertex", mesh.view().vertices.rows) {
    if (!given.attr("edges").is_none() || !given.attr("points").is_none())
        refuse("edges and points of a mesh are not supported on ranks");
    const nb::object at_end = given.attr("end");
    if (!at_end.is_none()) end.emplace(at_end, mesh);
    const Options& own = detector.detector().options().detector;
    if (mesh.device() == BorrowedArray::on_host) return;
    if (own.backend != Backend::cuda && own.backend != Backend::automatic)
        refuse("the arrays lie in CUDA memory, which needs the cuda backend: " + std::string(copy_to_host));
    if (mesh.device() != own.device)
        refuse("the arrays lie in the memory of CUDA device " + std::to_string(mesh.device()) +
               ", but the detector of this rank works on device " + std::to_string(own.device));
}

RankDetector::RankDetector(std::uintptr_t communicator, const DistributedOptions& options)
    : detector_(without_gil([&] { return mpi::Detector(handle_of<MPI_Comm>(communicator), options); })) {
    detector_.set_poll([this] { poll(); });
}

// The library calls this during a call, without the GIL and within a collective error check. Throws the error before
// the call, if any, or an exception of a signal handler.
void RankDetector::poll() {
    if (failed_) std::rethrow_exception(failed_);
    try {
        handle_signals();
    } catch (nb::python_error& error) {
        const WithGil acquired;
        raised_.emplace(std::move(error));
        throw Interrupted(name_of_class(raised_->value()));
    }
}

void RankDetector::set_progress(nb::object show) {
    if (calling_) refuse("another call of this crumple.mpi.Detector is in progress; it takes one at a time");
    if (show.is_none())
        detector_.set_progress({});
    else
        detector_.set_progress([this](const DistributedProgress& progress) { this->show(progress); });
    show_ = std::move(show);
}

void RankDetector::show(const DistributedProgress& progress) {
    const std::string phase(phase_name(progress.phase));
    const WithGil acquired;
    PyObject* const shown = in_python(
        [&] { return PyObject_CallFunction(show_.ptr(), "sii", phase.c_str(), progress.parts_done, progress.parts); });
    if (shown) return Py_DECREF(shown);
    raised_.emplace();
    throw Interrupted(name_of_class(raised_->value()));
}

template <class Work>
auto RankDetector::run_exclusively(Work work) {
    if (calling_) refuse("another call of this crumple.mpi.Detector is in progress; it takes one at a time");
    struct Turn {
        bool& calling;
        explicit Turn(bool& flag) : calling(flag) { calling = true; }
        ~Turn() { calling = false; }
    } const turn(calling_);
    const std::stop_source stop;
    try {
        return without_gil([&] { return work(stop.get_token()); }, stop);
    } catch (...) {
        if (!raised_) throw;
        nb::python_error raised = std::move(*raised_);
        raised_.reset();
        throw raised;
    }
}

template <class Local, class Query>
typename Query::DistributedResult RankDetector::find(const Local& local, const Query& query) {
    return run_exclusively([&](std::stop_token stop) { return detector_.find(local.view(), query, std::move(stop)); });
}

template <class Local, class Query>
bool RankDetector::any(const Local& local, const Query& query) {
    return run_exclusively([&](std::stop_token stop) { return detector_.any(local.view(), query, std::move(stop)); });
}

void RankDetector::fail(nb::handle exception) {
    const std::exception_ptr failed = failure_of(exception);
    try {
        run_exclusively([&](std::stop_token stop) {
            failed_ = failed;
            struct Forget {
                std::exception_ptr& failed;
                ~Forget() { failed = nullptr; }
            } const forget{failed_};
            return detector_.any(LocalMesh(), {}, std::move(stop));
        });
    } catch (const Interrupted&) {
        return;
    }
}

void RankDetector::close() {
    run_exclusively([&](const std::stop_token&) {
        detector_.close();
        return true;
    });
}

namespace {

// Constructs a Query from one of crumple/_queries.py. Errors in the query are thrown here, before ranks wait for each
// other. `excluded`: excluded pairs of bodies, (n, 2) int32 or None.
template <class Query>
void make_query(Query* place, nb::handle given, nb::handle excluded) {
    Query query = read<Query>(given);
    if constexpr (std::is_same_v<Query, ProximityQuery>)
        if (!given.attr("radii").is_none() || !given.attr("rest").is_none())
            refuse("radii and rest are not supported on ranks");
    if (!excluded.is_none()) {
        nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu> pairs;
        if (!nb::try_cast(excluded, pairs)) throw std::logic_error("crumple/mpi.py gave no pairs of bodies");
        for (std::size_t i = 0; i < pairs.shape(0); ++i)
            query.filter.excluded_bodies.push_back({pairs(i, 0), pairs(i, 1)});
    }
    new (place) Query(std::move(query));
}

// Binds a query type, and the methods `find` and `any` for this query on local meshes and on local worlds.
template <class Query>
void bind_query(nb::module_& module, nb::class_<RankDetector>& detector, const char* name) {
    nb::class_<Query>(module, name, "Query of all ranks.")
        .def("__init__", make_query<Query>, "query"_a, "excluded"_a.none());
    const auto bind_local_mesh = [&]<class Local>(const Local*) {
        using Result = RankShown<typename Query::DistributedResult>;
        const auto find = [](RankDetector& d, const Local& s, const Query& q) { return Result{d.find(s, q)}; };
        const auto any = [](RankDetector& d, const Local& s, const Query& q) { return d.any(s, q); };
        detector.def("find", find, "local"_a, "query"_a).def("any", any, "local"_a, "query"_a);
    };
    bind_local_mesh(static_cast<const BorrowedLocalMesh*>(nullptr));
    bind_local_mesh(static_cast<const BorrowedLocalWorld*>(nullptr));
}

}  // namespace

void bind_rank_detector(nb::module_& module) {
    module.def("library", mpi_library, "Returns the name and version of the MPI library.");
    module.def("handle_size", [] { return sizeof(MPI_Comm); });
    module.def("world", [] { return number_of(MPI_COMM_WORLD); });
    nb::class_<DistributedOptions>(module, "Options", "Options of distributed calls, and of this rank's detector.")
        .def(
            "__init__",
            [](DistributedOptions* self, const nb::dict& detector, nb::handle parts, nb::handle batch_bytes) {
                new (self) DistributedOptions(distributed_options(detector, parts, batch_bytes));
            },
            "detector"_a, "parts"_a.none(), "batch_bytes"_a.none());
    nb::class_<BorrowedLocalMesh>(module, "LocalMesh", "Local mesh of a rank.")
        .def(nb::init<const RankDetector&, const nb::tuple&, nb::handle, nb::handle>(), "detector"_a, "mesh"_a,
             "triangle_ids"_a.none(), "vertex_ids"_a.none());
    nb::class_<RankDetector> detector(module, "Detector",
                                      "Detector of the library on one rank; crumple.mpi.Detector has one.");
    detector.def(nb::init<std::uintptr_t, const DistributedOptions&>(), "communicator"_a, "options"_a)
        .def("fail", &RankDetector::fail, "exception"_a)
        .def("close", &RankDetector::close)
        .def("set_progress", &RankDetector::set_progress, "show"_a.none())
        .def_prop_ro("rank", [](const RankDetector& d) { return d.detector().rank(); })
        .def_prop_ro("ranks", [](const RankDetector& d) { return d.detector().ranks(); })
        .def_prop_ro("threads", [](const RankDetector& d) { return d.detector().options().detector.threads; })
        .def_prop_ro("device", [](const RankDetector& d) { return d.detector().options().detector.device; })
        .def_prop_ro("statistics",
                     [](const RankDetector& d) { return DistributedStatistics(d.detector().statistics()); });
    bind_query<IntersectionQuery>(module, detector, "IntersectionQuery");
    bind_query<ImpactQuery>(module, detector, "ImpactQuery");
    bind_query<ProximityQuery>(module, detector, "ProximityQuery");
    bind_query<OverlapQuery>(module, detector, "OverlapQuery");
}

}  // namespace crumple::python
