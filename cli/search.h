#pragma once

// From files and options to the result.

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

/// Query of a search for triangles.
IntersectionQuery query_of(const QueryOptions& query_options);

/// The error of a search, with what it is about and which option helps.
Error with_name(const std::string& name, const Error& error);

io::ReadOptions read_options(const ReadingOptions& options);

/// Reads a file, or standard input for `-`, and prints what is odd about it. Throws Error that names file and place.
io::TriangleMesh read_mesh(const std::string& path, const ReadingOptions& options);

/// Brings the second mesh to the unit of the first, and says so.
void bring_to_one_unit(const std::string& file, io::TriangleMesh& mesh, const std::string& second_file,
                       io::TriangleMesh& second, const ReadingOptions& options);

/// Reads one file or two. Throws Error that names the file and the place.
Input read_input(const std::vector<std::string>& files, const QueryOptions& options);

/// A mesh that was made, not read, under the options that a file of it would be read with: its own groups are the
/// property `group`. Throws as read_input does.
Input made_input(const std::string& name, io::TriangleMesh mesh, const QueryOptions& options);

/// A mesh, and the same one at the end of a step.
struct MovingInput {
    Input start;
    io::TriangleMesh end;
};

/// Throws Error (invalid_argument) unless both have the same faces. How the end's polygons were cut does not matter.
void check_same_faces(const Input& start, const std::string& end_name, const io::TriangleMesh& end);

/// With --weld vertices stay as they are in the files, for those that coincide in one of them need not in another.
QueryOptions reading_of_motion(QueryOptions options);

/// The same with lines and points of OBJ.
QueryOptions with_lines_and_points(QueryOptions options);

/// Reads both; the groups are those of the start. Throws Error that names the file and the place.
MovingInput read_moving_input(const std::string& start, const std::string& end, const QueryOptions& options);

/// A mesh, and perhaps the same one at the end of a step.
struct StepOrRest {
    Input start;
    std::optional<io::TriangleMesh> end;

    const io::TriangleMesh* end_or_null() const { return end ? &*end : nullptr; }
};
/// Reads both, or without an `end` the one as it would be read with it. Throws as read_moving_input does.
StepOrRest read_step_or_rest(const std::string& start, const std::string& end, const QueryOptions& options);

/// Makes offsets and hit flags of all triangles. `second_triangles`: 0 of one mesh.
void index_by_triangle(Intersections& found, std::int64_t triangles, std::int64_t second_triangles);

/// Where the bodies of a world come from, for messages.
struct BodyOrigins {
    std::string files;  ///< all of them
    std::vector<std::string> names, file_of_body;
};

class AllowedThreads;

/// A detector that stays warm from one input to the next.
class Search {
   public:
    /// Throws Error (invalid_argument) where options do not go together.
    Search(const QueryOptions& query_options, const Options& options);
    ~Search();

    /// Valid until the next call. Throws Error that names the input.
    const Intersections& find(const Input& input);
    /// True if there is any pair. Ends at the first that is found, unless only a part is requested. Throws as find
    /// does.
    bool any(const Input& input);
    /// The result of a query about features: of one mesh, on its way to `end` (which check_same_faces has seen) if that
    /// is given, or of two. Valid until the next call. Throws Error that names the input.
    template <class Query>
    const typename Query::Result& find(const Input& input, const Query& query, const io::TriangleMesh* end = nullptr);
    /// Results in blocks, in order. Throw as find does, and what `take` throws.
    template <class Query>
    Statistics stream(const Input& input, const Query& query, FunctionRef<void(const typename Query::Result&)> take,
                      const io::TriangleMesh* end = nullptr);
    Statistics stream(const Input& input, FunctionRef<void(const Intersections&)> take) {
        return stream(input, query(), take);
    }
    /// The result for bodies of these origins, again and again in each of several configurations, whose first one has
    /// this number; -1: there is but one. Valid until the next call. Throws Error that names the files, or the file,
    /// configuration and body it is about.
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
