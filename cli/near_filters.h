#pragma once

// Options of crumple near besides a single radius: radii of vertices, adjacency along edges, a rest shape.

#include <string>
#include <vector>

#include "cli/search.h"
#include "crumple/proximities.h"

namespace crumple::cli {

struct NearFilterOptions {
    std::string radii, rest;  ///< files, or empty
    double rest_radius = 0;
    std::int32_t rings = 0;

    /// Returns the files that are read; empty names for absent ones.
    std::vector<std::string> files() const;
};
/// Adds `--radii`, `--rest`, `--rest-radius` and `--rings`.
void add_near_filter_options(CLI::App& app, NearFilterOptions& options);

/// Contents of the files of these options, to which queries refer.
class NearFilters {
   public:
    /// Reads the files, which must match the input. The input is not changed. Throws Error that names the file and the
    /// place, or the options.
    NearFilters(const NearFilterOptions& options, Input& input, const QueryOptions& query_options);

    void apply(ProximityQuery& query) const;

   private:
    const NearFilterOptions& options_;
    std::vector<double> radii_;
    io::TriangleMesh rest_;
};

}  // namespace crumple::cli
