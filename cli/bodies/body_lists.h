#pragma once

// Lists of colliding bodies, and of configurations with colliding bodies, as text, CSV and JSON.

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "crumple/intersections.h"
#include "crumple/query.h"
#include "crumple/world.h"

namespace crumple::cli {

enum class ListFormat { txt, csv, json };

/// Pairs of bodies that collide, each once, in order.
struct BodyList {
    const std::vector<std::string>& names;
    std::vector<BodyPair> pairs;
    std::vector<std::uint8_t> inside = {};  ///< 1 per pair, if searched for: one body lies inside the other
    bool has_inside = false;
    Statistics statistics = {};
};

/// Colliding pairs of bodies in many configurations; without pairs, only which configurations collide.
struct ConfigurationList {
    const std::vector<std::string>& names;
    bool has_pairs = true;
    std::vector<std::uint8_t> collides = {};  ///< 1 per configuration
    std::vector<std::size_t> ends = {};       ///< end of each configuration's pairs
    std::vector<BodyPair> pairs = {};
    std::vector<std::uint8_t> inside = {};  ///< as in a BodyList
    bool has_inside = false;
    double milliseconds = 0;
    const char* verb = "collides";  ///< for headings: "collides" or "overlaps"

    std::int64_t colliding() const;
};

/// Writes a list. txt: two names a line, separated by a tab (quoted_name); csv: two columns `first,second`; json: an
/// object with `bodies`, `pairs`, `milliseconds`. If the list has `inside`, txt ends lines of such pairs with a tab and
/// "inside", csv has a column of 1 and 0, json a list of true and false.
void write_list(std::ostream& out, const BodyList& list, ListFormat format);

/// Writes one row per configuration. txt: "0 yes 2": number, yes or no for a collision, number of colliding pairs; csv:
/// columns `configuration,collides,pairs` with 1 and 0; json: an object with `bodies`, `configurations`,
/// `milliseconds`. If the list has `inside`, txt and csv also have a column with the number of such pairs, json a list
/// for each configuration.
void write_list(std::ostream& out, const ConfigurationList& list, ListFormat format);

}  // namespace crumple::cli
