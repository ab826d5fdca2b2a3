#pragma once

// A small mesh, a square of two triangles and a third triangle, in every format that the library reads.

#include <string>
#include <vector>

#include "files.h"

namespace crumple::io::test {

struct Sample {
    std::string name;  ///< file name, whose extension is that of the format
    std::string bytes;
};

inline TriangleMesh sample_mesh() {
    return {std::vector<double>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.25, -2}, {0, 1, 2, 0, 2, 3, 4, 1, 0}, {}};
}

inline std::string binary_ply(std::endian order) {
    std::string bytes = "ply\nformat binary_";
    bytes += order == std::endian::little ? "little" : "big";
    bytes +=
        "_endian 1.0\ncomment a square and a triangle\nelement tag 2\nproperty list uchar short values\n"
        "element vertex 5\nproperty uchar quality\nproperty double x\nproperty double y\nproperty double z\n"
        "element face 2\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n";
    bytes += packed(order, std::uint8_t{2}, std::int16_t{7}, std::int16_t{8}, std::uint8_t{0});
    const std::vector<double> xyz = coordinates(sample_mesh());
    for (std::size_t i = 0; i < xyz.size(); i += 3) bytes += packed(order, '\1', xyz[i], xyz[i + 1], xyz[i + 2]);
    bytes += packed(order, std::uint8_t{4}, 0, 1, 2, 3, 5, std::uint8_t{3}, 4, 1, 0, -6);
    return bytes;
}

inline std::string ascii_ply() {
    return "ply\nformat ascii 1.0\ncomment a square and a triangle\nobj_info none\nelement vertex 5\n"
           "property double x\nproperty double y\nproperty double z\n"
           "element face 2\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n"
           "0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 0.25 -2e0\n4 0 1 2 3 5\n3 4 1 0 -6\n";
}

inline std::string binary_stl() {
    const TriangleMesh mesh = sample_mesh();
    const std::vector<double> xyz = coordinates(mesh);
    std::string bytes = "solid, although binary";
    bytes.resize(80);
    bytes += packed(std::endian::little, std::uint32_t{3});
    for (std::size_t t = 0; t < 3; ++t) {
        bytes += packed(std::endian::little, 0.0f, 0.0f, 1.0f);
        for (std::size_t c = 0; c < 3; ++c) {
            const double* const p = &xyz[3 * static_cast<std::size_t>(mesh.triangles[3 * t + c])];
            bytes += packed(std::endian::little, static_cast<float>(p[0]), static_cast<float>(p[1]),
                            static_cast<float>(p[2]));
        }
        bytes += packed(std::endian::little, std::uint16_t{0});
    }
    return bytes;
}

inline std::string ascii_stl() {
    return "solid square\n"
           " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n"
           "  endloop\n endfacet\n"
           " facet normal nan 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n"
           "  endloop\n endfacet\n"
           "endsolid square\nsolid\n"
           "facet normal 0 0 1 outer loop vertex .5 .25 -2 vertex 1 0 0 vertex -0 0 0 endloop endfacet\nendsolid\n";
}

inline std::string obj() {
    return "# a square and a triangle\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0 1.0\nv 0 1 0 0.5 0.5 0.5\nvn 0 0 1\n"
           "f 1//1 2//1 3//1 4//1\nv 0.5 .25 -2\ng triangle\nf -1 2 \\\n 1\n";
}

inline std::string off() {
    return "OFF # a square and a triangle\n5 2 7\n0 0 0\n1 0 0\n1 1 0\n\n0 1 0\n0.5 .25 -2\n"
           "4 0 1 2 3 255 0 0\n3 4 1 0\n";
}

/// Returns sample_mesh() in all formats. The vertices have the same order in all of them, in STL after welding.
inline std::vector<Sample> samples() {
    return {{"ascii.ply", ascii_ply()},
            {"little.ply", binary_ply(std::endian::little)},
            {"big.ply", binary_ply(std::endian::big)},
            {"binary.stl", binary_stl()},
            {"ascii.stl", ascii_stl()},
            {"square.obj", obj()},
            {"square.off", off()}};
}

}  // namespace crumple::io::test
