// Pages with colliding triangles and contacts coloured, and with overlaps.

#include <sstream>
#include <utility>

#include "base/float_environment.h"
#include "crumple/io.h"
#include "io/bytes/grouped.h"
#include "io/coloured/html_page.h"
#include "io/formats.h"
#include "io/lists/pairs.h"
#include "io/meshes/polygons.h"

namespace crumple::io {
namespace {

/// Colours as in other formats, with names as in the page's legend. Free triangles of a second mesh are bluish, to
/// distinguish it from the first.
constexpr Material collides{"collides", colliding_colour};
constexpr Material materials_of_meshes[2][2] = {{{"free", free_colour}, collides},
                                                {{"free", {150, 168, 188}}, collides}};

void add_contacts(const Intersections& collisions, Page& page) {
    if (!has_contacts(collisions)) return;
    for (std::size_t i = 0; i < collisions.pairs.size(); ++i) {
        const auto points = points_of_pair(collisions.contacts, i);
        if (points.size() == 1) page.points.push_back(points[0]);
        const std::size_t lines = points.size() < 3 ? points.size() - 1 : points.size();  // an area's outline is closed
        for (std::size_t k = 0; k < lines; ++k)
            page.lines.insert(page.lines.end(), {points[k], points[(k + 1) % points.size()]});
    }
}

}  // namespace

void write_html(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                const Intersections& collisions, int height) {
    Page page;
    const auto& [of_first, of_second] = materials_of_meshes;
    page.sides.push_back({&mesh, hit_triangles(mesh, collisions.hit), of_first[0], of_first[1]});
    if (second)
        page.sides.push_back({second, hit_triangles(*second, collisions.hit_second), of_second[0], of_second[1]});
    std::size_t triangles = 0;
    for (const PageMesh& side : page.sides) triangles += side.hit.size();
    const std::size_t faces = collisions.hit.size() + (second ? collisions.hit_second.size() : 0);
    page.caption = grouped(static_cast<std::int64_t>(collisions.pairs.size())) + " colliding pairs of " +
                   grouped(static_cast<std::int64_t>(faces)) + (faces == triangles ? " triangles" : " polygons");
    add_contacts(collisions, page);
    write_page(out, page, height);
}

void write_overlap_html(std::ostream& out, const ColouredMesh& coloured, std::vector<std::array<double, 3>> lines,
                        const std::string& caption) {
    Page page;
    PageMesh side{&coloured.mesh, coloured.hit, coloured.materials[0], coloured.materials[1]};
    side.colliding.name = "inside another body";
    page.sides.push_back(std::move(side));
    page.lines = std::move(lines);
    page.caption = caption;
    page.line_name = "crossing of surfaces";
    write_page(out, page, 0);
}

std::string to_html(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions, int height) {
    const FloatEnvironment environment;
    if (height < 1) throw Error(ErrorCode::invalid_argument, "height must be at least 1 pixel", Element::option);
    check_collisions(mesh, second, collisions);
    std::ostringstream out;
    write_html(out, mesh, second, collisions, height);
    return std::move(out).str();
}

}  // namespace crumple::io
