#pragma once

// Items of a check: what is wrong with a body, and how two bodies or two shells of one body meet.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "checks/body_report.h"
#include "crumple/overlaps.h"

namespace crumple::checks {

enum class ItemKind : std::uint8_t {
    // Kinds about one body or one shell:
    no_triangles,
    hole,
    non_manifold_edges,
    inconsistent_orientation,
    inside_out,
    degenerate_triangles,
    duplicated_triangles,
    self_intersection,  ///< a place where a shell passes through itself
    self_contact,       ///< a place where a shell meets itself, and covers nothing twice
    // Kinds about two bodies, or two shells of one body, in the order of OverlapRelation:
    touching,
    overlapping,
    first_inside,
    second_inside,
    equal,
    undefined,  ///< the surfaces meet, and at least one of them is not closed
    // More kinds about two bodies or shells:
    piercing,   ///< overlapping, and one body passes through the other (Overlaps::region_pieces)
    duplicate,  ///< both bodies have the same triangles
    near,       ///< nearer than the clearance, without meeting
};
inline constexpr std::array<std::string_view, 18> item_kind_names{"no_triangles",
                                                                  "hole",
                                                                  "non_manifold_edges",
                                                                  "inconsistent_orientation",
                                                                  "inside_out",
                                                                  "degenerate_triangles",
                                                                  "duplicated_triangles",
                                                                  "self_intersection",
                                                                  "self_contact",
                                                                  "touching",
                                                                  "overlapping",
                                                                  "first_inside",
                                                                  "second_inside",
                                                                  "equal",
                                                                  "undefined",
                                                                  "piercing",
                                                                  "duplicate",
                                                                  "near"};
constexpr std::string_view name_of(ItemKind kind) { return item_kind_names[static_cast<std::size_t>(kind)]; }
constexpr ItemKind kind_of(OverlapRelation relation) {
    return static_cast<ItemKind>(static_cast<int>(ItemKind::touching) + static_cast<int>(relation));
}

/// Body, or one of its shells.
struct BodyPart {
    std::int32_t body = -1;
    std::int32_t shell = -1;  ///< −1: the whole body
    friend auto operator<=>(const BodyPart&, const BodyPart&) = default;
};

inline constexpr double not_computed = std::numeric_limits<double>::quiet_NaN();

/// Connected region of an overlap (Overlaps::region_offsets), or a connected group of pairs of triangles.
struct ItemPlace {
    Point centre{};  ///< centroid of the region, or the middle of the box
    BoundingBox box{};
    std::int64_t triangles = 0;  ///< triangles of the group; 0 for a region
    double volume = not_computed, mean_depth = not_computed, thickness = not_computed;
    std::array<std::int32_t, 2> pieces{};  ///< Overlaps::region_pieces
};

/// Numbers that do not apply, or were not computed, are NaN.
struct CheckItem {
    ItemKind kind;
    BodyPart first, second = {};  ///< second.body is −1 for items of one body
    bool is_finding = true;       ///< true if it counts for the exit status
    bool is_ignored = false;      ///< true for an overlap that is not deeper than --ignore-below

    std::optional<Point> centre = {};
    std::optional<BoundingBox> box = {};
    std::int64_t count = 0;  ///< number of triangles, or of edges, that it is about
    double volume = not_computed, mean_depth = not_computed, depth_reached = not_computed, depth_bound = not_computed,
           contact_area = not_computed, length = not_computed, clearance = not_computed;
    std::array<std::int32_t, 2> pieces{};  ///< greatest numbers of pieces of any region
    std::array<Point, 2> closest{};        ///< closest points, for items with a clearance
    std::vector<ItemPlace> places = {};
    std::vector<std::int32_t> rows = {};       ///< pairs of triangles that intersect: CheckReport::crossings
    std::vector<std::int32_t> triangles = {};  ///< degenerate or duplicated ones of a body
    std::vector<Edge> edges = {};              ///< open edges of a hole
};

}  // namespace crumple::checks
