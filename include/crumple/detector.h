#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "crumple/candidates.h"
#include "crumple/collisions.h"
#include "crumple/device_features.h"
#include "crumple/export.h"
#include "crumple/function_ref.h"
#include "crumple/mesh.h"
#include "crumple/motion.h"
#include "crumple/near.h"
#include "crumple/nearest.h"
#include "crumple/options.h"
#include "crumple/part.h"
#include "crumple/world.h"

namespace crumple {

/// Finds all pairs of triangles that intersect, exactly. Keeps buffers and cluster centres between calls, so a detector
/// that is fed the frames of a simulation is faster than a new one for each; the topology may change freely.
///
/// A detector is used by one thread at a time; different detectors work at the same time. Results are
/// references to the detector's one result, valid until its next call, move or destruction. Every call throws
/// crumple::Error on bad input and leaves the detector usable.
///
/// A call that is given a std::stop_token ends soon after a stop is requested, from any thread: it throws Error
/// (cancelled) within some milliseconds, or returns its answer if that was all but there. A request that was made
/// before the call ends it at once.
class CRUMPLE_API Detector {
   public:
    /// Lets `has_collision(mesh, {})` mean the default Query, not a mesh, and `find_candidates(mesh, {})` the default
    /// CandidateQuestion, not vertices at the end.
    enum class DefaultQuery {};

    explicit Detector(const Options& options = {});
    ~Detector();
    Detector(Detector&&) noexcept;
    Detector& operator=(Detector&&) noexcept;

    /// All colliding pairs within one soup.
    const Collisions& find_self(const MeshView& mesh, const Query& query = {}, std::stop_token stop = {});

    /// All colliding pairs of a triangle of `a` with a triangle of `b`. Equal indices share nothing here; with
    /// Query::weld equal positions do. If one is float64, both are computed in float64.
    const Collisions& find_between(const MeshView& a, const MeshView& b, const Query& query = {},
                                   std::stop_token stop = {});

    /// All pairs of find_self or find_between, handed over in blocks: `take(block)` is called with one block after
    /// another, which is gone when it returns. A block has pairs, and contacts if they are asked for; offsets and hit
    /// flags are empty. Memory is that of find() without pairs, and of about three blocks; under a memory limit on one
    /// thread. Cost: see Streaming::ordered. `take` must not call this detector; what it throws ends the call, as a
    /// stop does, and then some blocks have been handed over. Not with the cuda backend.
    using TakeBlock = FunctionRef<void(const Collisions& block)>;
    Statistics stream_self(const MeshView& mesh, TakeBlock take, const Query& query = {}, const Streaming& how = {},
                           std::stop_token stop = {});
    Statistics stream_between(const MeshView& a, const MeshView& b, TakeBlock take, const Query& query = {},
                              const Streaming& how = {}, std::stop_token stop = {});

    /// Whether anything collides. It stops at the first pair found; the cuda backend at those found at the same time.
    bool has_collision(const MeshView& mesh, const Query& query = {}, std::stop_token stop = {});
    bool has_collision(const MeshView& a, const MeshView& b, const Query& query = {}, std::stop_token stop = {});
    bool has_collision(const MeshView& mesh, DefaultQuery, std::stop_token stop = {});

    /// All pairs of triangles of different bodies, and within bodies, that intersect; or less, as Intersect::wants
    /// says. One body in place gives the pairs of find_self, two that are wanted `between` those of find_between.
    /// Bodies whose shapes are named cost next to nothing while they are clear of others; flags for such bodies end at
    /// the first hit. Errors name body or shape. The cuda backend searches copies on its device, many worlds at once;
    /// where poses lie there (World::device_poses), only they are new in a call, and what the bodies are stays there.
    const WorldCollisions& find(const World& world, const Intersect& question = {}, std::stop_token stop = {});

    /// The same in blocks, as stream_self: of pairs, their bodies, and contacts. `count` and `world_counts` of a block
    /// say how many there were so far. Wants must be pairs or contacts; no index is made.
    using TakeWorldBlock = FunctionRef<void(const WorldCollisions& block)>;
    Statistics stream(const World& world, TakeWorldBlock take, const Intersect& question = {},
                      const Streaming& how = {}, std::stop_token stop = {});

    /// What touches what on the way from the start of a step to its end, and when: all impacts of vertices with faces
    /// and of edges with edges, exactly (docs/motion.md). Arrays of a world lie in host memory.
    const Impacts& find_impacts(const World& world, const Motion& question = {}, std::stop_token stop = {});
    /// The same for one mesh, whose vertices are at `end` at the end. All arrays, also those of the question, lie where
    /// the mesh does. In device memory its triangles, and listed edges and points, are copied to the host once, and
    /// again where they are others than in the call before; all arrays are in each call that welds, asks for triangle
    /// pairs, or has rules about groups beside lists of edges or points.
    const Impacts& find_impacts(const MeshView& mesh, const VertexView& end, const Motion& question = {},
                                std::stop_token stop = {});
    /// The first impact, if there is one; Motion::wants does not matter.
    FirstImpact time_of_first_impact(const MeshView& mesh, const VertexView& end, const Motion& question = {},
                                     std::stop_token stop = {});
    /// Whether nothing touches from the start to the end, both included; Motion::wants does not matter.
    bool is_free(const MeshView& mesh, const VertexView& end, const Motion& question = {}, std::stop_token stop = {});

    /// A share of the step with positions for which is_free() holds, as they are rounded: start + toi (end - start),
    /// computed in floating point, is another motion than the one whose toi that is. The share is somewhat less than
    /// the first time of contact, by 2^-16 of it if that does and by more if rounding needs it; 0, and the start, where
    /// contact is there, or too near for any share above 2^-40. With Motion::separation features keep that distance.
    /// Cost: two or three questions. A mesh in device memory is copied to the host, where the positions are.
    FreeStep find_free_step(const MeshView& mesh, const VertexView& end, const Motion& question = {},
                            std::stop_token stop = {});

    /// What is near what: all pairs of vertices and faces, and of edges and edges, within a distance, exactly
    /// (docs/nearness.md). Arrays of a world lie in host memory.
    const Nearby& find_near(const World& world, const Near& question, std::stop_token stop = {});
    /// The same for one mesh. As find_impacts in device memory, where Near::closest and Near::least take a copy, too.
    const Nearby& find_near(const MeshView& mesh, const Near& question, std::stop_token stop = {});

    /// Which features have boxes that overlap, on the way from the start of a step to its end where the world has ends,
    /// else at rest (docs/candidates.md): the lists that a narrow phase of one's own goes through. Cost: some 25 to 35
    /// ns a candidate on one thread, where there are millions.
    const CandidateLists& find_candidates(const World& world, const CandidateQuestion& question = {},
                                          std::stop_token stop = {});
    /// The same for one mesh at rest. As find_impacts in device memory.
    const CandidateLists& find_candidates(const MeshView& mesh, const CandidateQuestion& question = {},
                                          std::stop_token stop = {});
    const CandidateLists& find_candidates(const MeshView& mesh, DefaultQuery, std::stop_token stop = {});
    /// And for one whose vertices are at `end` at the end.
    const CandidateLists& find_candidates(const MeshView& mesh, const VertexView& end,
                                          const CandidateQuestion& question = {}, std::stop_token stop = {});

    /// The answers of find_impacts, find_near and find_candidates in blocks, for those that exceed memory:
    /// `take(block)` is called with one after another, which is gone when it returns. A block has at most
    /// Streaming::block_pairs rows, of all its lists together; `count`: the rows handed over so far, with its own; and
    /// edges and points as the whole answer has them. Nothing else: no hits of worlds, no first impact. In order, the
    /// lists of all blocks, one behind the other, are those of the whole answer: world by world, and in each kind by
    /// kind. Not in order: as found, from any thread of the detector, one at a time. Memory is that of find without its
    /// lists, and of about three blocks; under a memory limit on one thread. Cost: see Streaming::ordered; of worlds,
    /// where there are several, the scene of each is made twice. `take` must not call this detector; what it throws
    /// ends the call, as a stop does, and then some blocks have been handed over. Throws Error (invalid_argument) for
    /// what blocks have not: `index`, `Motion::triangle_pairs`, `Near::least`, and wants other than lists. Not with the
    /// cuda backend.
    using TakeImpacts = FunctionRef<void(const Impacts& block)>;
    Statistics stream_impacts(const World& world, TakeImpacts take, const Motion& question = {},
                              const Streaming& how = {}, std::stop_token stop = {});
    Statistics stream_impacts(const MeshView& mesh, const VertexView& end, TakeImpacts take,
                              const Motion& question = {}, const Streaming& how = {}, std::stop_token stop = {});
    using TakeNearby = FunctionRef<void(const Nearby& block)>;
    Statistics stream_near(const World& world, TakeNearby take, const Near& question, const Streaming& how = {},
                           std::stop_token stop = {});
    Statistics stream_near(const MeshView& mesh, TakeNearby take, const Near& question, const Streaming& how = {},
                           std::stop_token stop = {});
    using TakeCandidates = FunctionRef<void(const CandidateLists& block)>;
    Statistics stream_candidates(const World& world, TakeCandidates take, const CandidateQuestion& question = {},
                                 const Streaming& how = {}, std::stop_token stop = {});
    Statistics stream_candidates(const MeshView& mesh, TakeCandidates take, const CandidateQuestion& question = {},
                                 const Streaming& how = {}, std::stop_token stop = {});
    Statistics stream_candidates(const MeshView& mesh, const VertexView& end, TakeCandidates take,
                                 const CandidateQuestion& question = {}, const Streaming& how = {},
                                 std::stop_token stop = {});

    /// How far apart bodies are: of each pair of them the distance, exactly, the triangles and the points where they
    /// are closest (docs/nearest.md). Fast where shapes are named; a shape without a name gets its tree for the call.
    /// Errors name body or shape. Not with the cuda backend.
    const NearestBodies& find_nearest(const World& world, const Nearest& question = {}, std::stop_token stop = {});

    /// The same by the question's type, which has to be named: `find(world, {.weld = true})` is about intersections.
    template <std::same_as<Motion> Question>
    const Impacts& find(const World& world, const Question& question, const std::stop_token& stop = {}) {
        return find_impacts(world, question, stop);
    }
    template <std::same_as<Near> Question>
    const Nearby& find(const World& world, const Question& question, const std::stop_token& stop = {}) {
        return find_near(world, question, stop);
    }
    template <std::same_as<CandidateQuestion> Question>
    const CandidateLists& find(const World& world, const Question& question, const std::stop_token& stop = {}) {
        return find_candidates(world, question, stop);
    }
    template <std::same_as<Nearest> Question>
    const NearestBodies& find(const World& world, const Question& question, const std::stop_token& stop = {}) {
        return find_nearest(world, question, stop);
    }

    /// Cuts a scene into `count` (1 to 262,144) parts. Depends only on the arguments, so that several machines that are
    /// given the same meshes make the same parts. Meshes of a device are copied to the host first. O(triangles times 64
    /// a level) and the copies; on all threads of the cpu backend. The memory limit counts neither parts nor what it
    /// takes to make them. What is done after the meshes were read is not cut short by a stop.
    std::vector<Part> partition(const MeshView& mesh, int count, std::stop_token stop = {});
    std::vector<Part> partition(const MeshView& a, const MeshView& b, int count, std::stop_token stop = {});

    /// The pairs that `part` owns, without a look at the meshes: it costs what a mesh of the part's size does. Pairs
    /// have the ids of the meshes, in their order; contacts are those of the whole answer. Offsets and hit flags count
    /// by position in the part's lists: offsets[i] belongs to triangle part.mesh.ids[i]. Of a part that did not come
    /// from partition(), shapes and members are checked, and an Error's vertex or triangle is a position in the part.
    const Collisions& find(const Part& part, const Query& query = {}, std::stop_token stop = {});

    /// Parts of a scene that is asked what touches what in a step, or what is near what: as many as above, for
    /// questions that ask for no more distance than this one. What a part knows of vertices and edges (Part::features)
    /// makes it about twice as large. Motion::triangle_pairs are not made by parts.
    std::vector<Part> partition(const MeshView& mesh, const VertexView& end, const Motion& question, int count,
                                std::stop_token stop = {});
    std::vector<Part> partition(const MeshView& mesh, const Near& question, int count, std::stop_token stop = {});

    /// The impacts, and the near pairs, that such a part owns: the rows of the whole answer with the ids of the mesh,
    /// in its order; each in one part. `first` and `any` are those of the part. Impacts::edges and points are empty: a
    /// part knows its own (PartFeatures). Offsets and least distances count by position in the part's lists.
    /// Near::radii and Near::rest are those that the part was made with. Not with the cuda backend.
    const Impacts& find_impacts(const Part& part, const Motion& question = {}, std::stop_token stop = {});
    const Nearby& find_near(const Part& part, const Near& question, std::stop_token stop = {});

    /// Hands over the result of the last find, as a value: it outlives the detector and its next call, and the memory
    /// limit no longer counts it. The detector's own result is empty afterwards. `other` gives its storage for the next
    /// result; what it held is dropped, and under a memory limit its storage as well. Swaps pointers, copies nothing.
    void swap_result(Collisions& other);
    /// Returns the result by value; pass an old one to reuse its storage.
    Collisions take_result(Collisions spare = {}) {
        swap_result(spare);
        return spare;
    }
    /// The same for the result of the last find of a world.
    void swap_result(WorldCollisions& other);
    /// The same for the last answer about motion, nearness, candidates, or nearest bodies.
    void swap_result(Impacts& other);
    void swap_result(Nearby& other);
    void swap_result(CandidateLists& other);
    void swap_result(NearestBodies& other);

    /// Has `poll` called about every 20 ms while a call runs, in the thread that made the call; shorter calls do not
    /// poll. What it throws ends the call and leaves it, as an Error does; it must not call this detector. For
    /// languages whose signals must be looked at in the calling thread. Empty: none.
    void set_poll(std::function<void()> poll);

    /// Starts a query on meshes in device memory and returns at once: on the stream of `mesh` (of `a`), which the
    /// arrays have to be ready on. Only with the cuda backend. Consecutive frames of one shape run as one CUDA graph
    /// each, and the host reads one struct of counters after it. The arrays must stay as they are until the wait() for
    /// it returns.
    ///
    /// Two launches may be in flight before a wait(), on one stream or two; each wait() is for the oldest. A third
    /// throws Error (invalid_argument), and leaves them. Passes share their lists, so that they run one after the
    /// other. Any call but launches, wait() and download() forgets what is in flight, after it has waited for it.
    ///
    /// On a stream that is being captured, the query becomes part of the caller's graph, and each replay of that is a
    /// query, of what the arrays then hold. Two calls before it, outside of the capture, with meshes of the same shape
    /// and the same query, make the lists; without them it throws Error (invalid_argument), and the capture goes on.
    /// Lists cannot grow in a replay: wait() then says that the answer is not complete. The graph may be replayed until
    /// the next call of any member but wait() and download(), which may move or free what it works on; and no call may
    /// be made while a replay runs. One launch to a capture and detector; both streams of launch_between take part.
    void launch_self(const MeshView& mesh, const Query& query = {});
    void launch_between(const MeshView& a, const MeshView& b, const Query& query = {});

    /// Waits for the launched query and tells where its answer lies on the device. Reports bad input, makes room and
    /// runs again where a list was too short, and does what only the host can: the answer is complete. Valid until the
    /// second launch after the one that it answers, or the next call of any member but launches, wait() and download().
    /// (Where memory, or Options::memory_limit, does not hold two answers: until the next launch or wait().) Bad input
    /// of one launch leaves another in flight.
    ///
    /// After a launch in a capture: tells of the last replay, whose stream the caller has waited for; valid until the
    /// next replay. It does not run again what did not fit (DeviceCollisions::complete): a call outside of a capture
    /// makes longer lists, for a new one. After bad input the graph may go on. Throws Error (invalid_argument) if there
    /// was no replay since the capture, or since the last wait().
    const DeviceCollisions& wait(std::stop_token stop = {});

    /// Copies the answer of the last wait() to the host; an error once another call has come after that. Valid as any
    /// result.
    const Collisions& download();

    /// The same for questions about the features of a mesh in device memory, with a wait for each: answers stay on the
    /// device. Launches of all kinds share the two that may be in flight, and each wait is for the oldest, which has to
    /// be of its kind. All arrays, also those of the question, lie on the device and are ready on the mesh's stream,
    /// and stay as they are until the wait returns. The first launch for a mesh, and one whose mesh has other numbers
    /// of vertices, triangles, listed edges or points than the one before, waits for the stream: the host has to see
    /// which edges there are. So does a wait where triangles or lists turn out to be others. In a capture, where they
    /// stay what they were, wait_impacts() and its like say that the answer is not complete. Throws Error
    /// (invalid_argument) for what find_impacts and its like copy the mesh to the host for. `index` does not matter.
    void launch_impacts(const MeshView& mesh, const VertexView& end, const Motion& question = {});
    void launch_near(const MeshView& mesh, const Near& question);
    void launch_candidates(const MeshView& mesh, const CandidateQuestion& question = {});
    void launch_candidates(const MeshView& mesh, const VertexView& end, const CandidateQuestion& question = {});
    const DeviceImpacts& wait_impacts(std::stop_token stop = {});
    const DeviceNearby& wait_near(std::stop_token stop = {});
    const DeviceCandidates& wait_candidates(std::stop_token stop = {});
    /// Starts a question about worlds whose poses lie in device memory (World::device_poses) and returns at once: on
    /// the stream of the poses. As launch_self, with which it shares the two launches in flight; the poses must stay as
    /// they are until the wait_worlds() for it returns, shapes and bodies until this returns. Only with the cuda
    /// backend.
    ///
    /// Bodies and shapes are read and brought to the device when they are not those of the call before (a named shape
    /// by its name and groups, another by its contents, which are compared in each call), as are the rules. Such a call
    /// takes what a first one does; other calls are one CUDA graph. A capture needs two launches before it with the
    /// same bodies and the same question, and replays read the poses that then lie there.
    ///
    /// All worlds are one scene: without those that have fewer than two triangles at most 65,535, and 2^24 triangles
    /// together where there are several, bodies that are in all worlds counted in each. Throws Error (invalid_argument)
    /// for more, which find() takes; for Wants::body_pairs and for Intersect::index. Cost: that of launch_self for the
    /// triangles of all worlds together, whatever is wanted of them; the host compares bodies, some nanoseconds each.
    void launch(const World& world, const Intersect& question = {});

    /// Waits for the oldest launch, one of worlds, and tells where its answer lies on the device; all as wait() has it,
    /// but for download(). Bad input names its body. Where memory does not hold all worlds at once: Error (memory_limit
    /// or device).
    const DeviceWorldCollisions& wait_worlds(std::stop_token stop = {});

    const Options& options() const;

    /// The backend that works: what Options::backend asks for, or what Backend::automatic has chosen.
    Backend backend() const;

    /// Why Backend::automatic took the cpu backend although this build has the cuda backend, in one line; else empty.
    /// Valid while the detector lives.
    std::string_view fallback() const;

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace crumple
