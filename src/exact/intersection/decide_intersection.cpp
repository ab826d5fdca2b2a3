#include "exact/intersection/decide_intersection.h"

#include "exact/intersection/exact_intersection.h"
#include "exact/intersection/intersection_decision.h"

namespace crumple {

bool collide(const Triangle& a, const Triangle& b, Neighbours neighbours, IntersectionKind intersections,
             DecisionCounts& counts) {
    ExactSigns signs;
    const Verdict verdict = decide(a, b, neighbours, intersections, signs);
    if (verdict == Verdict::undecided) {
        ++counts.exact;
        ++counts.rational;
        return collide(intersect_rationally(a, b), neighbours, intersections);
    }
    counts.exact += signs.expanded();
    return verdict == Verdict::collides;
}

}  // namespace crumple
