#include "cli/near_filters.h"

#include <limits>

#include "cli/bodies_of_files.h"
#include "crumple/error.h"
#include "io/bytes/text.h"

namespace crumple::cli {
namespace {

/// Reads one radius per line, for each vertex; skips blank lines and comments (#). Throws Error (file, format) that
/// names the line.
std::vector<double> read_radii(const std::string& path, std::int64_t vertices) {
    const io::Source source(path);
    io::Scanner in(source, {.lines = true, .comments = true});
    std::vector<double> radii;
    for (; in.next_line_with_items(); in.skip_line()) {
        const char* const line = in.position();
        const std::string word(in.word());
        const auto radius = io::number_of(word);
        if (!radius || !(*radius >= 0 && *radius < std::numeric_limits<double>::infinity()))
            source.fail_at_line(line, io::in_quotes(word) + " is not a radius of 0 or more");
        if (!in.finished()) in.fail("each line must have only one radius, that of a vertex");
        radii.push_back(*radius);
    }
    if (static_cast<std::int64_t>(radii.size()) != vertices)
        throw Error(ErrorCode::format, path + ": " + std::to_string(radii.size()) + " radii for " +
                                           std::to_string(vertices) + " vertices");
    return radii;
}

}  // namespace

std::vector<std::string> NearFilterOptions::files() const { return {radii, rest}; }

std::vector<const CLI::Option*> add_near_filter_options(CLI::App& app, NearFilterOptions& options) {
    app.add_option("--radii", options.radii,
                   "Instead of --radius: a file with a radius for each vertex, one per line. The radius of an edge or "
                   "a face is the largest of its vertices' radii. Features are near if their distance is at most the "
                   "sum of both radii")
        ->type_name("FILE");
    CLI::Option* const rings =
        app.add_option("--rings", options.rings,
                       "Leave out neighbours: features that a path of at most N edges joins, from a vertex of one to a "
                       "vertex of the other. 0, the default: features with a common vertex")
            ->type_name("N")
            ->check(integer(0, std::numeric_limits<std::int32_t>::max()));
    CLI::Option* const rest =
        app.add_option("--rest", options.rest,
                       "The rest shape of the mesh, with the same triangles: features within --rest-radius of each "
                       "other there are left out")
            ->type_name("FILE");
    CLI::Option* const rest_radius =
        add_number_option(
            app, "--rest-radius", [&options](double value) { options.rest_radius = value; }, any_distance,
            "Radius for --rest; 0, the default: features that touch in the rest shape")
            ->type_name("R");
    return {rings, rest, rest_radius};
}

QueryOptions near_reading(const NearFilterOptions& options, const QueryOptions& query_options) {
    return with_lines_and_points(options.rest.empty() ? query_options : reading_of_motion(query_options));
}

NearFilters::NearFilters(const NearFilterOptions& options, InputMeshes& input, const QueryOptions& query_options)
    : options_(options) {
    if (options.rest.empty() && options.rest_radius > 0) refuse("--rest-radius needs --rest");
    if (input.second && !options.radii.empty()) refuse("--radii does not support two meshes");
    if (input.second && !options.rest.empty()) refuse("--rest does not support two meshes");
    if (!options.radii.empty()) radii_ = read_radii(options.radii, input.first.vertex_count());
    if (options.rest.empty()) return;
    rest_ = read_mesh(options.rest, query_options);
    convert_to_one_unit(input.name, input.first, options.rest, rest_, query_options);
    check_same_faces(input, options.rest, rest_);
}

void NearFilters::apply(ProximityQuery& query) const {
    query.radii = radii_;
    query.rings = options_.rings;
    if (options_.rest.empty()) return;
    query.rest = rest_.view().vertices;
    query.rest_radius = options_.rest_radius;
}

}  // namespace crumple::cli
