#pragma once

// Items about two bodies, or about two shells of one body: their relation, and their distance.

#include <map>
#include <utility>
#include <vector>

#include "checks/check_report.h"
#include "checks/crossing_places.h"
#include "crumple/distances.h"

namespace crumple::checks {

using PartPair = std::pair<BodyPart, BodyPart>;

/// Items about pairs, by the pair.
class PairItems {
   public:
    explicit PairItems(const CheckOptions& options) : options_(options) {}

    /// Adds an item for each row about two different bodies. `parts`: by body of the query's world.
    void add(const Overlaps& found, const std::vector<BodyPart>& parts);
    /// Adds a place where two surfaces meet. A pair without a row becomes `undefined`.
    void add(const CrossingPlace& place, const PartPair& pair);
    /// Marks two bodies with the same triangles.
    void add_duplicate(const PartPair& pair);
    /// Adds the clearance of each row whose bodies are nearer than the clearance of the options.
    void add(const Distances& found);

    /// Returns the items, sorted by pair.
    std::vector<CheckItem> items() &&;

   private:
    CheckItem& item(const PartPair& pair) {
        return items_.try_emplace(pair, CheckItem{ItemKind::undefined, pair.first, pair.second}).first->second;
    }

    const CheckOptions& options_;
    std::map<PartPair, CheckItem> items_;
};

}  // namespace crumple::checks
