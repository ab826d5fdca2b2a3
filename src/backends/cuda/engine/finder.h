#pragma once

// The engine of all queries: plans and runs passes over one scene. A pass runs all stages once; finder.cu has their
// order.
//
// A slot holds what one launch leaves for its wait (Slot). A plan gives each list a capacity. After a pass the host
// reads the counters; if a list was too short, it grows and the pass is run again (stages/layout.h). If the lists do
// not fit the memory limit or the device, the scene is searched in chunks: cluster by cluster, and each cluster in as
// many slices of its sweep as the lists require (finder_chunks.cu).
//
// Scenes lie on the host, or on the device as meshes or bodies. For scenes on the device a pass can be launched, or put
// into a caller's capture; its slot then holds the data that wait() reads (device/launch_queue.h).

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "backends/cuda/device/captures.h"
#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/device/launch_queue.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/engine/backend_state.h"
#include "backends/cuda/engine/graph_key.h"
#include "backends/cuda/stages/pass.h"
#include "crumple/function_ref.h"

namespace crumple::cuda {

/// State of one launch; another one, in the other slot, may be in flight.
struct Slot {
    Slot(const Device& device, MemoryMeter& meter) : counters(device), rows(meter) {}

    Pinned<Counters> counters;
    Block rows;                  ///< device memory of the rows of the result
    Plan plan;                   ///< clusters and list capacities with which the launch's pass was enqueued
    std::uint64_t revision = 0;  ///< SceneFeatures::revision() of the request's features; 0: no feature query
    bool low_memory = false;     ///< uses as little memory as possible, so searches in chunks
    bool on_host = false;        ///< the rows lie on the host: they were found in chunks
    bool lost = true;            ///< no result: none was found yet, memory did not suffice, or its rows were evicted
};

/// Base of the searches for each kind of query. A derived class binds its input, and overrides the stages' work that is
/// specific to the query.
class Finder {
   public:
    Finder(const Finder&) = delete;
    virtual ~Finder() = default;

    std::size_t current() const { return now_; }
    /// True if memory could not hold the rows of two slots. Then a launch uses the newest slot again, unless another
    /// launch is in flight.
    bool alone() const { return alone_; }
    /// Makes a slot current again, in the state it was left in.
    void resume(std::size_t slot);

    /// Finds the result and leaves its rows in the slot. Throws MeshChanged if the caller's mesh on the device differs
    /// from the cached one (input/cached_mesh.h); so does accept_launched(). Scenes of several worlds, or of bodies
    /// whose poses lie on the device, are not searched in chunks: if they do not fit, throws MemoryMeter::Exceeded.
    void find();
    /// Enqueues a whole pass on `stream`. If memory does not suffice, marks the slot as lost instead.
    void launch(cudaStream_t stream);
    /// To be called when the launched pass has completed. Returns true if it has left the whole result, and was
    /// launched for features with this SceneFeatures::revision() (0: for no feature query).
    bool accept_launched(std::uint64_t revision = 0);

    /// Puts a whole pass into the capture of `stream`: each replay is a pass. Its memory does not move until
    /// claim_slot() is called. Throws CapacityError unless two calls of the same kind precede it: the first places the
    /// lists, the second loads the kernels of a warm-started pass.
    void capture(cudaStream_t stream);
    /// Returns true if a replay has completed since the capture, or since the last call of this function.
    bool has_replayed();
    /// To be called after has_replayed(): returns true if the last replay has left the whole result. If not, the next
    /// pass has longer lists.
    bool accept_replay();

    const PreparedScene& scene() const { return stages_.scene; }
    const Statistics& statistics() const { return statistics_; }

    /// Frees the memory of lists and rows.
    void drop_lists();
    /// Frees these and everything else that is cached between calls.
    virtual void release();

   protected:
    Finder(BackendState& state, Pass& stages);

    // ---- Operations that depend on the kind of query, in the order of their use. Boxes, records and filters are in
    // its Pass.

    /// Binds the pass to the slot's scene and query. Overriders call this first.
    virtual void bind();
    virtual KernelParameters parameters() const = 0;
    /// True unless SceneFeatures::plain(): the caller has lists of edges or points (codimensional features), and not
    /// all of these are simply the triangles'. Then lists for tests of all FeatureKinds are needed.
    virtual bool all_kinds() const { return false; }
    /// True if the query requests only a flag, which is set if there is any hit. Hits are then counted, not listed.
    virtual bool is_any_output() const { return false; }

    /// Choose the number of clusters and the capacities of lists: choose_plan() for a scene of another SceneKind than
    /// the previous one, choose_chunks() for a search in chunks whose lists take about `bytes`, or the least that
    /// works.
    virtual void choose_plan(Plan& plan) const = 0;
    virtual void choose_chunks(Plan& plan, std::int64_t bytes) const = 0;
    /// Takes the arrays of the result from `cutter`, with capacity for Plan::hits rows if the query requests rows.
    virtual void cut_rows(ArenaLayout& cutter) = 0;
    virtual void clear_rows(BatchedClear& batch) const = 0;
    /// Enqueues what the query needs after the work of the input (Input::enqueue) and before stage `bounds`.
    virtual void make_ready() {}
    virtual void narrow() = 0;
    /// Enqueues stage `output`. Returns true if one of its kernels copies the counters to `host_counters`, which is
    /// pinned memory or null.
    virtual bool write_rows(Counters* host_counters) = 0;
    /// Adds the numbers of tests that the filters and the exact decision have made to the statistics.
    virtual void count_tests(const Counters& counters, Statistics& statistics) const = 0;

    /// Decides on the host the given number of tests, which the device could not decide. Returns the number of hits
    /// among them.
    virtual std::size_t decide_unresolved(std::size_t) { return 0; }
    /// Appends to the list of hits those that decide_unresolved() has found, and ranks all hits anew (Hit::rank).
    /// Arguments: number of hits to append, and number of hits in the list before.
    virtual void append_decided(std::size_t, unsigned long long) {}
    /// Reads what the host needs of a complete result with `total` hits.
    virtual void read_rows(unsigned long long total) = 0;
    /// Finds the rows cluster by cluster (over_chunks).
    virtual void find_in_chunks() = 0;
    /// Frees the rows of a slot.
    virtual void release_rows(std::size_t slot) { slots_[slot].rows.release(); }

    // ---- Tools for derived finders.

    Slot& slot() { return slots_[now_]; }
    const Slot& slot() const { return slots_[now_]; }
    Input& input() { return state_.inputs[now_]; }
    const Input& input() const { return state_.inputs[now_]; }

    /// Makes a slot current, drops its last rows, and fills its input by the given function. The input takes priority:
    /// if memory is short, results of earlier calls are evicted and the function is called again.
    void claim_slot(std::size_t slot, FunctionRef<void()> bring);

    Counters read_counters();
    void count(const Counters& counters, const Plan& plan);

    /// Runs one pass that lists no hits, and waits for it. rounds() enqueues the stages after `sort` on stream_.
    /// Returns true if all lists were long enough; if not, the next pass has longer ones.
    bool pass_without_rows(FunctionRef<void()> rounds, Counters& counters);

    /// Runs work(), a pass over the whole scene. Returns false if memory did not suffice; from then on, until
    /// release(), does not run work() for scenes with as many triangles or more, and returns false at once.
    bool fits_at_once(FunctionRef<void()> work);
    void refuse_at_once() { too_many_ = scene().triangle_count(); }
    bool refuses_at_once() const { return scene().triangle_count() >= too_many_; }
    /// Throws MemoryMeter::Exceeded if the scene consists of worlds side by side or of posed bodies, which are not
    /// searched in chunks: the caller saves more memory by searching fewer worlds at once, and chunks cannot name pairs
    /// by bodies.
    void refuse_worlds() const;
    /// Runs work() with lists as long as memory seems to allow for a search in chunks; if they do not fit, or for
    /// Slot::low_memory, with the shortest ones.
    void in_chunks(FunctionRef<void()> work);
    /// Searches cluster by cluster, and sweeps each cluster in slices whose pairs of triangles fit their list. Calls
    /// slice() after each of these, until it returns false.
    void over_chunks(FunctionRef<bool()> slice);
    /// Frees the rows of the other slot and, unless its launch is in flight, its input, after waiting for all passes in
    /// flight. A launch that loses its rows is repeated in its wait. Returns true if any memory was freed.
    bool free_others();
    /// Calls free_others() and frees the memory of lists, but not the rows of the current slot.
    void release_lists();

    BackendState& state_;
    const Options& options_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    const Geometry& geometry_;
    cudaStream_t stream_;  ///< the backend's own stream
    std::array<Slot, LaunchQueue::slots> slots_;
    Statistics statistics_;
    bool captured_ = false;  ///< a caller's graph uses the lists, which must not move

   private:
    /// Kind of scene that a plan is made for. Queries that alternate on one kind share the plan, whose lists fit the
    /// largest result.
    struct SceneKind {
        std::int64_t triangles = -1;
        bool between = false;
        int worlds = 1;
        bool all_kinds = false;
        friend bool operator==(const SceneKind&, const SceneKind&) = default;
    };
    /// Everything that determines sizes and addresses of all lists.
    struct Layout {
        std::array<std::int64_t, 2> vertices, triangles;
        bool float32, moving;
        Plan plan;
        friend bool operator==(const Layout&, const Layout&) = default;
    };

    Layout layout() const;
    GraphKey key() const;
    void enqueue(StageEvents* watch);
    void enqueue_until_sorted(BatchedClear& batch, StageEvents* watch);
    void begin(StageEvents* watch, Stage stage);
    bool accept();
    bool add_unresolved(const Counters& counters, unsigned long long& total);
    void prepare_warm_start();
    void find_at_once();
    void plan();
    void place_lists();
    void place_rows(Growth growth);
    void prepare_pass();
    void place_chunks();
    bool over_slices(FunctionRef<bool()> slice);

    static constexpr std::size_t no_slot = LaunchQueue::slots;

    Pass& stages_;
    StageEvents watch_;
    Branch beside_;
    GraphCache<GraphKey> graphs_;
    CallersCapture capture_;
    Block warm_starts_, work_;
    SceneKind planned_for_;
    std::size_t now_ = 0;                 ///< current slot
    std::size_t lists_of_ = no_slot;      ///< slot whose pass with rows used the lists last; no_slot: not usable since
    std::optional<Layout> layout_done_;   ///< layout of the lists as they are placed now
    std::optional<Plan> plan_of_replay_;  ///< plan that the last incomplete replay requires
    bool alone_ = false;
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles of a scene that did not fit
};

}  // namespace crumple::cuda
