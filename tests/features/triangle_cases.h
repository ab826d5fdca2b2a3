#pragma once

// Pairs of triangles around a hard pair of features, as the only two members of a leaf.

#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "base/float_environment.h"
#include "features/feature_cases.h"

namespace crumple {

/// Corners 0 1 2 belong to the first triangle, 3 4 5 to the second. The triangles have separate vertices, except those
/// that share() merges.
struct TriangleCase {
    int moments;
    std::array<MovingPoint, 6> corner;
    MinDistance separation{};
    std::array<std::int32_t, 6> vertex{0, 1, 2, 3, 4, 5};

    /// Makes a corner of the first triangle the same vertex as one of the second.
    void share(std::size_t of_one, std::size_t of_other) {
        corner[of_one] = corner[of_other];
        vertex[of_one] = vertex[of_other];
    }

    /// True if a pair of their features without a common vertex is within the distance.
    bool near() const {
        for (std::size_t i = 0; i < 3; ++i) {
            if (near(FeatureKind::vertex_face, {i, 3, 4, 5}) || near(FeatureKind::vertex_face, {3 + i, 0, 1, 2}))
                return true;
            for (std::size_t j = 0; j < 3; ++j)
                if (near(FeatureKind::edge_edge, {i, (i + 1) % 3, 3 + j, 3 + (j + 1) % 3})) return true;
        }
        return false;
    }

    friend std::ostream& operator<<(std::ostream& out, const TriangleCase& c) {
        out << c.moments << " moments";
        for (const MovingPoint& p : c.corner) out << ", " << p;
        return out << ", distance " << c.separation.distance << ", share " << c.separation.share;
    }

   private:
    bool near(FeatureKind kind, const std::array<std::size_t, 4>& corners) const {
        const std::size_t of_first = kind == FeatureKind::vertex_face ? 1 : 2;
        for (std::size_t i = 0; i < of_first; ++i)
            for (std::size_t j = of_first; j < 4; ++j)
                if (vertex[corners[i]] == vertex[corners[j]]) return false;
        const FeaturePoints point{corner[corners[0]], corner[corners[1]], corner[corners[2]], corner[corners[3]]};
        if (separation.share == 0)
            return FeatureCase{kind, moments, point, static_cast<float>(separation.distance)}.near();
        const auto& [p, q, r, s] = point;
        return (kind == FeatureKind::vertex_face ? vertex_face(p, q, r, s, separation)
                                                 : edge_edge(p, q, r, s, separation))
            .meets;
    }
};

/// Triangles around the features of a random case; their other features are mostly further away from each other.
class RandomTriangles {
   public:
    RandomTriangles(Hard how, bool float32, std::uint64_t seed) : features_(how, float32, seed) {}

    RandomCases& features() { return features_; }

    TriangleCase operator()(FeatureKind kind, int moments) {
        const FeatureCase c = features_(kind, moments);
        const auto& [p, q, r, s] = c.point;
        const bool face = kind == FeatureKind::vertex_face;
        const auto away = [&](const MovingPoint& from, const MovingPoint& other) {
            const double by = features_.real(-0.2, 0.5);
            MovingPoint m{features_.number(from.start + by * (from.start - other.start)),
                          features_.number(from.end + by * (from.end - other.end))};
            if (moments == 1) m.end = m.start;
            return m;
        };
        TriangleCase pair{moments, {}, {c.distance, 0}};
        if (face)
            pair.corner = {p, away(p, q), away(p, r), q, r, s};
        else
            pair.corner = {p, q, away(p, r), r, s, away(s, q)};
        return pair;
    }

   private:
    RandomCases features_;
};

inline constexpr float most = std::numeric_limits<float>::max();

/// Returns a frame along the coordinate axes. Triangles with coordinates beyond `big`, relative to `origin`, are big
/// members of the leaf.
constexpr LeafFrame around(Vec3f origin, float big = most) { return {origin, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, big}; }

/// A leaf with the two triangles of a case: records and boxes, made by the kernels of a table (those of one instruction
/// set), and the decision of these kernels whether a direction separates the triangles.
template <int moments>
class LeafOfTwo {
   public:
    using Record = FeatureRecord<moments>;

    /// Builds the leaf in a frame that moves by the corners' mean displacement.
    LeafOfTwo(const cpu::FeatureTables& table, const TriangleCase& c, bool float32, const LeafFrame& frame,
              const Inflation& inflation)
        : corners_(c.vertex), table_(table), features_(nullptr) {
        PreparedScene scene;
        scene.vertices = {6, 0};
        scene.triangles = {2, 0};
        scene.corners = corners_.data();
        ParallelFor serial;
        features_.prepare(scene, false, serial);
        for (int m = 0; m < moments; ++m)
            for (const MovingPoint& p : c.corner)
                for (int axis = 0; axis < 4; ++axis) rows_.push_back(axis == 3 ? 0 : (m ? p.end : p.start)[axis]);
        if (float32) rows32_.assign(rows_.begin(), rows_.end());
        std::vector<std::int32_t> triangle(2 + cpu::padding, 1);
        triangle[0] = 0;
        boxes_.resize(2);
        record_.resize(2 + cpu::padding);
        Vec3d motion;
        for (const MovingPoint& p : c.corner) motion = motion + (1.0 / 6) * (p.end - p.start);
        const FlushToZero mode;
        table.of<moments>().build({float32 ? PointRows{rows32_.data(), nullptr} : PointRows{nullptr, rows_.data()},
                                   corners_.data(), 2, triangle.data(), 2, frame, 6, inflation, to_float(motion)},
                                  features_, record_.data(), boxes_, bounds_);
    }

    const cpu::LeafBounds& bounds() const { return bounds_; }
    const cpu::Boxes& boxes() const { return boxes_; }

    /// True if the table keeps the pair, in either order, because no direction has a gap larger than `gap`.
    bool kept(const NeededGap& gap) const {
        const bool kept = separate(0, 1, gap) == 1;
        EXPECT_EQ(separate(1, 0, gap) == 1, kept);
        return kept;
    }

   private:
    std::size_t separate(std::uint16_t row, std::uint16_t column, const NeededGap& gap) const {
        constexpr std::uint16_t dummy = 2;
        cpu::CandidateChunk candidates(nullptr);
        candidates.count = 16;
        candidates.pairs = 1;
        candidates.dummy = dummy;
        candidates.row.assign(16 + cpu::padding, row);
        candidates.column.assign(16 + cpu::padding, dummy);
        candidates.column[0] = column;
        std::uint32_t left[16 + cpu::padding];
        const FlushToZero mode;
        const std::size_t count = table_.of<moments>().separate(record_.data(), candidates, gap, left);
        EXPECT_TRUE(count == 0 || left[0] == (std::uint32_t{column} << 16 | row));
        return count;
    }

    std::array<std::int32_t, 6> corners_;
    const cpu::FeatureTables& table_;
    std::vector<double> rows_;
    std::vector<float> rows32_;
    SceneFeatures features_;
    Array<Record> record_;
    cpu::Boxes boxes_{nullptr};
    cpu::LeafBounds bounds_;
};

}  // namespace crumple
