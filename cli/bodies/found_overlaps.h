#pragma once

// Search for overlaps of bodies read from files, and texts about them.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/bodies/body_scene.h"
#include "io/lists/overlap_lists.h"

namespace crumple::cli {

/// Options that change the result of an overlap query.
struct OverlapOptions {
    double min_volume = 0;
    OpenSurfaces open = OpenSurfaces::error;
    bool regions = false;
    double depth_tolerance = 0;
    std::vector<std::array<double, 3>> directions = {};
    bool first_free = false;
    bool self = false;  ///< overlaps of each body with itself, too; implied if there is one body
    BodyOptions bodies;
};
/// Adds options for further numbers to a command that writes rows. `verify` reads in the list which ones it has.
void add_overlap_parts(CLI::App& app, OverlapOptions& options);
/// Adds these options to a command and returns them. `condition`: prefix of the help of each option.
std::vector<const CLI::Option*> add_overlap_options(CLI::App& app, OverlapOptions& options,
                                                    const std::string& condition);

/// Result of an OverlapQuery, in one configuration or in many.
struct FoundOverlaps {
    bool any = false;
    io::OverlapList list;                    ///< filled for Output::body_pairs and larger outputs
    std::vector<std::uint8_t> has_overlaps;  ///< flag per configuration; empty for Output::any
    Statistics statistics;                   ///< sums over all configurations
};
/// Finds the overlaps. Throws Error if the world has no body, and as SearchSession::find() does.
FoundOverlaps find_overlaps(SearchSession& search, const BodyScene& scene, const OverlapOptions& options,
                            Output output);
/// Returns the query for the one configuration of the files. Throws Error if the world has no body.
OverlapQuery overlap_query(const BodyScene& scene, const OverlapOptions& options, Output output);
/// Returns the result of such a query that has been found elsewhere, and prints which bodies were skipped.
FoundOverlaps found_of(const Overlaps& overlaps, const BodyScene& scene, const OverlapOptions& options, Output output);

/// Writes a sentence for each row: "lid and pot overlap: volume 0.5 mm^3, mean depth 0.1 mm, normal (0 0 1)".
/// Below it, lines for depths, withdrawals and regions, if the list has them.
void write_text(std::ostream& out, const io::OverlapList& list, const io::OverlapBodies& bodies);

/// Returns "2 pairs of bodies (1 touching, 1 overlapping), 3 of 5 bodies, 1.2 ms", or "nothing overlaps: 5 bodies, 1.2
/// ms"; for bodies with themselves "1 body overlaps itself", or "the body does not overlap itself".
std::string summary_of(const FoundOverlaps& found, std::size_t bodies);
/// Returns the counts by relation: "1 touching, 1 overlapping".
std::string relations_of(const io::OverlapList& list);

}  // namespace crumple::cli
