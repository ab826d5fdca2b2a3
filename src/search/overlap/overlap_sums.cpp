#include "search/overlap/overlap_sums.h"

#include <algorithm>
#include <bit>
#include <mutex>

#include "search/overlap/overlap_blocks.h"
#include "search/overlap/overlap_enclosed.h"
#include "search/overlap/overlap_exact.h"

namespace crumple {
namespace {

struct LaneTotals {
    VolumeTotals<FixedSum> volume;
    CurveTotals<FixedSum> curves;

    void add(const LaneTotals& other) {
        volume.add(other.volume);
        curves.add(other.curves);
    }
};

void add(const WordSum& words, int lanes, FixedSum& sum) {
    for (int i = 0; i < lanes; ++i) {
        sum.add(words.high[i]);
        sum.add(words.low[i]);
    }
    sum.add(Enclosed({0, 0}, words.error));
}
void add(const WordSum (&words)[3], int lanes, std::array<FixedSum, 3>& sums) {
    for (std::size_t k = 0; k < 3; ++k) add(words[k], lanes, sums[k]);
}

void add(const Vec3<Enclosed>& vector, std::array<FixedSum, 3>& sums) {
    for (int axis = 0; axis < 3; ++axis) sums[static_cast<std::size_t>(axis)].add(vector[axis]);
}
void add(const EnclosedTerms& enclosed, const Segment& segment, VolumeTotals<FixedSum>& totals) {
    if (!segment.in_volume) return;
    VolumeTerms<Enclosed> terms;
    enclosed.add(segment, terms);
    totals.volume.add(terms.volume);
    add(terms.moment, totals.moment);
}
void add(const EnclosedTerms& enclosed, const Segment& segment, CurveTotals<FixedSum>& totals) {
    CurveTerms<Enclosed> terms;
    enclosed.add(segment, terms);
    for (int times = 0; times < segment.times; ++times) {
        add(terms.area, totals.area);
        add(terms.torque, totals.torque);
    }
}

}  // namespace

/// Adds the terms [0, n) to `totals`, in parallel chunks. add(begin, end, to) adds some of them to the totals `to` of a
/// chunk.
template <class Totals, class Add>
void OverlapSums::for_chunks(std::size_t n, Totals& totals, Add add) {
    constexpr std::size_t chunk = 2048;
    if (n <= chunk) {
        add(std::size_t{0}, n, totals);
        return;
    }
    std::mutex mutex;
    workers_.parallel_for((n + chunk - 1) / chunk, [&](std::size_t i) {
        cancellation_.check();
        Totals part;
        add(i * chunk, std::min(n, (i + 1) * chunk), part);
        const std::scoped_lock lock(mutex);
        totals.add(part);
    });
}

void OverlapSums::add_in_lanes() {
    LaneTotals totals;
    const auto add_volume = [&](const BlockSums& sums, VolumeTotals<FixedSum>& to) {
        add(sums.volume, sums.lanes, to.volume);
        if (numbers) add(sums.moment, sums.lanes, to.moment);
    };
    for (std::size_t side = 0; side < 2; ++side)
        for_chunks(faces[side].size(), totals, [&](std::size_t begin, std::size_t end, LaneTotals& to) {
            FaceBlock block;
            BlockSums sums;
            for (std::size_t i = begin; i < end; i += FaceBlock::size) {
                fill(surfaces, side, std::span(faces[side]).subspan(i, std::min<std::size_t>(FaceBlock::size, end - i)),
                     block);
                kernels_->add_faces(block, surfaces.origin, numbers, sums);
                add_volume(sums, to.volume);
            }
        });
    const EnclosedTerms enclosed(surfaces);
    for_chunks(segments.size(), totals, [&](std::size_t begin, std::size_t end, LaneTotals& to) {
        SegmentBlock block;
        BlockSums sums;
        for (std::size_t i = begin; i < end; i += SegmentBlock::size) {
            const auto some = std::span(segments).subspan(i, std::min<std::size_t>(SegmentBlock::size, end - i));
            fill(surfaces, some, block);
            std::uint64_t uncertain = kernels_->add_segments(block, surfaces.origin, numbers, sums);
            add_volume(sums, to.volume);
            if (numbers) {
                add(sums.area, sums.lanes, to.curves.area);
                add(sums.torque, sums.lanes, to.curves.torque);
            }
            for (; uncertain; uncertain &= uncertain - 1) {
                const Segment& segment = some[static_cast<std::size_t>(std::countr_zero(uncertain))];
                add(enclosed, segment, to.volume);
                if (numbers) add(enclosed, segment, to.curves);
            }
        }
    });
    volume_.in_lanes = totals.volume;
    curves_.in_lanes = totals.curves;
}

void OverlapSums::add_enclosed(VolumeTotals<FixedSum>& totals) {
    const EnclosedTerms enclosed(surfaces);
    for (std::size_t side = 0; side < 2; ++side)
        for_chunks(faces[side].size(), totals, [&](std::size_t begin, std::size_t end, VolumeTotals<FixedSum>& to) {
            for (std::size_t i = begin; i < end; ++i) {
                VolumeTerms<Enclosed> terms;
                enclosed.add_face(surfaces.corners(side, faces[side][i].face), faces[side][i].times, terms);
                to.volume.add(terms.volume);
                add(terms.moment, to.moment);
            }
        });
    for_chunks(segments.size(), totals, [&](std::size_t begin, std::size_t end, VolumeTotals<FixedSum>& to) {
        for (std::size_t i = begin; i < end; ++i) add(enclosed, segments[i], to);
    });
}

void OverlapSums::add_enclosed(CurveTotals<FixedSum>& totals) {
    const EnclosedTerms enclosed(surfaces);
    for_chunks(segments.size(), totals, [&](std::size_t begin, std::size_t end, CurveTotals<FixedSum>& to) {
        for (std::size_t i = begin; i < end; ++i) add(enclosed, segments[i], to);
    });
}

void OverlapSums::add_exact(VolumeTotals<RationalSum>& totals) {
    const ExactTerms exact(surfaces);
    for (std::size_t side = 0; side < 2; ++side)
        for_chunks(faces[side].size(), totals, [&](std::size_t begin, std::size_t end, VolumeTotals<RationalSum>& to) {
            for (std::size_t i = begin; i < end; ++i) {
                cancellation_.check();
                exact.add_face(surfaces.corners(side, faces[side][i].face), faces[side][i].times, to);
            }
        });
    for_chunks(segments.size(), totals, [&](std::size_t begin, std::size_t end, VolumeTotals<RationalSum>& to) {
        for (std::size_t i = begin; i < end; ++i) {
            cancellation_.check();
            exact.add(segments[i], to);
        }
    });
}

void OverlapSums::add_exact(CurveTotals<RationalSum>& totals) {
    const ExactTerms exact(surfaces);
    for_chunks(segments.size(), totals, [&](std::size_t begin, std::size_t end, CurveTotals<RationalSum>& to) {
        for (std::size_t i = begin; i < end; ++i) {
            cancellation_.check();
            exact.add(segments[i], to);
        }
    });
}

}  // namespace crumple
