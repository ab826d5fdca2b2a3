#pragma once

// Where the parts lie, and whose they are: the same on all ranks, bit by bit, for ranks whose centres differ lose
// pairs.
//
// One rank gathers a sample of the triangles, the same that one machine takes, has fuzzy C-means find the centres
// ([MZ] sec. 4), and tells all. They serve for frame after frame, as long as the scene stays in a box somewhat larger
// than that which they were made in: any centres give the same answer, and good ones an even share of the work.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/function_ref.h"
#include "distributed/share.h"
#include "distributed/transport/agreement.h"
#include "distributed/transport/rounds.h"
#include "partition/feature_part.h"
#include "partition/part_centres.h"

namespace crumple::distribute {

struct Box {
    Vec3d low, high;
};

class Placement {
   public:
    /// Centres of so many parts of the scene, which lies in `box`.
    void make(Rounds& rounds, Agreement& agree, const Share& share, int parts, const Box& box, ParallelFor& workers);
    void forget() { centres_.reset(); }

    /// Whether there are centres of so many parts, which do for a scene in this box.
    bool serves(int parts, const Box& box) const;

    int parts() const { return parts_; }
    PartTree tree() const { return centres_->tree(); }
    std::vector<PartLevel> path(std::int32_t part) const { return centres_->path(part); }
    /// By which balls triangles are members: null for intersections.
    void widen(const FeaturePartQuestion* question) {
        balls_.reset();
        if (question) balls_.emplace(*question, normalise_);
    }
    PartBall ball(const PreparedScene& scene, std::int64_t t) const {
        return balls_ ? (*balls_)(scene, t) : PartBall(scene.triangle(t), normalise_);
    }
    double slack_of_way() const { return balls_ ? balls_->slack_of_way() : 1; }
    const Normaliser& normaliser() const { return normalise_; }

   private:
    int parts_ = 0;
    Box reach_;
    Normaliser normalise_;
    std::optional<PartCentres> centres_;
    std::optional<FeatureBalls> balls_;
};

/// Which rank owns each part. Integers alone decide, so all ranks come to the same.
class Owners {
   public:
    bool known() const { return !owner_.empty(); }
    void forget() { owner_.clear(); }
    int of(std::int32_t part) const { return owner_[static_cast<std::size_t>(part)]; }
    std::span<const int> all() const { return owner_; }
    /// The parts of a rank, ascending.
    std::vector<std::int32_t> parts_of(int rank) const;

    /// Gives out parts by the work that each is, heaviest first, each to the first of the ranks that are near to it
    /// that has room for it; if none has, to the rank that has least.
    using Near = FunctionRef<std::span<const int>(std::size_t part)>;
    void give_out(std::span<const std::int64_t> work, int ranks, Near near);
    /// What the heaviest rank has to do, over what each has in the mean.
    double balance(std::span<const std::int64_t> work, int ranks) const;

   private:
    std::vector<int> owner_;
};

}  // namespace crumple::distribute
