#pragma once

// Membership of balls in clusters by any rule (Method::membership). The ball rule is a SIMD kernel; the other rules are
// plain loops, because only researchers use them (docs/subdivide.md#other-rules-of-membership).

#include <cstdint>

#include "backends/cpu/stages/kernels.h"
#include "backends/cpu/stages/layout.h"
#include "crumple/options.h"

namespace crumple::cpu {

/// Membership rule of a scene: the rule's options, and the scene's largest radius.
struct SceneMembership {
    Membership kind = Membership::ball;
    double threshold = 0, fuzziness = 2;
    float largest_radius = 0;  ///< R of [MZ] eq. 5; 0 for the other rules
};

/// Returns the rule for triangles [0, n), or for those t with included[t] if `included` is not null.
SceneMembership membership_of(const Options& options, const Array<Ball>& balls, std::int64_t n,
                              const std::uint8_t* included);

/// Sets masks and adds to counts as StageKernels::assign does, by any rule. Returns true if pairs may be lost: if the
/// rule leaves out a cluster that the ball rule includes. `included`: as for membership_of(), for these balls; balls
/// that are not included lose nothing.
bool assign_members(const SceneMembership& by, const StageKernels& kernels, const Ball* balls, std::int64_t n,
                    const std::uint8_t* included, const Centres& centres, std::uint64_t* mask, std::int64_t* count);

}  // namespace crumple::cpu
