#pragma once

// The engine of all queries: one scene searched, planned, passed over, and passed over again where a list was too
// short. finder.cu has the order of the stages.
//
// A plan gives each list a capacity. After a pass the host reads the counters; if a list was too short, it grows and
// the pass is run again (stages/layout.h). Where that does not fit the memory limit or the device, clusters are done
// one after another, in slices (finder_chunks.cu).
//
// Scenes lie on the host, or on the device as meshes or bodies. Of the latter a pass can be launched, or put into a
// caller's capture, with a slot for what its wait looks at (device/flights.h).

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "backends/cuda/device/captures.h"
#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/flights.h"
#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/engine/backend_state.h"
#include "backends/cuda/engine/graph_key.h"
#include "backends/cuda/stages/pass.h"
#include "crumple/function_ref.h"

namespace crumple::cuda {

/// State of one launch, beside that of another one that may be in flight.
struct Slot {
    Slot(const Device& device, MemoryMeter& meter) : counters(device), rows(meter) {}

    Pinned<Counters> counters;
    Block rows;                  ///< of the result
    Plan plan;                   ///< of its pass
    std::uint64_t revision = 0;  ///< of the features that it was given; 0: it was given none
    bool low_memory = false;     ///< as little memory as can be is used, so that work is done in chunks
    bool on_host = false;        ///< the rows are there: they were found in chunks
    bool lost = true;            ///< there is no pass, or its rows had to go
};

/// Searches for one kind of query. A kind derives from it, brings its input, and overrides what the stages do for it.
class Finder {
   public:
    Finder(const Finder&) = delete;
    virtual ~Finder() = default;

    std::size_t current() const { return now_; }
    /// True if two slots were more than memory holds: one is then used as long as one will do.
    bool alone() const { return alone_; }
    /// Works on a slot again, as it was left.
    void resume(std::size_t slot);

    /// Leaves the rows of the result. Throws MeshChanged, and so do all that accept a pass. Worlds side by side are not
    /// searched in chunks: where they do not fit, MemoryMeter::Exceeded is thrown.
    void find();
    /// Gives a whole pass to `stream`; if there is no room for it, it is lost.
    void launch(cudaStream_t stream);
    /// After it is done: returns true if that pass has left the whole result, about features of that revision.
    bool accept_launched(std::uint64_t revision = 0);

    /// Puts a whole pass into the capture of `stream`: each replay is a pass. Its memory stays where it is until a slot
    /// is taken. Throws NoRoom unless two calls before were of the same kind: the first makes the lists, the second
    /// loads the kernels of a pass that has a guide.
    void capture(cudaStream_t stream);
    /// Returns true if a replay was done since the capture, or since this was last called.
    bool has_replayed();
    /// After that: returns true if the last replay has left the whole result. If not, the next pass has longer lists.
    bool accept_replay();

    const PreparedScene& scene() const { return stages_.scene; }
    const Statistics& statistics() const { return statistics_; }

    /// Gives back the memory of lists and rows.
    void drop_lists();
    /// The same, and all else that is kept between calls.
    virtual void release();

   protected:
    Finder(BackendState& state, Pass& stages);

    // ---- The query, as the engine sees it, in the order of use. Pass has its boxes, records and filters.

    /// Binds the pass to the slot's scene and query. Overriders call this first.
    virtual void bind();
    virtual KernelParameters parameters() const = 0;
    /// Edges and points are listed as well, which needs other lists.
    virtual bool all_kinds() const { return false; }
    /// One hit is all that is asked for, and none is listed.
    virtual bool wants_any() const { return false; }

    /// Capacities for a scene that is unlike the last one; and for work in chunks, of which lists take so many bytes.
    virtual void choose_plan(Plan& plan) const = 0;
    virtual void choose_chunks(Plan& plan, std::int64_t bytes) const = 0;
    /// The arrays of the result, for as many rows as the plan has hits.
    virtual void cut_rows(Cutter& cutter) = 0;
    virtual void clear_rows(Clearing& clearing) const = 0;
    /// Work between that of the input and `bounds`.
    virtual void make_ready() {}
    virtual void narrow() = 0;
    /// Stage `output`. Returns true if a kernel copies the counters to `host_counters`, which is pinned memory or null.
    virtual bool write_rows(Counters* host_counters) = 0;
    /// Statistics of the filters.
    virtual void count_tests(const Counters& counters, Statistics& statistics) const = 0;

    /// Decides by the host what the device could not, and returns how many hits that gave.
    virtual std::size_t decide_beyond(std::size_t) { return 0; }
    /// Appends these to the list, which has `before` hits, and ranks all anew.
    virtual void append_decided(std::size_t, unsigned long long) {}
    /// Takes what the host needs of a complete result with so many hits.
    virtual void read_rows(unsigned long long total) = 0;
    /// Leaves the rows, found cluster by cluster (over_chunks).
    virtual void find_in_chunks() = 0;
    /// Gives back the rows of an earlier launch, or of this one.
    virtual void release_rows(std::size_t slot) { slots_[slot].rows.release(); }

    // ---- Tools of the finders that derive.

    Slot& slot() { return slots_[now_]; }
    const Slot& slot() const { return slots_[now_]; }
    Input& input() { return state_.inputs[now_]; }
    const Input& input() const { return state_.inputs[now_]; }

    /// Works on a slot, whose last rows go. bring() fills its input, which takes priority: results of earlier calls are
    /// evicted if memory is short.
    void take_slot(std::size_t slot, FunctionRef<void()> bring);

    Counters read_counters();
    void count(const Counters& counters, const Plan& plan);

    /// Does one pass that lists no hits, and waits for it. rounds() gives the stages behind `sort` to our stream.
    /// Returns true if all lists were long enough; if not, the next pass has longer ones.
    bool pass_without_rows(FunctionRef<void()> rounds, Counters& counters);

    /// Returns true if there was memory for the work, a pass over the whole scene. If not, none is tried again for
    /// scenes of that size.
    bool fits_at_once(FunctionRef<void()> work);
    void refuse_at_once() { too_many_ = scene().triangle_count(); }
    bool refuses_at_once() const { return scene().triangle_count() >= too_many_; }
    /// Throws MemoryMeter::Exceeded for worlds: fewer at once need less than chunks of all of them, and chunks name no
    /// pairs by bodies.
    void refuse_worlds() const;
    /// Does work with the lists of chunks, as long as memory seems to allow; if that was too bold, with the shortest.
    void in_chunks(FunctionRef<void()> work);
    /// Cluster by cluster: calls slice() for each slice whose pairs of triangles fit their list, which ends the search
    /// by returning false.
    void over_chunks(FunctionRef<bool()> slice);
    /// Rows and passes of earlier launches go where there is no memory for this one. Those in flight are done again in
    /// their wait, by what they were given. Returns true if that gave any memory.
    bool free_others();
    /// Gives back the memory of lists, but not of rows.
    void release_lists();

    BackendState& state_;
    const Options& options_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    const Geometry& geometry_;
    cudaStream_t stream_;
    std::array<Slot, Flights::slots> slots_;
    Statistics statistics_;
    bool captured_ = false;  ///< a caller's graph works on the lists, which must not move

   private:
    /// Kind of scene that a plan is made for. Queries that take turns keep it, and lists suit the longest.
    struct SceneKind {
        std::int64_t triangles = -1;
        bool between = false;
        int worlds = 1;
        bool all_kinds = false;
        friend bool operator==(const SceneKind&, const SceneKind&) = default;
    };
    /// Everything that sizes and places of all lists follow from.
    struct Layout {
        std::array<std::int64_t, 2> vertices, triangles;
        bool float32, moving;
        Plan plan;
        friend bool operator==(const Layout&, const Layout&) = default;
    };

    Layout layout() const;
    GraphKey key() const;
    void enqueue(StageEvents* watch);
    void enqueue_until_sorted(Clearing& clearing, StageEvents* watch);
    void begin(StageEvents* watch, Stage stage);
    bool accept();
    bool add_beyond(const Counters& counters, unsigned long long& total);
    void guide_next();
    void find_at_once();
    void plan();
    void lay_out_lists();
    void lay_out_rows(Room room);
    void prepare_pass();
    void lay_out_chunks();
    bool over_slices(FunctionRef<bool()> slice);

    static constexpr std::size_t nobody = Flights::slots;

    Pass& stages_;
    StageEvents watch_;
    Branch beside_;
    GraphCache<GraphKey> graphs_;
    CallersCapture capture_;
    Block guides_, work_;
    SceneKind planned_for_;
    std::size_t now_ = 0;             ///< slot that is worked on
    std::size_t lists_of_ = nobody;   ///< slot whose pass the lists are of
    std::optional<Layout> laid_out_;  ///< what the lists are laid out for
    std::optional<Plan> grown_;       ///< what the last incomplete replay asks for
    bool alone_ = false;
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit at once
};

}  // namespace crumple::cuda
