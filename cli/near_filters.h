#pragma once

// Options of crumple near beside one radius: radii of vertices, neighbours along edges, a shape at rest.

#include <string>
#include <vector>

#include "cli/search.h"
#include "crumple/proximities.h"

namespace crumple::cli {

struct NearFilterOptions {
    std::string radii, rest;  ///< files, or empty
    double rest_radius = 0;
    std::int32_t rings = 0;

    /// The files that are read.
    std::vector<std::string> files() const;
};
/// `--radii`, `--rest`, `--rest-radius` and `--rings`.
void add_near_filter_options(CLI::App& app, NearFilterOptions& options);

/// Contents of the files of these options, which queries view.
class NearFilters {
   public:
    /// Reads what is to be about this input, which is not changed. Throws Error that names the file and the place, or
    /// the options.
    NearFilters(const NearFilterOptions& options, Input& input, const QueryOptions& query_options);

    void apply(ProximityQuery& query) const;

   private:
    const NearFilterOptions& options_;
    std::vector<double> radii_;
    io::TriangleMesh rest_;
};

}  // namespace crumple::cli
