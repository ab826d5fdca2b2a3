#pragma once

// Lists of overlaps of bodies, in one configuration (a pose for each body) or in many.
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

/// Description of a number or vector of each row, with the name of the member of Overlaps that has it.
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

/// Numbers of each region, with the name of the member of Overlaps that has it.
inline constexpr std::array<OverlapQuantity, 7> region_quantities{{
    {"region_volume", 1},
    {"region_centroid", 3, true},
    {"region_area_vector", 3},
    {"region_normal", 3, true},
    {"region_mean_depth", 1, true},
    {"region_thickness", 1, true},
    {"region_box", 6, true},
}};
inline constexpr std::size_t region_number_count = 18;

/// Region of a row of a list of overlaps.
struct OverlapListRegion {
    std::int32_t row;                                   ///< OverlapListRow::place of its row
    std::array<double, region_number_count> numbers{};  ///< the quantities, one after the other

    double volume() const { return numbers[0]; }
    double thickness() const { return numbers[11]; }
    std::span<const double, 3> low() const { return std::span<const double, 3>(&numbers[12], 3); }
    std::span<const double, 3> high() const { return std::span<const double, 3>(&numbers[15], 3); }
};

/// Row of a list of overlaps.
struct OverlapListRow {
    std::int32_t configuration = 0;
    BodyPair bodies{0, 0};  ///< indices within one configuration
    OverlapRelation relation = OverlapRelation::touching;
    std::array<double, overlap_number_count> numbers{};  ///< the quantities, one after the other
    std::int32_t place = 0;                              ///< index among the rows of its list

    double volume() const { return numbers[0]; }
    std::array<double, 3> normal() const { return {numbers[7], numbers[8], numbers[9]}; }
    double mean_depth() const { return numbers[10]; }
    double contact_area() const { return numbers[17]; }
};

struct OverlapList {
    bool has_configurations = false;
    bool has_numbers = true;
    std::vector<OverlapListRow> rows = {};
    // If requested; in .json and .npz only:
    bool has_regions = false;
    std::vector<OverlapListRegion> regions = {};               ///< by row
    double depth_tolerance = 0;                                ///< tolerance of the depths; 0 if there are none
    std::vector<double> depth_reached = {}, depth_bound = {};  ///< by row
    std::vector<double> directions = {};                       ///< directions of withdrawals, three numbers each
    bool has_first_free = false;
    std::vector<double> withdrawals = {}, first_free = {};  ///< by row and direction

    /// Adds the rows of `overlaps`, found in one search of several worlds that have `bodies` bodies each. World w
    /// becomes configuration `first_configuration` + w.
    void add(const Overlaps& overlaps, std::int32_t bodies, std::int32_t first_configuration);

    /// Returns the regions of a row.
    std::span<const OverlapListRegion> regions_of(const OverlapListRow& row) const;

   private:
    /// Adds region r of all regions of `overlaps`; `row`: index of its row in `rows`.
    void add_region(const Overlaps& overlaps, std::int64_t r, std::int32_t row);
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

/// Reads a list written by write_overlaps. `names`: names of the bodies. `has_configurations`: true if the list must
/// have configurations. Throws Error (file, format), which names the place in the file, for example if no body has a
/// name of the list, or if only some of the quantities are present.
OverlapList read_overlaps(const std::filesystem::path& path, std::span<const std::string> names,
                          bool has_configurations);
/// Reads a stream to its end. `name` is for messages, and its extension selects the format.
OverlapList read_overlaps(std::istream& in, const std::string& name, std::span<const std::string> names,
                          bool has_configurations);

}  // namespace crumple::io
