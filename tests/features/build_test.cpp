// Tests that every table of kernels (one for each instruction set) builds the records and boxes of the scalar table, up
// to rounding.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/features/feature_member.h"
#include "base/float_environment.h"
#include "features/feature_cases.h"
#include "geometry/eigen.h"

namespace crumple {
namespace {

constexpr std::int64_t vertices = 300, triangles = 500;

/// Random moving triangles, some of them without area, and a leaf with some of them.
template <int moments>
class Leaf {
   public:
    explicit Leaf(std::int64_t members) : members_(members), features_(nullptr) {
        std::mt19937 engine(7);
        const auto number = [&] { return 2 * static_cast<float>(engine()) / 4294967296.0f - 1; };
        const auto vertex = [&] { return static_cast<std::int32_t>(engine() % vertices); };
        for (std::int64_t i = 0; i < moments * vertices; ++i) {
            for (int axis = 0; axis < 3; ++axis) rows32_.push_back(0.4f * number());
            rows32_.push_back(0);
        }
        rows64_.assign(rows32_.begin(), rows32_.end());
        for (std::int64_t t = 0; t < triangles; ++t) {
            const std::int32_t a = vertex();
            corners_.insert(corners_.end(), {a, vertex(), t % 17 ? vertex() : a});
        }
        PreparedScene scene;
        scene.vertices = {vertices, 0};
        scene.triangles = {triangles, 0};
        scene.corners = corners_.data();
        ParallelFor serial;
        features_.prepare(scene, false, serial);
        for (std::int64_t i = 0; i < members; ++i) triangle_.push_back(static_cast<std::int32_t>(i * 7 % triangles));
        triangle_.resize(static_cast<std::size_t>(members + cpu::padding), triangle_.back());
        for (std::int64_t t = 0; t < triangles; ++t) radius_.push_back(0.01f + 0.01f * number());
        const PrincipalAxes axes = principal_axes({3, 0.4, 0.2, 2, -0.3, 1});
        frame_.origin = {0.05f, -0.1f, 0.02f};
        for (int i = 0; i < 3; ++i) frame_.axis[i] = to_float(axes.axis[i]);
    }

    cpu::BuildInput input(bool float32, float big, Inflation inflation, bool radii) const {
        LeafFrame frame = frame_;
        frame.big = big;
        if (radii) inflation.radius = radius_.data();
        return {float32 ? PointRows{rows32_.data(), nullptr} : PointRows{nullptr, rows64_.data()},
                corners_.data(),
                triangles,
                triangle_.data(),
                members_,
                frame,
                vertices,
                inflation,
                {0.1f, -0.05f, 0.2f}};
    }
    const SceneFeatures& features() const { return features_; }

   private:
    std::int64_t members_;
    std::vector<float> rows32_, radius_;
    std::vector<double> rows64_;
    std::vector<std::int32_t> corners_, triangle_;
    SceneFeatures features_;
    LeafFrame frame_;
};

template <int moments>
struct Built {
    Array<FeatureRecord<moments>> record;
    cpu::Boxes boxes{nullptr};
    cpu::LeafBounds bounds;

    Built(const cpu::FeatureTables& table, const Leaf<moments>& leaf, const cpu::BuildInput& input) {
        record.resize(static_cast<std::size_t>(input.members + cpu::padding));
        boxes.resize(static_cast<std::size_t>(input.members));
        const FlushToZero mode;
        table.of<moments>().build(input, leaf.features(), record.data(), boxes, bounds);
    }
};

// Compares coordinates. They are below 1, so the tolerance is absolute.
void expect_near(const Vec3f& a, const Vec3f& b, float by) {
    for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(a[axis], b[axis], by);
}

template <int moments>
void expect_same(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, float by) {
    for (int i = 0; i < 4 * moments; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const float p = a.at(i)[axis], q = b.at(i)[axis];
            ASSERT_EQ(std::isnan(p), std::isnan(q));
            if (std::isnan(p)) continue;
            if (i % 4 < 3) {
                ASSERT_NEAR(p, q, by);
            } else if (by == 0) {
                ASSERT_NEAR(p, q, 1e-5);  // normals: less accurate, as edges are short
            }
        }
    for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(a.vertex[k], b.vertex[k]);
        ASSERT_EQ(a.edge[k], b.edge[k]);
    }
    ASSERT_EQ(a.triangle, b.triangle);
    ASSERT_EQ(a.owned, b.owned);
}

/// Expects the same records and boxes from all kernels as from the scalar ones, up to rounding. `until`: see
/// BuildInput; below 1, corners of SIMD kernels err by 8 u (coordinates are below 1), and their boxes are widened by 24
/// u.
template <int moments>
void expect_scalar_results(float until = 1) {
    const float corner_error = until < 1 ? 8 * unit_roundoff : 0;
    const float margin = (until < 1 ? 60 : 16) * unit_roundoff;
    const Inflation none, distance{0.02f, 0}, share{0, 0.5f}, both{0.01f, 0.25f};
    int big_ones = 0;
    for (const std::int64_t members : {1, 2, 3, 5, 64, 487}) {
        const Leaf<moments> leaf(members);
        for (const bool float32 : {true, false})
            for (const float big : {10.0f, 0.3f, 0.0f})
                for (const Inflation& inflation : {none, distance, share, both})
                    for (const bool radii : {false, true}) {
                        cpu::BuildInput input = leaf.input(float32, big, inflation, radii);
                        input.until = until;
                        const Built<moments> plain(cpu::scalar_features, leaf, input);
                        big_ones += plain.bounds.big;
                        for (const auto* table : feature_tables()) {
                            const Built<moments> built(*table, leaf, input);
                            ASSERT_EQ(built.bounds.big, plain.bounds.big);
                            ASSERT_NEAR(built.bounds.reach, plain.bounds.reach, 2 * margin - 32 * unit_roundoff);
                            if (plain.bounds.big < members) {
                                expect_near(built.bounds.low, plain.bounds.low, margin);
                                expect_near(built.bounds.high, plain.bounds.high, margin);
                            }
                            for (std::size_t i = 0; i < static_cast<std::size_t>(members); ++i) {
                                expect_same(built.record[i], plain.record[i], corner_error);
                                const auto corner = [](const cpu::BoxCorner& c) { return Vec3f{c.x, c.y, c.z}; };
                                expect_near(corner(built.boxes.low[i]), corner(plain.boxes.low[i]), margin);
                                expect_near(corner(built.boxes.high[i]), corner(plain.boxes.high[i]), margin);
                            }
                            if (testing::Test::HasFatalFailure()) return;
                        }
                    }
    }
    EXPECT_GT(big_ones, 1000);
}

TEST(FeatureRecords, static_records_and_boxes_match_the_scalar_kernels) { expect_scalar_results<1>(); }
TEST(FeatureRecords, moving_records_and_boxes_match_the_scalar_kernels) { expect_scalar_results<2>(); }
TEST(FeatureRecords, records_and_boxes_of_a_part_of_the_step_match_the_scalar_kernels) {
    for (const float until : {0.7f, 1e-3f, 1e-30f}) expect_scalar_results<2>(until);
}

// Boxes of a part of the step contain the corners at the start and at the end of that part, up to a margin of 10 u,
// less than the 12 u that `sort` adds (box_margin). They are smaller than those of the whole step.
TEST(FeatureRecords, box_of_a_part_of_the_step_contains_its_start_and_end) {
    const Leaf<2> leaf(487);
    const double u = unit_roundoff;
    for (const bool float32 : {true, false})
        for (const auto* table : feature_tables()) {
            cpu::BuildInput input = leaf.input(float32, 10, {}, false);
            const Built<2> whole(*table, leaf, input);
            input.until = 0.25f;
            const Built<2> part(*table, leaf, input);
            double size[2] = {0, 0};
            for (std::size_t i = 0; i < 487; ++i) {
                const auto &low = part.boxes.low[i], &high = part.boxes.high[i];
                size[0] += double{high.x} - low.x;
                size[1] += double{whole.boxes.high[i].x} - whole.boxes.low[i].x;
                for (int k = 0; k < 3; ++k) {
                    const std::int32_t corner = input.corners[3 * input.triangle[i] + k];
                    const auto wide = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
                    const auto relative = [&](int sample) {
                        const auto row = static_cast<std::int32_t>(corner + sample * input.ends);
                        return input.points[row] - wide(cpu::origin_at<2>(input, sample));
                    };
                    const Vec3d start = relative(0), end = relative(1);
                    for (const Vec3d& r : {start, start + 0.25 * (end - start)}) {
                        const auto along = [&](int i) { return dot(wide(input.frame.axis[i]), r); };
                        const Vec3d q{along(0), along(1), along(2)};
                        const double margin = 10 * u * part.bounds.reach;
                        ASSERT_TRUE(low.x - margin <= q.x && q.x <= high.x + margin);
                        ASSERT_TRUE(low.y - margin <= q.y && q.y <= high.y + margin);
                        ASSERT_TRUE(low.z - margin <= q.z && q.z <= high.z + margin);
                    }
                }
            }
            EXPECT_LT(size[0], 0.8 * size[1]);
        }
}

}  // namespace
}  // namespace crumple
