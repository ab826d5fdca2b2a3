#pragma once

// Lists of overlaps of bodies, in one configuration of them or in many.
//
//     columns of .csv   [configuration,] first, second, relation, volume, centroid_x, centroid_y, centroid_z, ...
//     arrays            [configuration,] bodies, relation, volume, centroid, ...: as in Python

#include <array>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "crumple/io.h"
#include "crumple/overlaps.h"

namespace crumple::io {

/// Name of a relation in files: "first_inside".
std::string_view name_of(OverlapRelation relation);

/// Number or vector of a row, named as in Overlaps.
struct OverlapQuantity {
    std::string_view name;
    std::size_t width;
    bool may_be_nan = false;
};
inline constexpr std::array<OverlapQuantity, 8> overlap_quantities{{
    {"volume", 1},
    {"centroid", 3, true},
    {"area_vector", 3},
    {"normal", 3, true},
    {"mean_depth", 1, true},
    {"torque", 3},
    {"torque_point", 3},
    {"contact_area", 1},
}};
inline constexpr std::size_t overlap_number_count = [] {
    std::size_t count = 0;
    for (const OverlapQuantity& quantity : overlap_quantities) count += quantity.width;
    return count;
}();

/// Row of a list of overlaps.
struct OverlapListRow {
    std::int32_t configuration = 0;
    BodyPair bodies{0, 0};  ///< indices within one configuration
    OverlapRelation relation = OverlapRelation::touching;
    std::array<double, overlap_number_count> numbers{};  ///< the quantities, one after the other

    double volume() const { return numbers[0]; }
    std::array<double, 3> normal() const { return {numbers[7], numbers[8], numbers[9]}; }
    double mean_depth() const { return numbers[10]; }
    double contact_area() const { return numbers[17]; }
};

struct OverlapList {
    bool has_configurations = false;
    bool has_numbers = true;
    std::vector<OverlapListRow> rows = {};

    /// Adds the rows of worlds of `bodies` bodies each. The first world is configuration `first_configuration`.
    void add(const Overlaps& overlaps, std::int32_t bodies, std::int32_t first_configuration);
};

/// Properties of bodies that are written to files.
struct OverlapBodies {
    std::span<const std::string> names;
    Unit unit = Unit::unknown;
};

/// Writes a list as .csv, .json or .npz. A quantity that a row lacks is an empty cell in .csv, null in .json, NaN in
/// .npz. Throws Error (file, invalid_argument).
void write_overlaps(const std::filesystem::path& path, const OverlapList& list, const OverlapBodies& bodies,
                    const Statistics& statistics);
void write_overlaps(std::ostream& out, const OverlapList& list, const OverlapBodies& bodies,
                    const Statistics& statistics, PairFormat format);

/// Reads such a list. Throws Error (file, format) that names the place, for example of a name that no body has, or if
/// only some of the quantities are present. `has_configurations`: true if the list must have configurations.
OverlapList read_overlaps(const std::filesystem::path& path, std::span<const std::string> names,
                          bool has_configurations);
/// Reads a stream to its end. `name` is for messages, and its extension selects the format.
OverlapList read_overlaps(std::istream& in, const std::string& name, std::span<const std::string> names,
                          bool has_configurations);

}  // namespace crumple::io
