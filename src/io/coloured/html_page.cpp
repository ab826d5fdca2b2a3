#include "io/coloured/html_page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "io/bytes/json.h"
#include "io/bytes/sink.h"

namespace crumple::io {
namespace {

#include "places_html.h"
#include "viewer_html.h"

constexpr std::string_view viewer_page =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>Crumple</title>"
    "<style>body { margin: 0; }</style></head>\n";
constexpr Colour contact_colour{20, 20, 20};

PagePoint vertex_of(const TriangleMesh& mesh, std::int32_t index) {
    const auto vertex = 3 * static_cast<std::size_t>(index);
    return std::visit(
        [&](const auto& xyz) {
            return PagePoint{static_cast<double>(xyz[vertex]), static_cast<double>(xyz[vertex + 1]),
                             static_cast<double>(xyz[vertex + 2])};
        },
        mesh.vertices);
}
PagePoint corner_of(const TriangleMesh& mesh, std::size_t corner) { return vertex_of(mesh, mesh.triangles[corner]); }

/// Encoder of bytes as base64: writes four characters for every three bytes.
class Base64 {
   public:
    explicit Base64(Sink& sink) : sink_(sink) {}

    void byte(std::uint8_t value) {
        bits_ = bits_ << 8 | value;
        if (++count_ == 3) flush(0);
    }
    template <class Number>
    void number(Number value) {
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
        PagePoint low, high;
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        for (const PageMesh& side : sides) {
            for (std::size_t i = 0; i < side.mesh->triangles.size(); ++i) {
                const PagePoint p = corner_of(*side.mesh, i);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], p[axis]);
                    high[axis] = std::max(high[axis], p[axis]);
                }
            }
        }
        if (low[0] > high[0]) return;
        PagePoint half;
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

    std::array<float, 3> operator()(const PagePoint& p) const {
        std::array<float, 3> result{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            result[axis] = static_cast<float>((p[axis] - centre_[axis]) / extent_ / radius_);
        return result;
    }
    void write(Base64& out, const PagePoint& p) const {
        for (const float x : (*this)(p)) out.number(x);
    }
    /// Returns the length that becomes 1; 0 if it overflows.
    double unit_length() const { return std::isfinite(extent_ * radius_) ? extent_ * radius_ : 0; }

   private:
    PagePoint centre_{};
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

/// Writes the meshes, drawings and items of a report, as arrays and as a JSON object that refers to them.
class ReportWriter {
   public:
    ReportWriter(Sink& sink, const Page& page, const Normalised& normalised)
        : sink_(sink), page_(page), report_(*page.report), normalised_(normalised) {}

    /// Writes `vertices` and `triangles`; indices count the vertices of all bodies.
    void write_meshes(const char* before) {
        member(sink_, before, "vertices", [&](Base64& out) {
            for (const PageMesh& side : page_.sides)
                for (std::int32_t v = 0; v < side.mesh->vertex_count(); ++v)
                    normalised_.write(out, vertex_of(*side.mesh, v));
        });
        member(sink_, ", ", "triangles", [&](Base64& out) {
            std::int32_t first = 0;
            for (const PageMesh& side : page_.sides) {
                for (const std::int32_t corner : side.mesh->triangles) out.number(first + corner);
                first += static_cast<std::int32_t>(side.mesh->vertex_count());
            }
        });
    }

    void write() {
        member(sink_, ", ", "contact_triangles", [&](Base64& out) {
            for (const PageReport::Drawing& drawing : report_.drawings)
                for (const PageReport::Contact& contact : drawing.contacts)
                    for (const std::int32_t triangle : contact.triangles) out.number(triangle);
        });
        member(sink_, ", ", "contact_segments", [&](Base64& out) {
            for (const PageReport::Drawing& drawing : report_.drawings)
                for (const PageReport::Contact& contact : drawing.contacts)
                    for (const PagePoint& p : contact.segment) normalised_.write(out, p);
        });
        member(sink_, ", ", "drawn_lines", [&](Base64& out) { write_points(out, &PageReport::Drawing::lines); });
        member(sink_, ", ", "drawn_areas", [&](Base64& out) { write_points(out, &PageReport::Drawing::areas); });
        const Json report{{"title", valid_utf8(report_.title)},
                          {"summary", valid_utf8(report_.summary)},
                          {"bodies", bodies()},
                          {"drawings", drawings()},
                          {"items", items()}};
        std::string text = report.dump();
        // A name must not end the script that contains it.
        for (std::size_t at = 0; (at = text.find('<', at)) != text.npos;) text.replace(at, 1, "\\u003c");
        sink_ << ", \"report\": " << text;
    }

   private:
    using Json = nlohmann::ordered_json;

    template <class List>
    void write_points(Base64& out, List list) const {
        for (const PageReport::Drawing& drawing : report_.drawings)
            for (const auto& points : drawing.*list)
                for (const PagePoint& p : points) normalised_.write(out, p);
    }

    Json bodies() const {
        Json bodies = Json::array();
        std::size_t corner = 0;
        for (std::size_t b = 0; b < report_.bodies.size(); ++b) {
            const PageReport::Body& body = report_.bodies[b];
            const std::size_t corners = page_.sides[b].mesh->triangles.size();
            const auto [red, green, blue] = page_.sides[b].free.colour;
            bodies.push_back({{"name", valid_utf8(body.name)},
                              {"text", valid_utf8(body.text)},
                              {"finding", body.has_findings},
                              {"colour", {red / 255.0, green / 255.0, blue / 255.0}},
                              {"corners", {corner, corners}}});
            corner += corners;
        }
        return bodies;
    }

    Json drawings() const {
        Json drawings = Json::array();
        std::size_t contact = 0, line = 0, area = 0;
        for (const PageReport::Drawing& drawing : report_.drawings) {
            drawings.push_back({{"bodies", drawing.bodies},
                                {"contacts", {contact, drawing.contacts.size()}},
                                {"lines", {line, 2 * drawing.lines.size()}},
                                {"areas", {area, 3 * drawing.areas.size()}}});
            contact += drawing.contacts.size();
            line += 2 * drawing.lines.size();
            area += 3 * drawing.areas.size();
        }
        return drawings;
    }

    Json items() const {
        Json items = Json::array();
        for (const PageReport::Item& item : report_.items) {
            Json json{{"text", valid_utf8(item.text)}, {"bodies", item.bodies}, {"finding", item.is_finding}};
            if (item.box) json["box"] = {normalised_((*item.box)[0]), normalised_((*item.box)[1])};
            items.push_back(std::move(json));
        }
        return items;
    }

    Sink& sink_;
    const Page& page_;
    const PageReport& report_;
    const Normalised& normalised_;
};

/// Writes the corners of all triangles and their colours. Counts the opaque corners, and sets `opacity` to that of the
/// others.
void write_corners(Sink& sink, const Page& page, const Normalised& normalised, std::int64_t& opaque, double& opacity) {
    member(sink, "{", "corners", [&](Base64& out) {
        for_each_corner(page.sides,
                        [&](const PageMesh& side, std::size_t i) { normalised.write(out, corner_of(*side.mesh, i)); });
    });
    member(sink, ", ", "colours", [&](Base64& out) {
        for_each_corner(page.sides, [&](const PageMesh& side, std::size_t i) {
            const Material& material = side.material(i / 3);
            out.colour(material.colour);
            material.opacity < 1 ? void(opacity = material.opacity) : void(++opaque);
        });
    });
}

void write_data(Sink& sink, const Page& page) {
    const Normalised normalised(page.sides);
    std::int64_t opaque = 0;
    double opacity = 1;
    if (page.report)
        ReportWriter(sink, page, normalised).write_meshes("{");
    else
        write_corners(sink, page, normalised, opaque, opacity);
    for (const auto& [name, points] : {std::pair{"lines", &page.lines}, {"points", &page.points}})
        member(sink, ", ", name, [&, all = points](Base64& out) {
            for (const PagePoint& p : *all) normalised.write(out, p);
        });
    member(sink, ", ", "contact", [&](Base64& out) { out.colour(contact_colour); });
    const Unit unit = page.sides.empty() ? Unit::unknown : page.sides[0].mesh->unit;
    sink << ", \"length\": " << normalised.unit_length() << ", \"unit\": \""
         << (unit == Unit::unknown ? "" : name_of(unit)) << '"';
    if (page.report) ReportWriter(sink, page, normalised).write();
    sink << ", \"opaque\": " << opaque << ", \"opacity\": " << opacity << "}";
}

void write_legend(Sink& sink, const Page& page) {
    const auto entry = [&](const Material& material, const std::string& mesh) {
        const Colour& c = material.colour;
        sink << "<span class=\"entry\"><i style=\"background:rgba(" << int{c.red} << ',' << int{c.green} << ','
             << int{c.blue} << ',' << material.opacity << ")\"></i>" << mesh << material.name << "</span>\n";
    };
    for (std::size_t i = 0; i < page.sides.size() && !page.report; ++i) {
        if (!page.sides[i].palette.empty()) {
            for (const Material& material : page.sides[i].palette.first(page.sides[i].named)) entry(material, "");
            continue;
        }
        const std::string mesh = page.sides.size() == 1 ? "" : i == 0 ? "first mesh: " : "second mesh: ";
        entry(page.sides[i].colliding, mesh);
        entry(page.sides[i].free, mesh);
    }
    if (page.report) entry({"near a place", colliding_colour}, "");
    if (!page.lines.empty() || !page.points.empty()) entry({page.line_name, contact_colour}, "");
}

/// Returns a unique id for the page's root element: a notebook may hold many pages.
std::string unique_name() {
    std::random_device random;
    std::string name = "crumple-";
    for (int i = 0; i < 32; ++i) name += "0123456789abcdef"[random() % 16];
    return name;
}

/// Writes the text, with a value instead of each @NAME@.
void write_template(Sink& sink, std::string_view text, const Page& page, const std::string& id, int height) {
    while (true) {
        const std::size_t begin = text.find('@'), end = text.find('@', begin + 1);
        sink << text.substr(0, begin);
        if (begin == text.npos) break;
        const std::string_view key = text.substr(begin + 1, end - begin - 1);
        if (key == "ID") sink << id;
        if (key == "HEIGHT") sink << (height == 0 ? std::string("100vh") : std::to_string(height) + "px");
        if (key == "CAPTION") sink << page.caption;
        if (key == "LEGEND") write_legend(sink, page);
        if (key == "DATA") write_data(sink, page);
        if (key == "PLACES" && page.report) write_template(sink, places_html, page, id, height);
        text.remove_prefix(end + 1);
    }
}

}  // namespace

void write_page(std::ostream& out, const Page& contents, int height) {
    Sink sink(out);
    if (height == 0) sink << viewer_page;
    write_template(sink, viewer_html, contents, unique_name(), height);
    if (height == 0) sink << "</html>\n";
}

}  // namespace crumple::io
