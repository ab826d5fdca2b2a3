#pragma once

// Boxes in OFF.

#include <array>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

namespace crumple::cli::test {

using Corner = std::array<double, 3>;

inline constexpr std::array<std::array<int, 3>, 12> box_triangles{{{0, 1, 3},
                                                                   {0, 3, 2},
                                                                   {4, 6, 7},
                                                                   {4, 7, 5},
                                                                   {0, 4, 5},
                                                                   {0, 5, 1},
                                                                   {2, 3, 7},
                                                                   {2, 7, 6},
                                                                   {0, 2, 6},
                                                                   {0, 6, 4},
                                                                   {1, 5, 7},
                                                                   {1, 7, 3}}};

inline std::vector<Corner> box_corners(const Corner& low, const Corner& high) {
    std::vector<Corner> corners;
    for (const double x : {low[0], high[0]})
        for (const double y : {low[1], high[1]})
            for (const double z : {low[2], high[2]}) corners.push_back({x, y, z});
    return corners;
}

/// Returns a box in OFF with the first `triangles` of its 12 triangles; fewer leave it open.
inline std::string box_off(const Corner& low, const Corner& high, std::size_t triangles = 12) {
    std::ostringstream out;
    out << "OFF\n8 " << triangles << " 0\n";
    for (const auto& [x, y, z] : box_corners(low, high)) out << x << ' ' << y << ' ' << z << '\n';
    for (std::size_t t = 0; t < triangles; ++t)
        out << "3 " << box_triangles[t][0] << ' ' << box_triangles[t][1] << ' ' << box_triangles[t][2] << '\n';
    return out.str();
}

/// Returns two boxes as one body in OFF.
inline std::string two_boxes(const Corner& low, const Corner& high, const Corner& other_low, const Corner& other_high) {
    std::ostringstream out;
    out << "OFF\n16 24 0\n";
    for (const auto& corners : {box_corners(low, high), box_corners(other_low, other_high)})
        for (const auto& [x, y, z] : corners) out << x << ' ' << y << ' ' << z << '\n';
    for (const int first : {0, 8})
        for (const auto& [a, b, c] : box_triangles)
            out << "3 " << first + a << ' ' << first + b << ' ' << first + c << '\n';
    return out.str();
}

}  // namespace crumple::cli::test
