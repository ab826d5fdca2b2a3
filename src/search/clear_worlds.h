#pragma once

// Decides most worlds of a query about motion or nearness by the trees of shapes (scene/shape_tree.h), so all shapes
// must have names. A world is clear if no pair of bodies that the filter selects can come near each other, at the start
// or during the whole step. For any other world, finds a pair of features that is certainly near, or lists the groups
// of elements that may come near those of another body, for an exact search.

#include <atomic>
#include <compare>
#include <span>
#include <vector>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "base/pool.h"
#include "crumple/array.h"
#include "scene/body_filter.h"
#include "scene/near_bodies.h"
#include "scene/shape_trees.h"
#include "scene/world_outline.h"
#include "search/walks/near_walk.h"

namespace crumple {

class ClearWorlds {
   public:
    ClearWorlds(MemoryMeter& meter, Cancellation& cancellation, ShapeTrees& trees)
        : meter_(meter), cancellation_(cancellation), trees_(trees), near_(&meter) {}

    /// `search`: an exact search has to decide. If any groups are marked, it may leave out all others.
    enum class Verdict { clear, hit, search };

    /// Group of elements that may be near another body: a leaf of the tree of a body's shape.
    struct Mark {
        std::int32_t body, group;
        friend auto operator<=>(const Mark&, const Mark&) = default;
    };

    /// Reads the worlds of a call. Features of two bodies are near if their distance is at most `distance`, at some
    /// time of the step if `step`, else at the start. `subsets`: true if some elements of a body can be searched
    /// without the others; if false, verdicts are clear or search, and nothing is marked. This is the same as forget()
    /// if some shape has no name, has too many elements, or has end positions, radii or a rest shape, or if a body's
    /// box exceeds the numbers of its precision.
    void read(const WorldOutline& outline, const BodyFilter& rules, bool step, double distance, bool subsets);
    /// Forgets the world: every world must then be searched as a whole.
    void forget() { is_read_ = false; }

    /// Decides the worlds with indices [begin, end), on all threads. The index after the last world stands for the
    /// pairs among bodies that are in all worlds. `any`: true if it is enough that one world is a hit; then worlds may
    /// remain undecided (Verdict::search, without marks) if another one is.
    void decide(ParallelFor& workers, std::int32_t begin, std::int32_t end, bool any);
    /// Returns the verdict about one of these worlds.
    Verdict verdict(std::int32_t pass) const { return is_read_ ? decided(pass).verdict : Verdict::search; }
    /// Returns the marked groups of a world that an exact search has to decide, sorted by body and group. If there are
    /// none, whole bodies must be searched.
    std::span<const Mark> marked(std::int32_t pass) const {
        return is_read_ ? std::span<const Mark>(decided(pass).marks) : std::span<const Mark>();
    }
    /// True if the last decide() has found a hit.
    bool any_hit() const { return is_read_ && any_hit_; }
    const ShapeTree& tree(std::int32_t body) const { return *bodies_[static_cast<std::size_t>(body)].tree; }
    /// Returns the edges of a body, as in results.
    std::span<const Edge> edges(std::int32_t body) const {
        const Shape& shape = outline_->shape(body);
        return shape.edges ? *shape.edges : trees_.edges(shape).span();
    }

    /// Frees all memory.
    void release();

   private:
    /// Verdict about a world, and its marks.
    struct Decided {
        Verdict verdict = Verdict::search;
        std::vector<Mark> marks;
    };
    /// Walk of a task, with scratch memory for one world.
    struct Walk {
        Walk(Cancellation& cancellation, MemoryMeter* meter) : near(cancellation, meter) {}
        NearWalk near;
        std::vector<Mark> marks;
    };
    const Decided& decided(std::int32_t pass) const { return decided_[static_cast<std::size_t>(pass - first_)]; }
    Bounds bounds(const NearBody& body) const;
    bool may_meet(std::int32_t a, std::int32_t b) const;
    bool selects_pairs_within(std::int32_t pass) const;
    void decide(Walk& walk, std::int32_t pass, Decided& decided) const;
    bool mark(Walk& walk, std::int32_t a, std::int32_t b) const;

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    ShapeTrees& trees_;
    const WorldOutline* outline_ = nullptr;
    const BodyFilter* rules_ = nullptr;
    bool is_read_ = false, step_ = false, subsets_ = false;
    double distance_ = 0;
    std::vector<NearBody> bodies_;
    std::int32_t first_ = 0;        ///< first world of the last decide()
    std::vector<Decided> decided_;  ///< by world, from first_ on
    std::atomic<bool> any_hit_ = false;
    Pool<Walk> walks_;
    NearBodies near_;
};

}  // namespace crumple
