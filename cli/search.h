#pragma once

// Reads input files and runs queries with the options of the command line.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_options.h"
#include "crumple/detector.h"
#include "crumple/error.h"
#include "io/scenes/body_origins.h"

namespace crumple::cli {

/// One or two meshes to search, with groups if they are requested.
struct InputMeshes {
    std::string name;  ///< names of the files or of the generated frame, for messages
    io::TriangleMesh first;
    std::optional<io::TriangleMesh> second;

    const io::TriangleMesh* second_or_null() const { return second ? &*second : nullptr; }
    std::int64_t triangle_count() const { return first.triangle_count() + (second ? second->triangle_count() : 0); }
};

/// Returns the query for colliding triangles that these options request.
IntersectionQuery query_of(const QueryOptions& query_options);

/// Returns the error with `name` in front of its message.
Error with_name(const std::string& name, const Error& error);

io::ReadOptions read_options(const ReadingOptions& options);

/// Reads a file, or standard input for `-`, and prints warnings. Throws Error that names the file and the place in it.
io::TriangleMesh read_mesh(const std::string& path, const ReadingOptions& options);

/// Converts the second mesh to the unit of the first if they differ, and prints a note about it. `file`, `second_file`:
/// their names, for messages.
void convert_to_one_unit(const std::string& file, io::TriangleMesh& mesh, const std::string& second_file,
                         io::TriangleMesh& second, const ReadingOptions& options);

/// Reads one file or two. Throws Error that names the file and the place.
InputMeshes read_input(const std::vector<std::string>& files, const QueryOptions& options);

/// Returns a generated mesh as input, with the precision and the groups that the options request. Its own groups count
/// as a property named `group`. Throws as read_input does.
InputMeshes generated_input(const std::string& name, io::TriangleMesh mesh, const QueryOptions& options);

/// Mesh at the start of a step, and the same mesh at its end.
struct MovingInput {
    InputMeshes start;
    io::TriangleMesh end;
};

/// Throws Error (invalid_argument) unless the meshes have the same number of vertices and the same faces, lines and
/// points. Equal polygons may be triangulated differently.
void check_same_faces(const InputMeshes& start, const std::string& end_name, const io::TriangleMesh& end);

/// Returns the options for reading the meshes of a step. With --weld, vertices are not welded on reading but by the
/// query, because vertices that coincide in one file need not coincide in the other. Without --weld and --no-weld, each
/// STL file and glTF scene is welded on reading, as usual. Lines and points are read.
QueryOptions reading_of_motion(QueryOptions options);

/// Returns the options, changed so that lines and points of OBJ files are read.
QueryOptions with_lines_and_points(QueryOptions options);

/// Reads both meshes of a step; groups are read from `start` only. Throws Error that names the file and the place in
/// it.
MovingInput read_moving_input(const std::string& start, const std::string& end, const QueryOptions& options);

/// Mesh, and optionally the same mesh at the end of a step.
struct StepOrStatic {
    InputMeshes start;
    std::optional<io::TriangleMesh> end;

    const io::TriangleMesh* end_or_null() const { return end ? &*end : nullptr; }
};
/// Reads both meshes of a step or, if `end` is empty, only the first one, with the same options in either case. Throws
/// as read_moving_input does.
StepOrStatic read_step_or_static(const std::string& start, const std::string& end, const QueryOptions& options);

/// Computes `offsets` and the hit flags of all triangles from `found.pairs`. `second_triangles`: number of triangles of
/// the second mesh; 0 for one mesh.
void index_by_triangle(Intersections& found, std::int64_t triangles, std::int64_t second_triangles);

using io::BodyOrigins;

/// Returns an error about a world with the name of the body that it concerns (io::with_body_name), in words of the
/// command line instead of those of the library.
Error with_origin(const Error& error, const BodyOrigins& origins, std::int64_t first_configuration);

class AllowedThreads;

/// Detector with the options of the command line. If inputs follow each other, each search is warm-started: it begins
/// with the cluster centres of the search before it.
class SearchSession {
   public:
    /// Throws Error (invalid_argument) if options conflict.
    SearchSession(const QueryOptions& query_options, const Options& options);
    ~SearchSession();

    /// Finds colliding triangles. The result is valid until the next call. Throws Error that names the input.
    const Intersections& find(const InputMeshes& input);
    /// True if any triangles collide. Stops at the first pair, except with --part. Throws as find() does.
    bool any(const InputMeshes& input);
    /// Returns the clusters of a search for colliding triangles (Detector::cluster). Throws as find() does.
    Clustering cluster(const InputMeshes& input);
    /// Runs a query about features of one mesh or two. A single mesh moves to `end`, unless that is null; check its
    /// faces with check_same_faces() before. The result is valid until the next call. Throws Error that names the
    /// input.
    template <class Query>
    const typename Query::Result& find(const InputMeshes& input, const Query& query,
                                       const io::TriangleMesh* end = nullptr);
    /// Runs a query, and delivers its result to `take` in blocks, in order. Throws as find() does, and what `take`
    /// throws.
    template <class Query>
    Statistics stream(const InputMeshes& input, const Query& query,
                      FunctionRef<void(const typename Query::Result&)> take, const io::TriangleMesh* end = nullptr);
    Statistics stream(const InputMeshes& input, FunctionRef<void(const Intersections&)> take) {
        return stream(input, query(), take);
    }
    /// Runs a query about bodies. The world has all bodies once for each of one or more configurations. `origins`:
    /// files and names of the bodies of one configuration. `first_configuration`: number of the first configuration in
    /// the world; -1 if there is only one, which messages then do not name. The result is valid until the next call.
    /// Throws Error that names the body that it concerns, with its file and configuration, or else all files.
    template <class Query>
    const typename Query::Result& find(const BodyOrigins& origins, std::int64_t first_configuration, const World& world,
                                       const Query& query);

    /// Prints a warning if pairs may be missing, once in a session.
    void warn_of_losses(const Statistics& statistics);
    Detector& detector() { return detector_; }

   private:
    IntersectionQuery query() const;
    QueryOptions query_options_;
    bool has_warned_ = false;
    std::unique_ptr<AllowedThreads> threads_;
    Detector detector_;
    Intersections of_part_;
};

}  // namespace crumple::cli
