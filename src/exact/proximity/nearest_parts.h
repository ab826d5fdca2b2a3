#pragma once

// Closest parts of two features: the table that turns ClosestPoints::type into vertices, and functions that make
// weights and normals from it. Host only.
//
// Features are given by four points, as in Features. A part is a vertex, an edge or a face of a feature; the table
// lists the points of both parts for each kind and type.

#include <array>
#include <cmath>
#include <cstdint>

#include "exact/proximity/double_word_vec.h"
#include "exact/proximity/static_features.h"

namespace crumple {

/// Part of a feature. Of two points, the second one has the weight at[parameter], and the first one has the rest. Three
/// points are a face.
struct NearestPart {
    std::uint8_t points;
    std::array<std::uint8_t, 3> point;
    std::uint8_t parameter = 0;
};

struct NearestParts {
    NearestPart first, second;
};

/// Returns the closest parts of features of this kind, for a value of ClosestPoints::type.
inline const NearestParts& nearest_parts(FeatureKinds kinds, std::uint8_t type) {
    static constexpr NearestPart p{1, {0}}, q{1, {1}}, r{1, {2}}, s{1, {3}};
    static constexpr NearestPart edge_a{2, {0, 1}}, edge_b{2, {2, 3}, 1}, edge_of_vertex{2, {1, 2}};
    static constexpr NearestParts face[] = {
        {p, q}, {p, r}, {p, s}, {p, {2, {1, 2}, 0}}, {p, {2, {2, 3}, 1}}, {p, {2, {1, 3}, 1}}, {p, {3, {1, 2, 3}}}};
    static constexpr NearestParts edges[] = {{p, r},      {p, s},      {q, r},      {q, s},          {edge_a, r},
                                             {edge_a, s}, {p, edge_b}, {q, edge_b}, {edge_a, edge_b}};
    static constexpr NearestParts edge[] = {{p, q}, {p, r}, {p, edge_of_vertex}};
    static constexpr NearestParts vertices[] = {{p, q}};
    static constexpr const NearestParts* tables[] = {face, edges, edge, vertices};
    return tables[static_cast<std::size_t>(kinds)][type];
}

/// Number of values of ClosestPoints::type for each FeatureKinds.
inline constexpr std::array<std::uint8_t, 4> types_of_nearest_parts{7, 9, 3, 1};

/// Returns the weights of the points in the vector from the nearest point of the second part to that of the first.
inline std::array<double, 4> weights_of(const NearestParts& parts, const std::array<double, 2>& at) {
    std::array<double, 4> weights{};
    const auto add = [&](const NearestPart& part, double sign) {
        const double t = part.points == 2 ? at[part.parameter] : at[0], rest = part.points == 3 ? 1 - t - at[1] : 1 - t;
        if (part.points == 1) weights[part.point[0]] = sign;
        if (part.points > 1) weights[part.point[0]] = sign * std::fmax(rest, 0), weights[part.point[1]] = sign * t;
        if (part.points > 2) weights[part.point[2]] = sign * at[1];
    };
    add(parts.first, 1);
    add(parts.second, -1);
    return weights;
}

/// Directions along the closest parts of two features: none for two vertices, one for a vertex and an edge, two for two
/// edges, or a vertex and a face. The vector between the nearest points is perpendicular to them. They are exact
/// differences, scaled by powers of two, and products are double words.
class PartDirections {
   public:
    /// `blur`: bound on the error of each coordinate.
    PartDirections(const NearestParts& parts, const std::array<Vec3d, 4>& points, double blur = 0);

    /// Returns the unit vector along the component of v that is perpendicular to all directions; 0 if the length of
    /// this component is not above its error. `scale`: bound on the lengths of the vectors whose sum is v; `error`:
    /// that of v, relative to it.
    Vec3d perpendicular(const detail::Vec3dw& v, double scale, double error) const;
    /// Returns the side of v for two directions e and f: the sign of (e x f) · v, or 0 if it is uncertain, as above. 0
    /// for fewer directions.
    int side(const detail::Vec3dw& v, double scale, double error) const;
    /// Returns the unit vector along e x f for two directions; 0 if they are parallel, up to errors.
    Vec3d across() const;

   private:
    std::size_t count_ = 0;
    std::array<detail::Vec3dw, 2> along_{};
    detail::Vec3dw across_{};
    double tilt_ = 0;  ///< bound on the error of the direction perpendicular() to the directions, in radians
};

}  // namespace crumple
