#include "search/overlap/overlap_sums.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <mutex>

#include "search/overlap/overlap_blocks.h"
#include "search/overlap/overlap_enclosed.h"
#include "search/overlap/overlap_exact.h"

namespace crumple {
namespace {

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
void add(const VolumeTerms<Enclosed>& terms, VolumeTotals<FixedSum>& totals) {
    totals.volume.add(terms.volume);
    add(terms.moment, totals.moment);
}
void add(const CurveTerms<Enclosed>& terms, CurveTotals<FixedSum>& totals) {
    add(terms.area, totals.area);
    add(terms.torque, totals.torque);
}
void add(const BlockSums& sums, bool numbers, VolumeTotals<FixedSum>& totals) {
    add(sums.volume, sums.lanes, totals.volume);
    if (numbers) add(sums.moment, sums.lanes, totals.moment);
}
void add(const EnclosedTerms& enclosed, const Segment& segment, VolumeTotals<FixedSum>& totals) {
    if (!segment.in_volume) return;
    VolumeTerms<Enclosed> terms;
    enclosed.add(segment, terms);
    add(terms, totals);
}
void add(const EnclosedTerms& enclosed, const Segment& segment, CurveTotals<FixedSum>& totals) {
    CurveTerms<Enclosed> terms;
    enclosed.add(segment, terms);
    for (int times = 0; times < segment.times; ++times) add(terms, totals);
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

// Adds the sums of the device. Segments and faces that it has not summed are added in lanes or, without lanes, with a
// bound for each operation.
void OverlapSums::add_in_blocks() {
    BlockTotals totals;
    for (std::size_t side = 0; side < 2; ++side) {
        if (add_faces_on_device(side, totals.volume)) continue;
        for_chunks(faces[side].size(), totals, [&](std::size_t begin, std::size_t end, BlockTotals& to) {
            add_faces(side, begin, end, to.volume);
        });
    }
    for (const SegmentTerms& sum : on_device.sums) {
        add(sum.volume, totals.volume);
        if (numbers) add(sum.curves, totals.curves);
    }
    std::vector<Segment> rest;
    const bool some_are_summed = !on_device.sums.empty();
    if (some_are_summed)
        std::ranges::copy_if(segments, std::back_inserter(rest), [](const Segment& s) { return !s.summed; });
    const std::span<const Segment> left = some_are_summed ? rest : segments;
    for_chunks(left.size(), totals, [&](std::size_t begin, std::size_t end, BlockTotals& to) {
        add_segments(left.subspan(begin, end - begin), to);
    });
    volume_.in_blocks = totals.volume;
    curves_.in_blocks = totals.curves;
}

void OverlapSums::add_part(const OverlapSums& part) {
    if (!part.volume_.in_blocks) return;
    if (!volume_.in_blocks) volume_.in_blocks.emplace(), curves_.in_blocks.emplace();
    volume_.in_blocks->add(*part.volume_.in_blocks);
    curves_.in_blocks->add(*part.curves_.in_blocks);
}

bool OverlapSums::add_faces_on_device(std::size_t side, VolumeTotals<FixedSum>& totals) {
    if (!on_device.device || faces[side].size() < on_device.device->least_faces()) return false;
    std::vector<VolumeTerms<Enclosed>> sums;
    if (!on_device.device->add_faces(on_device.surface[side], faces[side], surfaces.origin, sums)) return false;
    for (const VolumeTerms<Enclosed>& sum : sums) add(sum, totals);
    return true;
}

void OverlapSums::add_faces(std::size_t side, std::size_t begin, std::size_t end, VolumeTotals<FixedSum>& to) {
    if (!kernels_) {
        const EnclosedTerms enclosed(surfaces);
        for (std::size_t i = begin; i < end; ++i) {
            VolumeTerms<Enclosed> terms;
            enclosed.add_face(surfaces.corners(side, faces[side][i].face), faces[side][i].times, terms);
            add(terms, to);
        }
        return;
    }
    FaceBlock block;
    BlockSums sums;
    for (std::size_t i = begin; i < end; i += FaceBlock::size) {
        fill(surfaces, side, std::span(faces[side]).subspan(i, std::min<std::size_t>(FaceBlock::size, end - i)), block);
        kernels_->add_faces(block, surfaces.origin, numbers, sums);
        add(sums, numbers, to);
    }
}

void OverlapSums::add_segments(std::span<const Segment> some, BlockTotals& to) {
    const EnclosedTerms enclosed(surfaces);
    const auto add_enclosed = [&](const Segment& segment) {
        add(enclosed, segment, to.volume);
        if (numbers) add(enclosed, segment, to.curves);
    };
    if (!kernels_) {
        std::ranges::for_each(some, add_enclosed);
        return;
    }
    SegmentBlock block;
    BlockSums sums;
    for (std::size_t i = 0; i < some.size(); i += SegmentBlock::size) {
        const auto of_block = some.subspan(i, std::min<std::size_t>(SegmentBlock::size, some.size() - i));
        fill(surfaces, of_block, block);
        std::uint64_t uncertain = kernels_->add_segments(block, surfaces.origin, numbers, sums);
        add(sums, numbers, to.volume);
        if (numbers) {
            add(sums.area, sums.lanes, to.curves.area);
            add(sums.torque, sums.lanes, to.curves.torque);
        }
        for (; uncertain; uncertain &= uncertain - 1)
            add_enclosed(of_block[static_cast<std::size_t>(std::countr_zero(uncertain))]);
    }
}

void OverlapSums::add_enclosed(VolumeTotals<FixedSum>& totals) {
    const EnclosedTerms enclosed(surfaces);
    for (std::size_t side = 0; side < 2; ++side)
        for_chunks(faces[side].size(), totals, [&](std::size_t begin, std::size_t end, VolumeTotals<FixedSum>& to) {
            for (std::size_t i = begin; i < end; ++i) {
                VolumeTerms<Enclosed> terms;
                enclosed.add_face(surfaces.corners(side, faces[side][i].face), faces[side][i].times, terms);
                add(terms, to);
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
