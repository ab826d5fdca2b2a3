#pragma once

// The sums over an overlap, rounded correctly: over segments in which faces cross, and over faces
// (exact/overlap/pair_terms.h). They are made as cheaply as what is asked of them allows:
//
//   words, in lanes, a bound for each term     if the backend has kernels, for bodies in the range of double words
//   words, a bound for each operation          which is 0 for small whole numbers: of bodies in that range
//   integers and rationals                     always
//
// A number that the bounds leave open is made again, it and what is summed with it.

#include <optional>
#include <span>
#include <vector>

#include "backends/overlap_kernels.h"
#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_sum.h"
#include "search/overlap_scene.h"

namespace crumple {

class OverlapSums {
   public:
    OverlapSums(ParallelFor& workers, const OverlapKernels* kernels, Cancellation& cancellation)
        : workers_(workers), kernels_(kernels), cancellation_(cancellation) {}

    // The terms, which stay as they are once a sum has been asked for:
    OverlapScene scene;
    std::vector<Segment> segments;
    std::array<std::vector<CountedFace>, 2> faces;  ///< of a and b
    bool numbers = true;                            ///< otherwise only the volume is asked for

    template <class Combine>
    RoundedSum volume(Combine combine, int divisor) {
        return rounded(volume_, combine, divisor);
    }
    template <class Combine>
    RoundedSum curves(Combine combine, int divisor) {
        return rounded(curves_, combine, divisor);
    }

    /// True if some sum needed rational arithmetic.
    bool was_exact() const { return volume_.exact || curves_.exact; }

   private:
    template <template <class> class Totals>
    struct Tiers {
        std::optional<Totals<FixedSum>> in_lanes, enclosed;
        std::optional<Totals<RationalSum>> exact;
    };

    template <template <class> class Totals, class Combine>
    RoundedSum rounded(Tiers<Totals>& tiers, Combine combine, int divisor) {
        if (scene.in_range()) {
            if (kernels_) {
                if (!tiers.in_lanes) add_in_lanes();
                if (const auto known = combine(*tiers.in_lanes).rounded_quotient(divisor)) return *known;
            }
            if (!tiers.enclosed) add_enclosed(tiers.enclosed.emplace());
            if (const auto known = combine(*tiers.enclosed).rounded_quotient(divisor)) return *known;
        }
        if (!tiers.exact) add_exact(tiers.exact.emplace());
        return combine(*tiers.exact).rounded_quotient(divisor, cancellation_);
    }

    void add_in_lanes();
    void add_enclosed(VolumeTotals<FixedSum>& totals);
    void add_enclosed(CurveTotals<FixedSum>& totals);
    void add_exact(VolumeTotals<RationalSum>& totals);
    void add_exact(CurveTotals<RationalSum>& totals);
    template <class Totals, class Add>
    void for_chunks(std::size_t n, Totals& totals, Add add);

    ParallelFor& workers_;
    const OverlapKernels* kernels_;
    Cancellation& cancellation_;
    Tiers<VolumeTotals> volume_;
    Tiers<CurveTotals> curves_;
};

}  // namespace crumple
