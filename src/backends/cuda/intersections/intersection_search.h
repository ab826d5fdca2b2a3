#pragma once

// One scene searched: planned, passed over, and passed over again where a list was too short.
//
// A plan gives each list a capacity. After a pass the host reads the counters; if a list was too short, it grows and
// the pass is run again (layout.h). Where that does not fit the memory limit or the device, clusters are done one after
// another, in slices, and each twice: pairs are counted, then written to their places ([MZ] sec. 3.1;
// search_in_chunks.cu).

#include <limits>
#include <optional>
#include <span>

#include "backends/cuda/device/captures.h"
#include "backends/cuda/device/flights.h"
#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/input/device_input.h"
#include "backends/cuda/intersections/intersection_pass.h"
#include "backends/cuda/intersections/result_on_device.h"

namespace crumple::cuda {

/// What a launch has for itself, since another one may be in flight.
struct Slot {
    Slot(const Device& device, const Geometry& geometry, cudaStream_t stream, MemoryMeter& meter);
    void release();

    Input input;
    IntersectionQuery query;  ///< without its filter, which the input has
    Plan plan;                ///< of its pass
    Pinned<Counters> counters;
    Answer answer;
    bool lost = true;  ///< there is no pass, or its answer had to go
};

class Search {
   public:
    Search(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
           MemoryMeter& meter, Cancellation& cancellation, Flights& flights);

    /// Of the slot that is worked on.
    Input& input() { return slot().input; }
    /// Of each slot, for searches of other questions: a slot is of one launch at a time.
    std::array<Input*, Flights::slots> inputs() { return {&slots_[0].input, &slots_[1].input}; }
    /// Works on a slot, whose last answer goes, and has its input view the meshes.
    void view(std::size_t slot, const MeshView& a, const MeshView* b, bool weld, Room room = Room::grows);
    /// The same for bodies under poses; `pairs`: see Input::pose.
    void pose(std::size_t slot, const std::shared_ptr<const PosedWorlds>& worlds, const DevicePoses& poses, bool weld,
              bool pairs, Room room = Room::grows);
    /// Has its input bring a scene.
    void bring(const PreparedScene& scene);
    std::size_t current() const { return now_; }
    /// Works on a slot again, as adopt() has left it.
    void resume(std::size_t slot);
    /// Whether two slots were more than memory holds: one is then used as long as one will do.
    bool alone() const { return alone_; }

    /// What is asked of the input, whichever way it came.
    void adopt(const IntersectionQuery& query, Room room = Room::grows);

    /// Leaves the answer on the device. Worlds side by side are not searched in chunks: where they do not fit, this and
    /// what follows throw MemoryMeter::Exceeded.
    void find();
    /// Whether there is a pair: the work ends at the first one, and none is written.
    bool any();
    /// Sets the flags of those worlds of several in which there is a pair; the work of each ends at the first one.
    void flag_worlds(std::span<std::uint8_t> flags);
    /// Gives a whole pass to `stream`; false if there is no room for it, so that find() has to do the work.
    bool launch(cudaStream_t stream);
    /// After it is done: whether that pass has left the whole answer.
    bool accept_launched();

    /// Puts a whole pass into the capture of `stream`: each replay is a pass. Its memory stays where it is until the
    /// next adopt(). Throws NoRoom unless two calls before were of the same kind: the first makes the lists, the second
    /// loads the kernels of a pass that has a guide.
    void capture(cudaStream_t stream);
    /// Whether a replay was done since the capture, or since this was last asked.
    bool has_replayed();
    /// After that: whether the last replay has left the whole answer. If not, adopt() will make its lists longer.
    bool accept_replay();

    /// The contacts, if they are wanted; on the device, or with all of the answer copied to the host.
    void make_contacts();
    void copy_to(Intersections& result);
    /// What make_contacts() and find() have left.
    DeviceIntersections show() const;
    DeviceIntersections show_worlds() const;
    /// After a replay that has not left the whole answer.
    DeviceIntersections show_incomplete() const;
    DeviceIntersections show_incomplete_worlds() const;
    void download(Intersections& result) { answer().copy_to(scene(), query().contacts(), result); }

    const PreparedScene& scene() const { return pass_.scene; }
    const IntersectionQuery& query() const { return slot().query; }
    const Statistics& statistics() const { return statistics_; }
    void forget_statistics() { statistics_ = {}; }

    /// Gives back the memory of lists and answer.
    void drop_lists();
    /// The same, and all else that is kept between calls.
    void release();

   private:
    // Everything that the commands of a guided pass were made of. While it stays the same, they are the same.
    struct Key {
        PreparedScene scene;
        WantedPairs wanted;
        NarrowPolicy policy;
        Plan plan;
        Input::Work input;
        const void *work, *result, *guides, *counters;
        friend bool operator==(const Key&, const Key&) = default;
        /// The same without places and lengths of lists. Which kernels there are follows from it.
        Key shape() const;
    };
    struct SceneKind {
        std::int64_t triangles = -1;
        bool between = false;
        int worlds = 1;
        friend bool operator==(const SceneKind&, const SceneKind&) = default;
    };
    /// What sizes and places of all arrays follow from.
    struct Layout {
        std::array<std::int64_t, 2> vertices, triangles;
        bool float32;
        Plan plan;
        friend bool operator==(const Layout&, const Layout&) = default;
    };

    enum class Lists : std::uint8_t { shortest, roomy };  ///< of chunks

    void plan();
    Slot& slot() { return slots_[now_]; }
    const Slot& slot() const { return slots_[now_]; }
    Answer& answer() { return slot().answer; }
    const Answer& answer() const { return slot().answer; }
    void look();
    bool free_others();
    Layout layout() const;
    void lay_out_lists();
    void prepare_pass();
    void find_at_once();
    void enqueue(StageEvents* watch);
    void enqueue_until_sorted(Clearing& clearing, StageEvents* watch);
    bool any_at_once();
    bool any_in_chunks(Lists lists);
    bool accept(const Counters& counters);
    void count(const Counters& counters, const Plan& plan);
    Counters read_counters();
    std::size_t decide_beyond(std::size_t n);

    void refuse_worlds();
    Statistics shown_statistics() const;

    // world_flags.cu
    void flag_worlds_at_once(std::span<std::uint8_t> flags);
    void flag_beyond(std::size_t n, std::span<std::uint8_t> flags);

    // search_in_chunks.cu
    template <class Work>
    void in_chunks(Work work);
    void find_in_chunks(Lists lists);
    unsigned long long count_in_chunks(Lists lists);
    void plan_chunks(Lists lists);
    void lay_out_chunks();
    std::size_t pass_over_chunks(Hits hits);
    void pass_over_slices(Hits hits, std::size_t& counted);
    void require_room(std::size_t pairs) const;

    template <class Work>
    void bring_with_room(Work work);
    template <class Work>
    bool fits_at_once(Work work);
    template <class Make, class Undo>
    void with_room_for(Make make, Undo undo);
    template <class T>
    void copy(T* to, const T* from, std::size_t n, cudaMemcpyKind kind) {
        copy_now(stream_, to, from, n, kind);
    }

    const Options& options_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    const Geometry& geometry_;
    cudaStream_t stream_;
    Flights& flights_;
    StageEvents watch_;
    Branch beside_;
    GraphCache<Key> graphs_;
    CallersCapture capture_;
    Block guides_, work_;
    std::array<Slot, Flights::slots> slots_;
    IntersectionPass pass_;
    Statistics statistics_;
    std::optional<Layout> laid_out_;  ///< what the lists are laid out for
    SceneKind planned_for_;           ///< what the plan was made for
    static constexpr std::size_t nobody = Flights::slots;
    std::size_t now_ = 0;            ///< slot that is worked on
    std::size_t lists_of_ = nobody;  ///< slot whose pass the lists are of
    bool alone_ = false;
    bool captured_ = false;      ///< a caller's graph works on the lists, which must not move
    std::optional<Plan> grown_;  ///< what its last incomplete replay asks for
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit at once
};

}  // namespace crumple::cuda
