#pragma once

// Properties of one body's surface, as `info` and `check` report them.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "checks/topology.h"
#include "crumple/io.h"
#include "crumple/open_edges.h"

namespace crumple::checks {

using Point = std::array<double, 3>;

Point point_of(const io::TriangleMesh& mesh, std::int32_t vertex);
/// Returns coordinates as the shortest decimals that read back as the mesh's numbers.
std::string text_of_point(const io::TriangleMesh& mesh, const Point& p);
/// Returns "3-5, from (0 0 0) to (1 0 0)": the vertices of an edge, by their indices in the mesh, and their positions.
std::string describe(const io::TriangleMesh& mesh, const Edge& edge);

struct BoundingBox {
    Point low, high;
};

inline Point middle_of(const BoundingBox& box) {
    Point middle;
    for (std::size_t k = 0; k < 3; ++k) middle[k] = box.low[k] / 2 + box.high[k] / 2;
    return middle;
}

/// Returns the box of all vertices, or nothing if there are none.
std::optional<BoundingBox> box_of(const io::TriangleMesh& mesh);

/// Returns a body of a world as a mesh with posed vertices.
io::TriangleMesh posed_body(const io::WorldMesh& world, std::size_t body);

/// Properties of one body, which is posed, or of a mesh.
struct BodyReport {
    static constexpr std::size_t most_edges = 3;  ///< number of open edges that are shown without --open-edges

    BodyReport(const io::TriangleMesh& mesh, bool lists_open_edges);

    /// True if the body is closed and consistently oriented, so that it has a volume.
    bool has_inside() const { return triangles > 0 && edges.closed && !edges.flipped; }
    bool is_inside_out() const { return volume && *volume < 0; }
    /// True if the body is closed, consistently oriented and not inside out, and has no degenerate triangle. The test
    /// of info --check: does not test whether the surface intersects itself.
    bool is_sound() const { return has_inside() && !is_inside_out() && degenerate.empty(); }

    std::int64_t vertices, unused, triangles;
    const char* precision;
    std::optional<BoundingBox> box;
    std::vector<std::int32_t> degenerate, duplicated;
    EdgeReport edges;
    std::optional<Array<OpenEdge>> listed;
    std::int32_t components = 0;
    std::vector<std::int32_t> labels;  ///< by triangle: its connected component
    std::optional<double> volume;      ///< set for a closed mesh with consistent orientation
};

nlohmann::json json_of(const io::TriangleMesh& mesh, const Edge& edge);
/// Returns the properties of a body as a JSON object.
nlohmann::json json_of(const std::string& name, const io::TriangleMesh& mesh, const BodyReport& report);

}  // namespace crumple::checks
