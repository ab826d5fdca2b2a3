#pragma once

// Options of crumple near and crumple verify besides a single radius: a radius for each vertex (--radii), a wider
// adjacency, counted in edges (--rings), and a rest shape, whose near pairs are left out (--rest).

#include <string>
#include <vector>

#include "cli/search.h"
#include "crumple/proximities.h"

namespace crumple::cli {

struct NearFilterOptions {
    std::string radii, rest;  ///< paths of files; empty if the option is absent
    double rest_radius = 0;
    std::int32_t rings = 0;

    /// Returns the names of the two files that are read; a name is empty if its option is absent.
    std::vector<std::string> files() const;
};
/// Adds `--radii`, `--rest`, `--rest-radius` and `--rings`. Returns those that limit the pairs: all but `--radii`.
std::vector<const CLI::Option*> add_near_filter_options(CLI::App& app, NearFilterOptions& options);

/// Returns how the input of a near query with these options is read.
QueryOptions near_reading(const NearFilterOptions& options, const QueryOptions& query_options);

/// Contents of the files that these options name. Queries refer to this object, which must outlive them.
class NearFilters {
   public:
    /// Reads the files, which must match the input. The input is not changed. Throws Error that names the file and the
    /// place in it, or the options that conflict.
    NearFilters(const NearFilterOptions& options, InputMeshes& input, const QueryOptions& query_options);

    void apply(ProximityQuery& query) const;

   private:
    const NearFilterOptions& options_;
    std::vector<double> radii_;
    io::TriangleMesh rest_;
};

}  // namespace crumple::cli
