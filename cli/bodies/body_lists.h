#pragma once

// Bodies that collide, and configurations in which bodies do, as text, CSV and JSON.

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "crumple/query.h"
#include "crumple/world.h"

namespace crumple::cli {

enum class ListFormat { txt, csv, json };

/// Pairs of bodies that collide, each once, in order.
struct BodyList {
    const std::vector<std::string>& names;
    std::vector<BodyPair> pairs;
    std::vector<std::uint8_t> inside = {};  ///< one a pair, if that was searched for: one body lies inside the other
    bool has_inside = false;
    Statistics statistics = {};
};

/// The same for many configurations. Without pairs it is only known which of them collide.
struct ConfigurationList {
    const std::vector<std::string>& names;
    bool has_pairs = true;
    std::vector<std::uint8_t> collides = {};  ///< one a configuration
    std::vector<std::size_t> ends = {};       ///< of its pairs, in `pairs`
    std::vector<BodyPair> pairs = {};
    std::vector<std::uint8_t> inside = {};  ///< as in a BodyList
    bool has_inside = false;
    double milliseconds = 0;
    const char* verb = "collides";  ///< what configurations do, for headings

    std::int64_t colliding() const;
};

/// txt: two names a line, with a tab between (quoted_name); csv: the same under `first,second`; json: an object of
/// `bodies`, `pairs`, `milliseconds`. With `inside` such lines of txt end with a tab and "inside", csv has a column of
/// 1 and 0, json a list of true and false.
void write_list(std::ostream& out, const BodyList& list, ListFormat format);

/// A row a configuration. txt: "0 yes 2", its number, whether anything collides, how many pairs of bodies do; csv: the
/// same under `configuration,collides,pairs` with 1 and 0; json: an object of `bodies`, `configurations`,
/// `milliseconds`. With `inside` txt and csv also have a column of how many pairs are such, json a list for each
/// configuration.
void write_list(std::ostream& out, const ConfigurationList& list, ListFormat format);

}  // namespace crumple::cli
