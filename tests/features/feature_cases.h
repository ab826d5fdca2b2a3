#pragma once

// Random pairs of features that are hard for filters, for the tests of this folder. Coordinates are at most 1, like
// those of normalised rows.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "exact/impact/exact_min_distance.h"
#include "exact/proximity/rational_distance.h"
#include "filters/features/feature_points.h"
#include "impacts/moves.h"

namespace crumple {

enum class Hard {
    random,    ///< uniform in [-0.9, 0.9]^3
    lattice,   ///< multiples of 1/4 up to 1/2: coplanar, parallel, degenerate, touching
    touching,  ///< in contact at some time, except for rounding and a few units in the last place
    flat,      ///< in one plane, except for rounding
    needles,   ///< close to one line
    tiny,      ///< the lattice times a power of two, down to subnormal numbers
    speck,     ///< random, of about the size at which squares of float32 numbers underflow
    mixed,     ///< each coordinate of its own magnitude
    opposite,  ///< closest along the line through their centres, except for rounding; a third of them in contact
};
inline constexpr std::array all_hard{Hard::random, Hard::lattice, Hard::touching, Hard::flat,    Hard::needles,
                                     Hard::tiny,   Hard::speck,   Hard::mixed,    Hard::opposite};
constexpr std::string_view hard_name(Hard how) {
    constexpr std::array<std::string_view, all_hard.size()> names{"random", "lattice", "touching", "flat",    "needles",
                                                                  "tiny",   "speck",   "mixed",    "opposite"};
    return names[static_cast<std::size_t>(how)];
}

inline void PrintTo(Hard how, std::ostream* out) { *out << hard_name(how); }
inline std::string name_of_hard(const testing::TestParamInfo<Hard>& info) { return std::string(hard_name(info.param)); }

/// Returns the tables of every instruction set that the build and the machine have.
inline const std::vector<const cpu::FeatureTables*>& feature_tables() {
    static const auto all = cpu::all_feature_kernels();
    return all;
}

/// A pair of features, and a minimum distance: `distance` or `share` times the distance at the start, whichever is
/// larger, both taken as exact.
struct FeatureCase {
    FeatureKind kind;
    int moments;  ///< number of time samples; 1: static, at the start positions
    FeaturePoints point;
    float distance = 0;
    double share = 0;

    bool near() const {
        const auto& [p, q, r, s] = point;
        const bool face = kind == FeatureKind::vertex_face;
        if (moments == 1) return RationalDistance(at_start(kind, point)).within({distance, 0});
        if (distance == 0 && share == 0) return (face ? vertex_face(p, q, r, s) : edge_edge(p, q, r, s)).meets;
        const MinDistance separation{distance, share};
        return (face ? vertex_face(p, q, r, s, separation) : edge_edge(p, q, r, s, separation)).meets;
    }

    friend std::ostream& operator<<(std::ostream& out, const FeatureCase& c) {
        out << feature_kind_name(c.kind) << ", " << c.moments << " moments";
        for (const MovingPoint& p : c.point) out << ", " << p;
        return out << ", distance " << c.distance << ", share " << c.share;
    }
};

class RandomCases {
   public:
    RandomCases(Hard how, bool float32, std::uint64_t seed) : how_(how), float32_(float32), engine_(seed) {}

    int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
    double real(double low, double high) { return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53; }

    /// Returns a random case. Half of the cases have no minimum distance; the others have a random one, or one close to
    /// the distance of the features at the start.
    FeatureCase operator()(FeatureKind kind, int moments) {
        begin();
        FeatureCase c{kind, moments, {}};
        for (MovingPoint& p : c.point) p = {place(), place()};
        if (how_ == Hard::touching) touch(c);
        if (how_ == Hard::opposite) oppose(c);
        if (below(4) == 0) rigidly(c.point);
        for (MovingPoint& p : c.point) {
            p = {number(p.start), number(p.end)};
            if (how_ == Hard::touching && below(4) == 0) nudge(below(2) ? p.start : p.end);
            if (moments == 1) p.end = p.start;
        }
        if (below(2)) c.distance = distance(c);
        return c;
    }

    /// Limits coordinates to [-1, 1], and rounds them to float32 if the rows are float32.
    Vec3d number(Vec3d p) {
        for (int axis = 0; axis < 3; ++axis) {
            volatile float rounded = static_cast<float>(p[axis]);
            p[axis] = std::clamp(float32_ ? static_cast<double>(rounded) : p[axis], -1.0, 1.0);
        }
        return p;
    }

   private:
    // Draws what all points of a case have in common.
    void begin() {
        plane_ = {real(-0.4, 0.4), real(-0.4, 0.4), real(-0.1, 0.1)};
        along_ = {real(-0.4, 0.4), real(-0.4, 0.4), real(-0.4, 0.4)};
        scale_ = std::ldexp(1.0, how_ == Hard::speck ? -58 - below(12) : -below(float32_ ? 150 : 300));
    }

    Vec3d place() {
        const auto cell = [&] { return (below(5) - 2) * 0.25; };
        const auto any = [&] { return real(-0.9, 0.9); };
        switch (how_) {
            case Hard::random:
            case Hard::opposite:
                return {any(), any(), any()};
            case Hard::lattice:
            case Hard::touching:
                return {cell(), cell(), cell()};
            case Hard::flat: {
                const double x = any(), y = any();
                return {x, y, plane_.x * x + plane_.y * y + plane_.z};
            }
            case Hard::needles: {
                const double thin = std::ldexp(1.0, -below(30));
                return real(-1, 1) * along_ + thin * Vec3d{0.2 * any(), 0.2 * any(), 0.2 * any()};
            }
            case Hard::tiny:
                return scale_ * Vec3d{cell(), cell(), cell()};
            case Hard::speck:
                return scale_ * Vec3d{any(), any(), any()};
            case Hard::mixed:
                break;
        }
        const auto scaled = [&] { return std::ldexp(any(), -below(70)); };
        return {scaled(), scaled(), scaled()};
    }

    // Moves the first point, or the third and fourth, so that the features have a common point at some eighth of the
    // step.
    void touch(FeatureCase& c) {
        auto& [p, q, r, s] = c.point;
        const double when = c.moments == 1 ? 0 : below(9) / 8.0, u = below(5) / 4.0, v = (1 - u) * (below(5) / 4.0);
        const auto at = [&](const MovingPoint& m) { return m.start + when * (m.end - m.start); };
        const auto move = [](MovingPoint& m, Vec3d by) { m = {m.start + by, m.end + by}; };
        if (c.kind == FeatureKind::vertex_face)
            return move(p, at(q) + u * (at(r) - at(q)) + v * (at(s) - at(q)) - at(p));
        const Vec3d by = at(p) + u * (at(q) - at(p)) - at(r) - v * (at(s) - at(r));
        move(r, by), move(s, by);
    }

    // Places one feature above the other at constant height, both symmetric about the line through their centres.
    void oppose(FeatureCase& c) {
        const double turn = real(0, 6.3), tilt = real(0, 6.3), height = below(3) ? std::ldexp(0.3, -below(20)) : 0;
        const Vec3d across{-std::sin(turn), std::cos(turn), 0}, x{std::cos(turn), std::sin(turn), 0};
        const Vec3d y = std::cos(tilt) * across + Vec3d{0, 0, std::sin(tilt)}, z = cross(x, y);
        const Vec3d from{real(-0.3, 0.3), real(-0.3, 0.3), real(-0.3, 0.3)}, way{real(-0.2, 0.2), 0.1, real(-0.2, 0.2)};
        const Vec3d base = from + height * z, wide = real(0.01, 0.3) * x, up = real(0.01, 0.3) * z;
        const bool upright = below(2);  // a face stands on a side, an edge on an end; otherwise both lie flat
        std::array<Vec3d, 4> at;
        if (c.kind == FeatureKind::vertex_face)
            at = {from, base - wide, base + wide, base + (upright ? up : real(0, 0.3) * y)};
        else
            at = {from - wide, from + wide, upright ? base : base - 0.2 * y, base + (upright ? up : 0.2 * y)};
        for (std::size_t k = 0; k < 4; ++k) c.point[k] = {at[k], at[k] + way};
    }

    // Makes all points move by nearly the same amount.
    void rigidly(FeaturePoints& point) {
        const Vec3d way = point[0].end - point[0].start;
        for (MovingPoint& p : point) p.end = p.start + way;
    }

    void nudge(Vec3d& p) {
        double& x = p[below(3)];
        const double to = below(2) ? 1 : -1;
        for (int k = below(3); k >= 0; --k)
            x = float32_ ? std::nextafter(static_cast<float>(x), static_cast<float>(to)) : std::nextafter(x, to);
    }

    float distance(const FeatureCase& c) {
        if (below(8) == 0) return static_cast<float>(real(0, 0.2));
        auto d = static_cast<float>(RationalDistance(at_start(c.kind, c.point)).rounded_down());
        for (int k = below(7); k > 0; --k) d = std::nextafter(d, 4.0f);
        return below(4) ? d : d * (1 + std::ldexp(1.0f, -below(24)));
    }

    Hard how_;
    bool float32_;
    std::mt19937_64 engine_;
    Vec3d plane_, along_;
    double scale_ = 1;
};

}  // namespace crumple
