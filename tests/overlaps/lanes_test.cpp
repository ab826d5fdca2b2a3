// Compares what the kernels of each instruction set compute in SIMD lanes, and threads of a device one by one, with
// rational arithmetic: signs that they call known must be exact, and all error bounds of sums must hold.

#include <gtest/gtest.h>

#include <limits>
#include <tuple>
#include <vector>

#include "backends/cpu/overlaps/overlap_lanes.h"
#include "base/float_environment.h"
#include "crumple/error.h"
#include "exact/overlap/exact_crossing.h"
#include "exact/overlap/filtered_crossing.h"
#include "geometry/random_pairs.h"
#include "search/overlap/overlap_blocks.h"
#include "search/overlap/overlap_exact.h"

namespace crumple {
namespace {

std::vector<const OverlapKernels*> all_kernels() {
    std::vector<const OverlapKernels*> found;
    for (const Simd simd : {Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon}) {
        try {
            found.push_back(cpu::overlap_kernels(simd));
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
        }
    }
    return found;
}

/// Body of triangles that share no corners.
struct LooseTriangles {
    std::vector<Vec3d> points;
    ClosedSurface closed{nullptr};
    PlacedSurface placed;

    explicit LooseTriangles(const std::vector<Triangle>& triangles) {
        std::vector<std::int32_t> corners;
        for (const Triangle& t : triangles)
            for (const Vec3d& p : t.point) {
                corners.push_back(static_cast<std::int32_t>(points.size()));
                points.push_back(p);
                placed.box.widen(p);
            }
        ParallelFor workers;
        SceneBuffers buffers;
        const auto n = static_cast<std::int64_t>(triangles.size());
        const MeshView view(&points[0].x, 3 * n, corners.data(), n);
        closed.prepare(prepare_scene(view, nullptr, false, workers, buffers), workers);
        placed.surface = &closed;
        placed.points = points.data();
    }
};

Rational sum_of(const WordSum& words, int lanes) {
    Rational sum = 0;
    for (int i = 0; i < lanes; ++i) sum += Rational(words.high[i]) + Rational(words.low[i]);
    return sum;
}
void expect_enclosed(const WordSum& words, int lanes, const RationalSum& sum, double most) {
    ASSERT_LE(words.error, most);
    Cancellation none;
    EXPECT_LE(abs(sum_of(words, lanes) - sum.total(none)), Rational(words.error));
}
void expect_enclosed(const WordSum (&words)[3], int lanes, const std::array<RationalSum, 3>& sums, double most) {
    for (std::size_t k = 0; k < 3; ++k) expect_enclosed(words[k], lanes, sums[k], most);
}

void expect_equal(const DecidedCrossing& found, const DecidedCrossing& exact) {
    ASSERT_EQ(found.jumps.a, exact.jumps.a);
    ASSERT_EQ(found.jumps.b, exact.jumps.b);
    ASSERT_EQ(found.jumps.segment, exact.jumps.segment);
    if (!exact.jumps.segment) return;
    for (const auto end : {&Segment::start, &Segment::end}) {
        const SegmentEnd &x = found.segment.*end, &y = exact.segment.*end;
        EXPECT_EQ(std::tie(x.side, x.edge, x.vertex, x.jump), std::tie(y.side, y.edge, y.vertex, y.jump));
    }
}

void expect_enclosed(const Enclosed& found, const RationalSum& sum, double most) {
    ASSERT_LE(found.error, most);
    Cancellation none;
    EXPECT_LE(abs(Rational(found.value.high) + Rational(found.value.low) - sum.total(none)), Rational(found.error));
}
void expect_enclosed(const Vec3<Enclosed>& found, const std::array<RationalSum, 3>& sums, double most) {
    for (int axis = 0; axis < 3; ++axis) expect_enclosed(found[axis], sums[static_cast<std::size_t>(axis)], most);
}
void expect_enclosed(const VolumeTerms<Enclosed>& found, const VolumeTotals<RationalSum>& sums, double most) {
    expect_enclosed(found.volume, sums.volume, most);
    expect_enclosed(found.moment, sums.moment, most);
}

class SimdOverlapsOfEachKind : public testing::TestWithParam<Kind> {
   protected:
    RandomPairs random_{GetParam(), 31};
    std::mt19937 dice_{5};
    const FloatEnvironment environment_;

    static bool in_range(const Triangle& t) {
        for (const Vec3d& p : t.point)
            for (int axis = 0; axis < 3; ++axis)
                if (p[axis] != 0 && !(std::abs(p[axis]) >= 0x1p-150 && std::abs(p[axis]) <= 0x1p150)) return false;
        return true;
    }
    int rounds() const { return rounds_of(GetParam(), 20); }

    /// Returns segments in which face i of the first surface crosses face i of the second one.
    std::vector<Segment> segments_of(const SurfacePair& surfaces) {
        std::vector<Segment> segments;
        for (std::int32_t f = 0; f < surfaces.surface[0]->surface->face_count(); ++f) {
            const CrossedFace p(surfaces.corners(0, f)), q(surfaces.corners(1, f));
            FilteredCrossingSigns signs(p, q);
            const DecidedCrossings both = decide_crossings(signs);
            for (const DecidedCrossing* crossing : {&both.forward, &both.backward}) {
                if (!crossing->jumps.segment || segments.size() == SegmentBlock::size) continue;
                Segment& segment = segments.emplace_back(crossing->segment);
                segment.a = segment.b = f;
                segment.in_volume = crossing == &both.forward;
                segment.times = static_cast<std::int8_t>(dice_() % 3);
            }
        }
        return segments;
    }

    /// Sums as a thread of a device does.
    void expect_enclosed_one_by_one(const SurfacePair& surfaces, const std::vector<Segment>& segments, double most) {
        const ExactTerms terms(surfaces);
        SegmentTerms sum;
        VolumeTotals<RationalSum> volume;
        CurveTotals<RationalSum> curves;
        for (const Segment& segment : segments) {
            if (!add_if_certain(segment, surfaces.corners_a(segment), surfaces.corners_b(segment), surfaces.origin,
                                true, sum))
                continue;
            ++certain_;
            terms.add(segment, volume);
            terms.add(segment, curves);
        }
        expect_enclosed(sum.volume, volume, most);
        expect_enclosed(sum.curves.area, curves.area, most);
        expect_enclosed(sum.curves.torque, curves.torque, most);
    }

    int certain_ = 0;  ///< number of segments whose terms were certain
};

TEST_P(SimdOverlapsOfEachKind, sums_are_within_their_error_bounds) {
    constexpr double largest = std::numeric_limits<double>::max();
    const auto kernels = all_kernels();
    for (int round = 0; round < rounds(); ++round) {
        std::vector<Triangle> of_a, of_b;
        for (int tries = 0; of_a.size() < 1 + 5 * static_cast<std::size_t>(round) % FaceBlock::size && tries < 200;
             ++tries) {
            const TrianglePair pair = random_();
            if (!in_range(pair.a) || !in_range(pair.b)) continue;
            of_a.push_back(pair.a);
            of_b.push_back(pair.b);
        }
        if (of_a.empty()) continue;
        const LooseTriangles a(of_a), b(of_b);
        const bool precise = GetParam() == Kind::random;
        const SurfacePair surfaces{{&a.placed, &b.placed}, round % 3 ? of_b[0].point[1] : Vec3d{}};
        const ExactTerms terms(surfaces);

        std::vector<CountedFace> faces;
        VolumeTotals<RationalSum> of_faces;
        VolumeTerms<Enclosed> one_by_one;
        for (std::int32_t f = 0; f < a.closed.face_count(); ++f) {
            const auto times = static_cast<std::int32_t>(dice_() % 7) - 3;
            faces.push_back({f, times});
            terms.add_face(a.placed.corners(f), times, of_faces);
            add_face_terms(a.placed.corners(f), times, surfaces.origin, one_by_one);
        }
        expect_enclosed(one_by_one, of_faces, precise ? 0x1p-78 : largest);
        const std::vector<Segment> segments = segments_of(surfaces);
        expect_enclosed_one_by_one(surfaces, segments, precise ? 0x1p-60 : largest);
        for (const OverlapKernels* lanes : kernels) {
            FaceBlock face_block;
            BlockSums sums;
            fill(surfaces, 0, faces, face_block);
            lanes->add_faces(face_block, surfaces.origin, true, sums);
            expect_enclosed(sums.volume, sums.lanes, of_faces.volume, precise ? 0x1p-78 : largest);
            expect_enclosed(sums.moment, sums.lanes, of_faces.moment, precise ? 0x1p-78 : largest);

            if (segments.empty()) continue;
            SegmentBlock block;
            fill(surfaces, segments, block);
            const std::uint64_t uncertain = lanes->add_segments(block, surfaces.origin, true, sums);
            VolumeTotals<RationalSum> volume;
            CurveTotals<RationalSum> curves;
            for (std::size_t i = 0; i < segments.size(); ++i) {
                if (uncertain >> i & 1) continue;
                terms.add(segments[i], volume);
                terms.add(segments[i], curves);
            }
            expect_enclosed(sums.volume, sums.lanes, volume.volume, precise ? 0x1p-60 : largest);
            expect_enclosed(sums.moment, sums.lanes, volume.moment, precise ? 0x1p-60 : largest);
            expect_enclosed(sums.area, sums.lanes, curves.area, precise ? 0x1p-60 : largest);
            expect_enclosed(sums.torque, sums.lanes, curves.torque, precise ? 0x1p-60 : largest);
            BlockSums less;
            EXPECT_EQ(lanes->add_segments(block, surfaces.origin, false, less), uncertain);
            EXPECT_EQ(sum_of(less.volume, less.lanes), sum_of(sums.volume, sums.lanes));
        }
    }
}

TEST_P(SimdOverlapsOfEachKind, known_signs_are_exact) {
    const auto kernels = all_kernels();
    int known = 0, tied = 0, all = 0;
    for (int round = 0; round < 10 * rounds(); ++round) {
        std::vector<Triangle> of_a, of_b;
        std::vector<Pair> pairs;
        for (int tries = 0; of_a.size() < 1 + static_cast<std::size_t>(round) % PairBlock::size && tries < 200;
             ++tries) {
            const TrianglePair pair = random_();
            if (!in_range(pair.a) || !in_range(pair.b)) continue;
            pairs.push_back({static_cast<std::int32_t>(of_a.size()), static_cast<std::int32_t>(of_a.size())});
            of_a.push_back(pair.a);
            of_b.push_back(pair.b);
        }
        if (of_a.empty()) continue;
        const LooseTriangles a(of_a), b(of_b);
        const SurfacePair surfaces{{&a.placed, &b.placed}, {}};
        std::vector<DecidedCrossings> exact;
        for (const Pair& pair : pairs)
            exact.push_back(decide_crossings(a.placed.corners(pair.a), b.placed.corners(pair.b)));
        for (const OverlapKernels* lanes : kernels) {
            PairBlock block;
            CrossingSigns signs;
            fill(surfaces, pairs, block);
            lanes->find_signs(block, signs);
            for (std::size_t i = 0; i < pairs.size(); ++i, ++all) {
                SCOPED_TRACE((TrianglePair{of_a[i], of_b[i]}));
                const DecidedCrossing none;
                if (signs.apart >> i & 1) {
                    expect_equal(none, exact[i].forward);
                    expect_equal(none, exact[i].backward);
                    EXPECT_FALSE(exact[i].coplanar);
                    ++known;
                } else if (signs.decided >> i & 1) {
                    DecidedSigns of_pair(signs, i);
                    const DecidedCrossings found = decide_crossings(of_pair);
                    expect_equal(found.forward, exact[i].forward);
                    expect_equal(found.backward, exact[i].backward);
                    EXPECT_EQ(found.tied, exact[i].tied);
                    EXPECT_EQ(found.coplanar, exact[i].coplanar);
                    ++known;
                    tied += found.tied;
                }
            }
        }
    }
    if (kernels.empty()) return;
    if (GetParam() == Kind::random || GetParam() == Kind::lattice) {
        EXPECT_GT(known, all / 3);
    }
    if (GetParam() == Kind::lattice) {
        EXPECT_GT(tied, all / 10);
    }
}

INSTANTIATE_TEST_SUITE_P(All, SimdOverlapsOfEachKind, testing::ValuesIn(all_kinds));

}  // namespace
}  // namespace crumple
