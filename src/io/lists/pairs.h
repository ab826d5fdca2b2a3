#pragma once

// What writers, and what readers of pairs have in common.

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "crumple/intersections.h"
#include "crumple/io.h"

namespace crumple::io {

/// .txt and .csv in pieces that somebody else puts one behind the other: what stands before the rows, and rows.
void write_heading_of_pairs(std::ostream& out, bool contacts, PairFormat format);
void write_rows_of_pairs(std::ostream& out, const Intersections& block, PairFormat format);

inline std::string_view name_of(ContactKind kind) {
    return kind == ContactKind::point ? "point" : kind == ContactKind::segment ? "segment" : "area";
}

inline bool has_contacts(const Intersections& collisions) { return !collisions.contacts.offsets.empty(); }

inline std::span<const std::array<double, 3>> points_of_pair(const Intersections& collisions, std::size_t pair) {
    const Contacts& contacts = collisions.contacts;
    return contacts.points.span().subspan(
        static_cast<std::size_t>(contacts.offsets[pair]),
        static_cast<std::size_t>(contacts.offsets[pair + 1] - contacts.offsets[pair]));
}

/// The index of a triangle, or nothing: ids are int32 and not negative.
template <class Integer>
std::optional<std::int32_t> triangle_index(Integer value) {
    if (!std::in_range<std::int32_t>(value) || value < 0) return std::nullopt;
    return static_cast<std::int32_t>(value);
}

}  // namespace crumple::io
