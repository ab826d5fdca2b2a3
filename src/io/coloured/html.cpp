// Writes a page that shows the meshes in WebGL (viewer.html), with colliding triangles and contacts coloured. The page
// needs no package and no network. It stores the coordinates of three corners per triangle, without vertex indices:
// each triangle has its own colour, and WebGL 1 has no 32-bit indices without an extension.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <utility>

#include "base/float_environment.h"
#include "crumple/io.h"
#include "io/bytes/grouped.h"
#include "io/bytes/sink.h"
#include "io/formats.h"
#include "io/lists/pairs.h"
#include "io/meshes/polygons.h"

namespace crumple::io {
namespace {

#include "viewer_html.h"

constexpr std::string_view viewer_page =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>Crumple</title>"
    "<style>body { margin: 0; }</style></head>\n";

using Point = std::array<double, 3>;

struct PageMesh {
    const TriangleMesh* mesh;
    std::vector<std::uint8_t> hit;  ///< per triangle: 0, or 1 if it has the material `colliding`
    Material free, colliding;

    const Material& material(std::size_t triangle) const { return hit[triangle] ? colliding : free; }
};

/// Colours as in other formats, with names as in the page's legend. Free triangles of a second mesh are bluish, to
/// distinguish it from the first.
constexpr Material collides{"collides", colliding_colour};
constexpr Material materials_of_meshes[2][2] = {{{"free", free_colour}, collides},
                                                {{"free", {150, 168, 188}}, collides}};
constexpr Colour contact_colour{20, 20, 20};

/// Contents of a page.
struct Page {
    std::vector<PageMesh> sides;
    std::vector<Point> lines, points;  ///< `lines`: two end points per line; `points`: single points of contact
    std::string caption;
    const char* line_name = "contact";
};

Point corner_of(const TriangleMesh& mesh, std::size_t corner) {
    const auto vertex = 3 * static_cast<std::size_t>(mesh.triangles[corner]);
    return std::visit(
        [&](const auto& xyz) {
            return Point{static_cast<double>(xyz[vertex]), static_cast<double>(xyz[vertex + 1]),
                         static_cast<double>(xyz[vertex + 2])};
        },
        mesh.vertices);
}

/// Encoder of bytes as base64: writes four characters for every three bytes.
class Base64 {
   public:
    explicit Base64(Sink& sink) : sink_(sink) {}

    void byte(std::uint8_t value) {
        bits_ = bits_ << 8 | value;
        if (++count_ == 3) flush(0);
    }
    void number(float value) {
        for (const char c : little_endian(value)) byte(static_cast<std::uint8_t>(c));
    }
    void colour(const Colour& c) {
        byte(c.red);
        byte(c.green);
        byte(c.blue);
    }
    void end() {
        const int missing = (3 - count_) % 3;
        if (missing == 0) return;
        for (; count_ < 3; ++count_) bits_ <<= 8;
        flush(missing);
    }

   private:
    void flush(int missing) {
        constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (int i = 0; i < 4; ++i) sink_ << (i < 4 - missing ? digits[bits_ >> (18 - 6 * i) & 63] : '=');
        bits_ = 0;
        count_ = 0;
    }

    Sink& sink_;
    std::uint32_t bits_ = 0;
    int count_ = 0;
};

/// Translation and scaling that moves everything drawn into the unit ball. No finite coordinates overflow or underflow:
/// coordinates are halved before they are added, and divided by the extent before they are squared.
class Normalised {
   public:
    explicit Normalised(const std::vector<PageMesh>& sides) {
        Point low, high;
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        for (const PageMesh& side : sides) {
            for (std::size_t i = 0; i < side.mesh->triangles.size(); ++i) {
                const Point p = corner_of(*side.mesh, i);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], p[axis]);
                    high[axis] = std::max(high[axis], p[axis]);
                }
            }
        }
        if (low[0] > high[0]) return;
        Point half;
        double extent = 0, squares = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            centre_[axis] = low[axis] / 2 + high[axis] / 2;
            half[axis] = high[axis] / 2 - low[axis] / 2;
            extent = std::max(extent, half[axis]);
        }
        if (extent == 0) return;
        extent_ = extent;
        for (const double h : half) squares += (h / extent) * (h / extent);
        radius_ = std::sqrt(squares);
    }

    void write(Base64& out, const Point& p) const {
        for (std::size_t axis = 0; axis < 3; ++axis)
            out.number(static_cast<float>((p[axis] - centre_[axis]) / extent_ / radius_));
    }

   private:
    Point centre_{};
    double extent_ = 1, radius_ = 1;
};

/// Writes `before`, then the JSON member `"name": "..."` of the page's data; its value is what `write` encodes as
/// base64.
template <class Write>
void member(Sink& sink, const char* before, const char* name, Write write) {
    sink << before << '"' << name << "\": \"";
    Base64 out(sink);
    write(out);
    out.end();
    sink << '"';
}

/// Calls take(side, corner) for the corners of all triangles: first those of opaque triangles, then the others.
template <class Take>
void for_each_corner(const std::vector<PageMesh>& sides, Take take) {
    for (const bool translucent : {false, true})
        for (const PageMesh& side : sides)
            for (std::size_t i = 0; i < side.mesh->triangles.size(); ++i)
                if ((side.material(i / 3).opacity < 1) == translucent) take(side, i);
}

void write_data(Sink& sink, const Page& page) {
    const Normalised normalised(page.sides);
    member(sink, "{", "corners", [&](Base64& out) {
        for_each_corner(page.sides,
                        [&](const PageMesh& side, std::size_t i) { normalised.write(out, corner_of(*side.mesh, i)); });
    });
    std::int64_t opaque = 0;
    double opacity = 1;
    member(sink, ", ", "colours", [&](Base64& out) {
        for_each_corner(page.sides, [&](const PageMesh& side, std::size_t i) {
            const Material& material = side.material(i / 3);
            out.colour(material.colour);
            material.opacity < 1 ? void(opacity = material.opacity) : void(++opaque);
        });
    });
    for (const auto& [name, points] : {std::pair{"lines", &page.lines}, {"points", &page.points}})
        member(sink, ", ", name, [&, all = points](Base64& out) {
            for (const Point& p : *all) normalised.write(out, p);
        });
    member(sink, ", ", "contact", [&](Base64& out) { out.colour(contact_colour); });
    sink << ", \"opaque\": " << opaque << ", \"opacity\": " << opacity << "}";
}

void write_legend(Sink& sink, const Page& page) {
    const auto entry = [&](const Material& material, const std::string& mesh) {
        const Colour& c = material.colour;
        sink << "<span class=\"entry\"><i style=\"background:rgba(" << int{c.red} << ',' << int{c.green} << ','
             << int{c.blue} << ',' << material.opacity << ")\"></i>" << mesh << material.name << "</span>\n";
    };
    for (std::size_t i = 0; i < page.sides.size(); ++i) {
        const std::string mesh = page.sides.size() == 1 ? "" : i == 0 ? "first mesh: " : "second mesh: ";
        entry(page.sides[i].colliding, mesh);
        entry(page.sides[i].free, mesh);
    }
    if (!page.lines.empty() || !page.points.empty()) entry({page.line_name, contact_colour}, "");
}

/// Returns a unique id for the page's root element: a notebook may hold many pages.
std::string unique_name() {
    std::random_device random;
    std::string name = "crumple-";
    for (int i = 0; i < 32; ++i) name += "0123456789abcdef"[random() % 16];
    return name;
}

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

/// Writes a whole page for height 0, else a fragment of a page with this height in pixels.
void write_page(std::ostream& out, const Page& contents, int height) {
    Sink sink(out);
    const std::string name = unique_name();
    std::string_view text = viewer_html;
    const bool page = height == 0;
    if (page) sink << viewer_page;
    while (true) {  // copies the text up to the next @NAME@, and replaces this placeholder
        const std::size_t begin = text.find('@'), end = text.find('@', begin + 1);
        sink << text.substr(0, begin);
        if (begin == text.npos) break;
        const std::string_view key = text.substr(begin + 1, end - begin - 1);
        if (key == "ID") sink << name;
        if (key == "HEIGHT") sink << (page ? std::string("100vh") : std::to_string(height) + "px");
        if (key == "CAPTION") sink << contents.caption;
        if (key == "LEGEND") write_legend(sink, contents);
        if (key == "DATA") write_data(sink, contents);
        text.remove_prefix(end + 1);
    }
    if (page) sink << "</html>\n";
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
