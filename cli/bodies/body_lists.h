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
    std::vector<std::uint8_t> inside = {};  ///< flag per pair: one body lies inside the other; empty unless has_inside
    bool has_inside = false;
    Statistics statistics = {};
};

/// Colliding pairs of bodies in many configurations (a configuration is a pose for each body). Without pairs, only
/// flags that say which configurations collide.
struct ConfigurationList {
    const std::vector<std::string>& names;
    bool has_pairs = true;
    std::vector<std::uint8_t> collides = {};  ///< one flag per configuration
    std::vector<std::size_t> ends = {};       ///< end of each configuration's pairs in `pairs`
    std::vector<BodyPair> pairs = {};
    std::vector<std::uint8_t> inside = {};  ///< flag per pair, as in a BodyList
    bool has_inside = false;
    double milliseconds = 0;
    const char* verb = "collides";  ///< heading in csv and key in json: "collides" or "overlaps"

    std::int64_t colliding() const;
};

/// Writes a list. txt: two names per line, separated by a tab, quoted by quoted_name(); csv: columns `first,second`;
/// json: an object with `bodies`, `pairs`, `milliseconds`. If the list has_inside, lines of txt end with a tab and
/// "inside" for pairs in which one body lies inside the other, csv has a third column of 1 and 0, and json a list of
/// true and false.
void write_list(std::ostream& out, const BodyList& list, ListFormat format);

/// Writes one row per configuration. txt: number of the configuration, yes or no for a collision, and number of
/// colliding pairs, as in "0 yes 2"; csv: columns `configuration,collides,pairs`, with 1 and 0 for yes and no, and with
/// `verb` as the second heading; json: an object with `bodies`, `configurations`, `milliseconds`. Without has_pairs,
/// the numbers of pairs are missing. If the list has_inside, txt and csv also have a column with the number of pairs in
/// which one body lies inside the other, and json has a list of flags for each configuration.
void write_list(std::ostream& out, const ConfigurationList& list, ListFormat format);

}  // namespace crumple::cli
