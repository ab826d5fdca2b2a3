#pragma once

// Functions that make pairs of features for the tests of this folder, and operators that print them in failure
// messages.

#include <ostream>

#include "exact/proximity/rational_distance.h"

namespace crumple {

inline constexpr std::array all_kinds{FeatureKinds::vertex_face, FeatureKinds::edge_edge, FeatureKinds::vertex_edge,
                                      FeatureKinds::vertex_vertex};

inline Features vertex_face(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return {FeatureKinds::vertex_face, {p, a, b, c}};
}
inline Features edge_edge(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    return {FeatureKinds::edge_edge, {a, b, c, d}};
}
inline Features vertex_edge(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
    return {FeatureKinds::vertex_edge, {p, a, b, {}}};
}
inline Features vertex_vertex(const Vec3d& p, const Vec3d& q) { return {FeatureKinds::vertex_vertex, {p, q, {}, {}}}; }

template <class Change>
Features with_points(Features features, Change change) {
    for (Vec3d& p : features.point) p = change(p);
    return features;
}

inline std::ostream& operator<<(std::ostream& out, const Features& features) {
    constexpr const char* names[] = {"vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"};
    out << names[static_cast<int>(features.kinds)];
    const auto precision = out.precision(17);
    for (std::size_t i = 0; i < points_of(features.kinds); ++i) {
        const Vec3d& p = features.point[i];
        out << (i == 0 ? " (" : ", (") << p.x << ", " << p.y << ", " << p.z << ')';
    }
    out.precision(precision);
    return out;
}

inline std::ostream& operator<<(std::ostream& out, const ClosestPoints& closest) {
    const auto precision = out.precision(17);
    out << "type " << int{closest.type} << " at " << closest.at[0] << ", " << closest.at[1];
    out.precision(precision);
    return out;
}

}  // namespace crumple
