#pragma once

// Lists of colliding pairs, with or without contacts.

#include <array>
#include <span>
#include <string_view>

#include "crumple/intersections.h"
#include "io/lists/list_files.h"

namespace crumple::io {

RowTable pair_rows(bool contacts);
/// Returns the list of the pairs. Throws Error (invalid_argument) unless the contacts fit the pairs.
ListTable table_of(const Intersections& collisions);
/// Writes a row for each pair. `contacts` may be empty.
void add_pairs(RowWriter& writer, std::span<const Pair> pairs, const Contacts& contacts);

inline std::string_view name_of(ContactKind kind) {
    return kind == ContactKind::point ? "point" : kind == ContactKind::segment ? "segment" : "area";
}

inline bool has_contacts(const Intersections& collisions) { return !collisions.contacts.offsets.empty(); }

inline std::span<const std::array<double, 3>> points_of_pair(const Contacts& contacts, std::size_t pair) {
    return contacts.points.span().subspan(
        static_cast<std::size_t>(contacts.offsets[pair]),
        static_cast<std::size_t>(contacts.offsets[pair + 1] - contacts.offsets[pair]));
}

}  // namespace crumple::io
