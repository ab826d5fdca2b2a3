#pragma once

// Page that shows meshes in WebGL (viewer.html). It needs no package and no network.
//
// A page stores the coordinates of three corners per triangle, without vertex indices: each triangle has its own
// colour, and WebGL 1 has no 32-bit indices without an extension.

#include <array>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "crumple/io.h"
#include "io/formats.h"

namespace crumple::io {

using PagePoint = std::array<double, 3>;
using PageSegment = std::array<PagePoint, 2>;

struct PageMesh {
    const TriangleMesh* mesh;
    std::vector<std::uint8_t> hit;  ///< per triangle: 0, or 1 if it has the material `colliding`; empty: all are free
    Material free, colliding;
    std::span<const Material> palette = {};  ///< if not empty: the materials that `hit` indexes, instead of these two
    std::size_t named = 0;                   ///< number of materials of the palette that the legend lists

    const Material& material(std::size_t triangle) const {
        if (!palette.empty()) return palette[hit[triangle]];
        return !hit.empty() && hit[triangle] ? colliding : free;
    }
};

/// List of places that a page shows beside the meshes; clicking one of them moves the view to it.
struct PageReport {
    struct Body {
        std::string name, text;
        bool has_findings = false;
    };
    /// Segment in which two triangles meet, a triangle of each body: both are coloured near it.
    struct Contact {
        std::array<std::int32_t, 2> triangles;
        PageSegment segment;
    };
    /// Contacts of two bodies, which may be the same; and lines and triangles that are drawn over the surfaces if both
    /// bodies are shown.
    struct Drawing {
        std::array<std::int32_t, 2> bodies;
        std::vector<Contact> contacts = {};
        std::vector<PageSegment> lines = {};
        std::vector<std::array<PagePoint, 3>> areas = {};
    };
    struct Item {
        std::string text;
        std::array<std::int32_t, 2> bodies;   ///< which may be the same
        std::optional<PageSegment> box = {};  ///< low and high corner
        bool is_finding = true;
    };

    std::string title, summary;
    std::vector<Body> bodies;  ///< one per mesh of the page
    std::vector<Drawing> drawings;
    std::vector<Item> items;
};

/// Contents of a page.
struct Page {
    std::vector<PageMesh> sides;
    std::vector<PagePoint> lines, points;  ///< `lines`: two end points per line; `points`: single points of contact
    std::string caption;
    const char* line_name = "contact";
    std::optional<PageReport> report = {};
};

/// Writes a whole page for height 0, else a fragment of a page with this height in pixels.
void write_page(std::ostream& out, const Page& contents, int height);

}  // namespace crumple::io
