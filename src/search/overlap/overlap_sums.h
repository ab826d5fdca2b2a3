#pragma once

// Correctly rounded sums over an overlap: over segments in which faces cross, and over faces
// (exact/overlap/pair_terms.h). Each sum is computed by the cheapest of three tiers that can round it:
//
//   double-double in blocks, one bound per term   by SIMD lanes or a device, for bodies in the double-double range
//   double-double, one bound per operation        for bodies in that range; 0 if coordinates are small integers
//   integers and rationals                        always
//
// If the bounds of one tier are too wide to round a number, the next tier computes its sums again: those over volumes,
// or those over curves.

#include <optional>
#include <span>
#include <vector>

#include "backends/overlap_kernels.h"
#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "exact/overlap/fixed_sum.h"
#include "exact/overlap/overlap_totals.h"
#include "exact/overlap/rational_sum.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

class OverlapSums {
   public:
    OverlapSums(ParallelFor& workers, const OverlapKernels* kernels, Cancellation& cancellation)
        : workers_(workers), kernels_(kernels), cancellation_(cancellation) {}

    // Input of the sums, which must not change once a sum has been requested:
    SurfacePair surfaces;
    RowOnDevice on_device;  ///< sums of segments (Segment::summed), if they are the segments of a row
    std::vector<Segment> segments;
    std::array<std::vector<CountedFace>, 2> faces;  ///< counted faces of the first and of the second body
    bool numbers = true;                            ///< false: only the volume is requested, no centroid and no curves

    template <class Combine>
    RoundedSum volume(Combine combine, int divisor) {
        return rounded(volume_, combine, divisor);
    }
    template <class Combine>
    RoundedSum curves(Combine combine, int divisor) {
        return rounded(curves_, combine, divisor);
    }

    /// Adds the first tier of the sums of some faces and segments, so that it is not computed again. Call it for parts
    /// that make up all of them, before a sum is requested.
    void add_part(const OverlapSums& part);

    /// True if some sum needed rational arithmetic.
    bool was_exact() const { return volume_.exact || curves_.exact; }

   private:
    template <template <class> class Totals>
    struct Tiers {
        std::optional<Totals<FixedSum>> in_blocks, enclosed;
        std::optional<Totals<RationalSum>> exact;
    };

    template <template <class> class Totals, class Combine>
    RoundedSum rounded(Tiers<Totals>& tiers, Combine combine, int divisor) {
        if (surfaces.in_range()) {
            if (kernels_ || on_device.device) {
                if (!tiers.in_blocks) add_in_blocks();
                if (const auto known = combine(*tiers.in_blocks).rounded_quotient(divisor)) return *known;
            }
            if (!tiers.enclosed) add_enclosed(tiers.enclosed.emplace());
            if (const auto known = combine(*tiers.enclosed).rounded_quotient(divisor)) return *known;
        }
        if (!tiers.exact) add_exact(tiers.exact.emplace());
        return combine(*tiers.exact).rounded_quotient(divisor, cancellation_);
    }

    struct BlockTotals {
        VolumeTotals<FixedSum> volume;
        CurveTotals<FixedSum> curves;

        void add(const BlockTotals& other) {
            volume.add(other.volume);
            curves.add(other.curves);
        }
    };

    void add_in_blocks();
    bool add_faces_on_device(std::size_t side, VolumeTotals<FixedSum>& totals);
    void add_faces(std::size_t side, std::size_t begin, std::size_t end, VolumeTotals<FixedSum>& to);
    void add_segments(std::span<const Segment> some, BlockTotals& to);
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
