// Detector for MPI processes: checks the state of MPI, and chooses threads and device of each rank.

#include "crumple/mpi.h"

#ifdef __linux__
#include <sched.h>
#endif

#include <algorithm>
#include <cstring>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "crumple/device.h"
#include "distributed/mpi/mpi_transport.h"
#include "distributed/rank_detector.h"

namespace crumple::mpi {
namespace {

using distribute::check_mpi;

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::communication, what); }

/// Duplicate of a communicator, which returns errors instead of aborting.
class Communicator {
   public:
    explicit Communicator(MPI_Comm of) {
        int initialised = 0, finalised = 0;
        check_mpi(MPI_Initialized(&initialised), "MPI_Initialized");
        check_mpi(MPI_Finalized(&finalised), "MPI_Finalized");
        if (!initialised || finalised)
            refuse(
                "MPI is not initialised, or already finalised: make the detector between MPI_Init_thread and "
                "MPI_Finalize");
        if (of == MPI_COMM_NULL) refuse("the communicator is MPI_COMM_NULL");
        check_mpi(MPI_Comm_dup(of, &own_), "MPI_Comm_dup");
        check_mpi(MPI_Comm_set_errhandler(own_, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
    }
    MPI_Comm get() const { return own_; }
    void free() { check_mpi(MPI_Comm_free(&own_), "MPI_Comm_free"); }

   private:
    MPI_Comm own_ = MPI_COMM_NULL;
};

/// Returns the cores that this process may run on, as 1 byte per core.
std::vector<std::uint8_t> allowed_cores() {
    std::vector<std::uint8_t> allowed;
#ifdef __linux__
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) {
        allowed.resize(CPU_SETSIZE);
        for (std::size_t c = 0; c < allowed.size(); ++c) allowed[c] = CPU_ISSET(c, &set) != 0;
        return allowed;
    }
#endif
    allowed.assign(1024, 0);
    std::fill_n(allowed.begin(), std::min<std::size_t>(1024, std::max(1u, std::thread::hardware_concurrency())), 1);
    return allowed;
}

/// Resources of a rank on its machine.
struct Fair {
    int threads = 1;
    int place = 0;  ///< index of the rank among those of its machine
};

// Returns the rank's index on its machine, and its fair number of threads: each core that it may use counts as 1 /
// (number of ranks of the machine that may use this core). Collective.
Fair fair_share(MPI_Comm communicator) {
    MPI_Comm machine = MPI_COMM_NULL;
    check_mpi(MPI_Comm_split_type(communicator, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine),
              "MPI_Comm_split_type");
    Fair fair;
    const std::vector<std::uint8_t> mine = allowed_cores();
    std::vector<int> users(mine.begin(), mine.end());
    int code = MPI_Comm_rank(machine, &fair.place);
    if (code == MPI_SUCCESS)
        code = MPI_Allreduce(MPI_IN_PLACE, users.data(), static_cast<int>(users.size()), MPI_INT, MPI_SUM, machine);
    MPI_Comm_free(&machine);
    check_mpi(code, "MPI_Allreduce");
    double threads = 0;
    for (std::size_t c = 0; c < mine.size(); ++c)
        if (mine[c]) threads += 1.0 / users[c];
    fair.threads = std::clamp(static_cast<int>(threads + 1e-9), 1, 1024);
    return fair;
}

// Returns the options with the rank's threads and device chosen. Examines the machine only if some rank needs this.
// Collective.
DistributedOptions with_threads_and_device(DistributedOptions options, MPI_Comm communicator) {
    Options& own = options.detector;
    const bool chooses_threads = own.threads == 0 && !own.executor;
    const std::size_t devices =
        own.backend == Backend::cuda || own.backend == Backend::automatic ? list_devices().devices.size() : 0;
    int requests = chooses_threads || devices > 0;
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, &requests, 1, MPI_INT, MPI_MAX, communicator), "MPI_Allreduce");
    if (!requests) return options;
    const Fair fair = fair_share(communicator);
    if (chooses_threads) own.threads = fair.threads;
    // An invalid device is refused later, with all other options.
    if (devices > 0 && own.device >= 0)
        own.device =
            static_cast<int>((static_cast<std::size_t>(own.device) + static_cast<std::size_t>(fair.place)) % devices);
    return options;
}

}  // namespace

struct Detector::Implementation {
    Communicator communicator;
    distribute::MpiTransport transport;
    distribute::RankDetector detector;
    std::function<void()> poll;

    Implementation(MPI_Comm of, const DistributedOptions& options)
        : communicator(of),
          transport(communicator.get()),
          detector(transport, with_threads_and_device(options, communicator.get())) {
        // Runs within a collective error check: if the thread of one rank may not call MPI, the call ends on all ranks.
        detector.set_hook([this](Phase phase) {
            if (phase == Phase::query) check_thread();
            if (poll) poll();
        });
    }

    void check_thread() const {
        int level = MPI_THREAD_SINGLE, main = 0;
        check_mpi(MPI_Query_thread(&level), "MPI_Query_thread");
        check_mpi(MPI_Is_thread_main(&main), "MPI_Is_thread_main");
        if (level < MPI_THREAD_SERIALIZED && !main)
            refuse(
                "this thread may not call MPI: use the thread that initialised MPI, or initialise MPI with "
                "MPI_THREAD_SERIALIZED");
        if (level < MPI_THREAD_FUNNELED && detector.options().detector.threads != 1)
            refuse(
                "MPI was initialised for a single thread: call MPI_Init_thread with MPI_THREAD_FUNNELED, or give the "
                "detector one thread");
    }
};

Detector::Detector(MPI_Comm communicator, const DistributedOptions& options)
    : implementation_(std::make_unique<Implementation>(communicator, options)) {}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

Detector::Implementation& Detector::open() const {
    if (!implementation_) refuse("the detector is closed");
    return *implementation_;
}

void Detector::close() {
    if (!implementation_) return;
    const std::unique_ptr<Implementation> closing = std::move(implementation_);
    closing->communicator.free();
}

template <class Query, class RankMesh>
const typename Query::DistributedResult& Detector::find(const RankMesh& local, const Query& query,
                                                        std::stop_token stop) {
    return open().detector.find(local, query, std::move(stop));
}
template <class Query, class RankMesh>
bool Detector::any(const RankMesh& local, const Query& query, std::stop_token stop) {
    Query whether = query;
    whether.output = Output::any;
    return find(local, whether, std::move(stop)).any;
}

#define CRUMPLE_FIND(RankMesh, Query)                                                                  \
    template CRUMPLE_API const Query::DistributedResult& Detector::find(const RankMesh&, const Query&, \
                                                                        std::stop_token);              \
    template CRUMPLE_API bool Detector::any(const RankMesh&, const Query&, std::stop_token);

CRUMPLE_FIND(LocalMesh, IntersectionQuery)
CRUMPLE_FIND(LocalMesh, ImpactQuery)
CRUMPLE_FIND(LocalMesh, ProximityQuery)
CRUMPLE_FIND(LocalWorld, IntersectionQuery)
CRUMPLE_FIND(LocalWorld, ImpactQuery)
CRUMPLE_FIND(LocalWorld, ProximityQuery)
CRUMPLE_FIND(LocalMesh, OverlapQuery)
CRUMPLE_FIND(LocalWorld, OverlapQuery)

void Detector::set_poll(std::function<void()> poll) {
    open().detector.set_poll(poll);
    open().poll = std::move(poll);
}
void Detector::set_progress(std::function<void(const DistributedProgress&)> show) {
    open().detector.set_progress(std::move(show));
}
const DistributedStatistics& Detector::statistics() const { return open().detector.statistics(); }
const DistributedOptions& Detector::options() const { return open().detector.options(); }
int Detector::rank() const { return open().transport.rank(); }
int Detector::ranks() const { return open().transport.size(); }

}  // namespace crumple::mpi
