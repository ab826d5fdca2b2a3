#pragma once

// Reads input files and runs queries with the options of the command line.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_options.h"
#include "crumple/detector.h"
#include "crumple/error.h"

namespace crumple::cli {

/// One mesh or two, with groups if they are requested.
struct Input {
    std::string name;  ///< for messages
    io::TriangleMesh first;
    std::optional<io::TriangleMesh> second;

    const io::TriangleMesh* second_or_null() const { return second ? &*second : nullptr; }
    std::int64_t triangle_count() const { return first.triangle_count() + (second ? second->triangle_count() : 0); }
};

/// Returns the query for colliding triangles.
IntersectionQuery query_of(const QueryOptions& query_options);

/// Returns the error with `name` in front of its message.
Error with_name(const std::string& name, const Error& error);

io::ReadOptions read_options(const ReadingOptions& options);

/// Reads a file, or standard input for `-`, and prints warnings. Throws Error that names file and place.
io::TriangleMesh read_mesh(const std::string& path, const ReadingOptions& options);

/// Converts the second mesh to the unit of the first, and prints a note.
void convert_to_one_unit(const std::string& file, io::TriangleMesh& mesh, const std::string& second_file,
                         io::TriangleMesh& second, const ReadingOptions& options);

/// Reads one file or two. Throws Error that names the file and the place.
Input read_input(const std::vector<std::string>& files, const QueryOptions& options);

/// Returns a generated mesh as input, as if it had been read from a file with these options: its groups are the
/// property `group`. Throws as read_input does.
Input made_input(const std::string& name, io::TriangleMesh mesh, const QueryOptions& options);

/// A mesh, and the same one at the end of a step.
struct MovingInput {
    Input start;
    io::TriangleMesh end;
};

/// Throws Error (invalid_argument) unless both have the same faces. Polygons may be triangulated differently.
void check_same_faces(const Input& start, const std::string& end_name, const io::TriangleMesh& end);

/// Returns the options for reading the meshes of a step: despite --weld, vertices are not merged on reading, since
/// those that coincide in one file need not coincide in the other.
QueryOptions reading_of_motion(QueryOptions options);

/// Returns the options with lines and points of OBJ files.
QueryOptions with_lines_and_points(QueryOptions options);

/// Reads both meshes; the groups are those of the start. Throws Error that names the file and the place.
MovingInput read_moving_input(const std::string& start, const std::string& end, const QueryOptions& options);

/// A mesh, and optionally the same one at the end of a step.
struct StepOrStatic {
    Input start;
    std::optional<io::TriangleMesh> end;

    const io::TriangleMesh* end_or_null() const { return end ? &*end : nullptr; }
};
/// Reads both meshes, or if `end` is empty the first one, in the same way as with an `end`. Throws as read_moving_input
/// does.
StepOrStatic read_step_or_static(const std::string& start, const std::string& end, const QueryOptions& options);

/// Makes offsets and hit flags of all triangles. `second_triangles`: 0 for one mesh.
void index_by_triangle(Intersections& found, std::int64_t triangles, std::int64_t second_triangles);

/// Files and names of the bodies of a world, for messages.
struct BodyOrigins {
    std::string files;  ///< all of them
    std::vector<std::string> names, file_of_body;
};

class AllowedThreads;

/// Detector that is warm-started from one input to the next.
class Search {
   public:
    /// Throws Error (invalid_argument) if options do not go together.
    Search(const QueryOptions& query_options, const Options& options);
    ~Search();

    /// Valid until the next call. Throws Error that names the input.
    const Intersections& find(const Input& input);
    /// True if there is any pair. Stops at the first pair, unless only a part is requested. Throws as find() does.
    bool any(const Input& input);
    /// Runs a query about features of one mesh, which moves to `end` if that is given (checked by check_same_faces()),
    /// or of two meshes. Valid until the next call. Throws Error that names the input.
    template <class Query>
    const typename Query::Result& find(const Input& input, const Query& query, const io::TriangleMesh* end = nullptr);
    /// Delivers results in blocks, in order. Throws as find() does, and what `take` throws.
    template <class Query>
    Statistics stream(const Input& input, const Query& query, FunctionRef<void(const typename Query::Result&)> take,
                      const io::TriangleMesh* end = nullptr);
    Statistics stream(const Input& input, FunctionRef<void(const Intersections&)> take) {
        return stream(input, query(), take);
    }
    /// Runs a query about bodies, which the world contains once for each of several configurations. `origins`: files
    /// and names of the bodies of one configuration. `first_configuration`: number of the first configuration, -1 if
    /// there is only one. The result is valid until the next call. Throws Error that names the files, or the file,
    /// configuration and body that the error concerns.
    template <class Query>
    const typename Query::Result& find(const BodyOrigins& origins, std::int64_t first_configuration, const World& world,
                                       const Query& query);

   private:
    IntersectionQuery query() const;
    QueryOptions query_options_;
    std::unique_ptr<AllowedThreads> threads_;
    Detector detector_;
    Intersections of_part_;
};

}  // namespace crumple::cli
