#pragma once

// Centres and owners of the parts of a scene. A part is a cluster of triangles around a centre; its owner is the rank
// that searches it. Both are equal bit by bit on all ranks: ranks with different centres would lose pairs.
//
// One rank gathers a sample of the triangles (the same as on a single machine), finds the centres by fuzzy C-means
// ([MZ] sec. 4), and broadcasts them. Centres are reused in later frames as long as the scene stays in the box that
// they were made for, enlarged by a quarter of its extent on each side. Any centres give the same result; good ones
// balance the work.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/function_ref.h"
#include "distributed/rank_mesh.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"
#include "partition/feature_part.h"
#include "partition/part_centres.h"

namespace crumple::distribute {

struct Box {
    Vec3d low, high;
};

class PartLayout {
   public:
    /// Makes the centres of `parts` parts of the scene, which lies in `box`. Collective.
    void make(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local, int parts, const Box& box,
              ParallelFor& workers);
    void forget() { centres_.reset(); }

    /// True if there are centres of `parts` parts that can be reused for a scene in this box.
    bool serves(int parts, const Box& box) const;

    int parts() const { return parts_; }
    PartTree tree() const { return centres_->tree(); }
    std::vector<PartLevel> path(std::int32_t part) const { return centres_->path(part); }
    /// Sets the kind of balls that decide which parts a triangle belongs to: the balls for this query about features
    /// or, if null, the balls for intersections.
    void widen(const FeaturePartDemand* query) {
        feature_ball_.reset();
        if (query) feature_ball_.emplace(*query, normalise_);
    }
    PartBall ball(const PreparedScene& scene, std::int64_t t) const {
        return feature_ball_ ? (*feature_ball_)(scene, t) : PartBall(scene.triangle(t), normalise_);
    }
    double slack_of_path() const { return feature_ball_ ? feature_ball_->slack_of_path() : 1; }
    const Normaliser& normaliser() const { return normalise_; }

   private:
    int parts_ = 0;
    Box reach_;
    Normaliser normalise_;
    std::optional<PartCentres> centres_;
    std::optional<FeatureBallOfTriangle> feature_ball_;  ///< empty: balls for intersections
};

/// Owners (ranks) of the parts. Computed from integers alone, so that all ranks get the same.
class Owners {
   public:
    bool known() const { return !owner_.empty(); }
    void forget() { owner_.clear(); }
    int of(std::int32_t part) const { return owner_[static_cast<std::size_t>(part)]; }
    std::span<const int> all() const { return owner_; }
    /// Returns the parts of a rank, ascending.
    std::vector<std::int32_t> parts_of(int rank) const;

    using Near = FunctionRef<std::span<const int>(std::size_t part)>;
    /// Assigns parts to ranks, in the order of descending work. Each part goes to the first rank in near(part) that has
    /// no load yet, or whose load then is at most 5 % above the mean; if there is none, to the rank with the least
    /// load. near(part) is called once for each part, in that order, and may call of() for the parts before.
    void give_out(std::span<const std::int64_t> work, int ranks, Near near);
    /// Returns the largest work of a rank, divided by the mean over all ranks.
    double balance(std::span<const std::int64_t> work, int ranks) const;

   private:
    std::vector<int> owner_;
};

}  // namespace crumple::distribute
