#include "cli/search.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <utility>

#include "checks/topology.h"
#include "cli/printed_units.h"
#include "cli/terminal.h"
#include "cli/threads.h"
#include "crumple/error.h"
#include "io/bytes/text.h"

namespace crumple::cli {
using checks::label_components;

namespace {

/// Reads a text file with one group (an integer) per line, for each triangle; skips blank lines and comments (#).
/// Throws Error (file, format) that names the line.
std::vector<std::int32_t> read_groups(const std::string& path) {
    const io::Source source(path);
    io::Scanner in(source, {.lines = true, .comments = true});
    std::vector<std::int32_t> groups;
    for (; in.next_line_with_items(); in.skip_line()) {
        const char* const place = in.position();
        const std::int64_t group = in.integer("a group");
        if (group != static_cast<std::int32_t>(group)) in.fail(place, "a group does not fit in 32 bits");
        if (!in.finished()) in.fail("each line must have only one group, that of a triangle");
        groups.push_back(static_cast<std::int32_t>(group));
    }
    return groups;
}

void group_by_components(InputMeshes& input) {
    const std::int32_t count = label_components(input.first, input.first.groups);
    if (!input.second) return;
    label_components(*input.second, input.second->groups);
    for (std::int32_t& group : input.second->groups) group += count;
}

void group_by_file(InputMeshes& input, const std::string& path) {
    const std::vector<std::int32_t> groups = read_groups(path);
    if (static_cast<std::int64_t>(groups.size()) != input.triangle_count()) {
        throw Error(ErrorCode::format, path + ": " + std::to_string(groups.size()) + " groups for " +
                                           std::to_string(input.triangle_count()) + " triangles");
    }
    const auto middle = groups.begin() + input.first.triangle_count();
    input.first.groups.assign(groups.begin(), middle);
    if (input.second) input.second->groups.assign(middle, groups.end());
}

io::TriangleMesh read(const std::string& path, const io::ReadOptions& how) {
    io::TriangleMesh mesh =
        is_standard(path) ? io::read_mesh(std::cin, "standard input", how) : io::read_mesh(path, how);
    for (const std::string& warning : mesh.warnings) print_warning(warning);
    return mesh;
}

/// Reads a mesh with its groups. If the value of --groups is not a property of the mesh, the error also says that there
/// is no file of that name.
io::TriangleMesh read_with_groups(const std::string& path, const io::ReadOptions& how) {
    try {
        return read(path, how);
    } catch (const Error& error) {
        if (how.group_property.empty() || error.element != Element::option) throw;
        throw Error(ErrorCode::invalid_argument,
                    "--groups " + how.group_property + ": there is no such file, and " + error.what(), Element::option);
    }
}

enum class GroupSource { none, components, file, property };

GroupSource group_source(const QueryOptions& options) {
    if (options.groups.empty()) return GroupSource::none;
    if (options.of_bodies())
        throw Error(ErrorCode::invalid_argument, "--groups bodies is for crumple detect only", Element::option);
    if (options.groups == "components") return GroupSource::components;
    return std::filesystem::exists(options.groups) ? GroupSource::file : GroupSource::property;
}

}  // namespace

io::ReadOptions read_options(const ReadingOptions& options) {
    const io::Weld weld = !options.weld ? io::Weld::automatic : *options.weld ? io::Weld::yes : io::Weld::no;
    return {.precision = options.precision,
            .weld = weld,
            .triangulation = options.triangulation,
            .strict = options.strict,
            .lines_and_points = options.lines_and_points,
            .unit = options.unit};
}

io::TriangleMesh read_mesh(const std::string& path, const ReadingOptions& options) {
    return read(path, read_options(options));
}

void convert_to_one_unit(const std::string& file, io::TriangleMesh& mesh, const std::string& second_file,
                         io::TriangleMesh& second, const ReadingOptions& options) {
    io::CommonUnit unit = common_unit(options.strict);
    unit.apply(file, mesh);
    unit.apply(second_file, second);
}

InputMeshes read_input(const std::vector<std::string>& files, const QueryOptions& options) {
    io::ReadOptions how = read_options(options);
    const GroupSource source = group_source(options);
    if (source == GroupSource::property) how.group_property = options.groups;

    check_standard_input(files);
    InputMeshes input{files[0], read_with_groups(files[0], how), {}};
    if (files.size() > 1) {
        input.name += ", " + files[1];
        input.second = read_with_groups(files[1], how);
        convert_to_one_unit(files[0], input.first, files[1], *input.second, options);
    }
    if (source == GroupSource::components) group_by_components(input);
    if (source == GroupSource::file) group_by_file(input, options.groups);
    return input;
}

InputMeshes generated_input(const std::string& name, io::TriangleMesh mesh, const QueryOptions& options) {
    const GroupSource source = group_source(options);
    if (source == GroupSource::property && (options.groups != "group" || mesh.groups.empty())) {
        throw Error(ErrorCode::invalid_argument,
                    "--groups " + options.groups + ": there is no such file, and " + name + " has no such groups",
                    Element::option);
    }
    InputMeshes input{name, std::move(mesh), {}};
    if (source != GroupSource::property) input.first.groups.clear();
    const auto convert = [&](auto scalar) {
        input.first.vertices = std::visit(
            [&](const auto& v) { return std::vector<decltype(scalar)>(v.begin(), v.end()); }, input.first.vertices);
    };
    if (options.precision == io::Precision::float32) convert(float{});
    if (options.precision == io::Precision::float64) convert(double{});
    if (source == GroupSource::components) group_by_components(input);
    if (source == GroupSource::file) group_by_file(input, options.groups);
    return input;
}

namespace {

/// Throws Error (invalid_argument) that says that the meshes of a step have different faces. `what`: the first
/// difference.
[[noreturn]] void refuse_other_faces(const std::string& start_name, const std::string& end_name,
                                     const std::string& what) {
    const bool stl = extension_of(start_name) == ".stl" || extension_of(end_name) == ".stl";
    throw Error(ErrorCode::invalid_argument,
                start_name + " and " + end_name + " must be one mesh at two times, but " + what +
                    (stl ? " (each STL file was welded separately; use --weld or --no-weld)" : ""));
}

void check_same_counts(const std::string& start_name, const std::string& end_name, const char* of, std::int64_t start,
                       std::int64_t end) {
    if (start == end) return;
    refuse_other_faces(start_name, end_name,
                       "have " + std::to_string(start) + " and " + std::to_string(end) + ' ' + of);
}

}  // namespace

void check_same_faces(const InputMeshes& start, const std::string& end_name, const io::TriangleMesh& end) {
    const io::TriangleMesh& mesh = start.first;
    check_same_counts(start.name, end_name, "vertices", mesh.vertex_count(), end.vertex_count());
    check_same_counts(start.name, end_name, "triangles", mesh.triangle_count(), end.triangle_count());
    if (mesh.lines != end.lines || mesh.points != end.points)
        refuse_other_faces(start.name, end_name, "lines or points have other vertices");
    const io::Polygons &a = mesh.polygons, &b = end.polygons;
    if (!a.empty() && a.offsets == b.offsets && a.corners == b.corners) return;
    const auto other = std::mismatch(mesh.triangles.begin(), mesh.triangles.end(), end.triangles.begin()).first;
    if (other != mesh.triangles.end())
        refuse_other_faces(start.name, end_name,
                           "triangle " + std::to_string((other - mesh.triangles.begin()) / 3) + " has other vertices");
}

QueryOptions reading_of_motion(QueryOptions options) {
    if (options.weld) options.weld = false;
    return with_lines_and_points(std::move(options));
}

QueryOptions with_lines_and_points(QueryOptions options) {
    options.lines_and_points = true;
    return options;
}

MovingInput read_moving_input(const std::string& start, const std::string& end, const QueryOptions& options) {
    check_standard_input({start, end});
    const QueryOptions reading = reading_of_motion(options);
    MovingInput input{read_input({start}, reading), read_mesh(end, reading)};
    convert_to_one_unit(start, input.start.first, end, input.end, options);
    check_same_faces(input.start, end, input.end);
    input.start.name += " to " + end;
    return input;
}

StepOrStatic read_step_or_static(const std::string& start, const std::string& end, const QueryOptions& options) {
    if (end.empty()) return {read_input({start}, reading_of_motion(options)), {}};
    MovingInput step = read_moving_input(start, end, options);
    return {std::move(step.start), std::move(step.end)};
}

SearchSession::SearchSession(const QueryOptions& query_options, const Options& options)
    : query_options_(query_options),
      threads_(options.threads ? std::make_unique<AllowedThreads>(options.threads) : nullptr),
      detector_((query_options.check(), check_cost_options(options), options)) {
    if (!detector_.fallback().empty())
        print_error(std::string(detector_.fallback()) + "; the cpu backend is used instead");
}

SearchSession::~SearchSession() = default;

IntersectionQuery query_of(const QueryOptions& query_options) {
    IntersectionQuery query;
    query.neighbours = query_options.neighbours;
    query.kind = query_options.kind;
    query.weld = query_options.weld.value_or(false);
    query.output = query_options.contacts ? Output::contacts : Output::pairs;
    query.filter.groups = query_options.filter.value_or(PairScope::both);
    return query;
}

void SearchSession::warn_of_losses(const Statistics& statistics) {
    if (statistics.complete || std::exchange(has_warned_, true)) return;
    print_warning(
        "pairs may be missing: with this --membership, some triangles are not in all clusters that they reach");
}

IntersectionQuery SearchSession::query() const { return query_of(query_options_); }

Error with_name(const std::string& name, const Error& error) {
    Error named(error.code, name + ": " + error.what(), error.element, error.index, error.bytes_needed,
                error.system_error);
    named.rank = error.rank;
    return named;
}

void index_by_triangle(Intersections& found, std::int64_t triangles, std::int64_t second_triangles) {
    const auto first = static_cast<std::size_t>(triangles);
    found.offsets.assign(first + 1, 0);
    found.hit.assign(first, 0);
    found.hit_second.assign(static_cast<std::size_t>(second_triangles), 0);
    Array<std::uint8_t>& other = second_triangles > 0 ? found.hit_second : found.hit;
    for (const Pair& pair : found.pairs) {
        ++found.offsets[pair.a + 1];
        found.hit[pair.a] = other[pair.b] = 1;
    }
    for (std::size_t i = 0; i < first; ++i) found.offsets[i + 1] += found.offsets[i];
}

namespace {

/// Returns work(). Adds `name` in front of the message of any Error that it throws.
template <class Work>
decltype(auto) named(const std::string& name, Work work) {
    try {
        return work();
    } catch (const Error& error) {
        throw with_name(name, error);
    }
}

/// View of a mesh that includes its lines and points, if it has any, as codimensional edges and points.
class CodimensionalView {
   public:
    explicit CodimensionalView(const io::TriangleMesh& mesh) : view_(mesh.view()) {
        if (mesh.lines.empty() && mesh.points.empty()) return;
        features_ = io::features_of(mesh);
        view_.edges = features_.edges;
        view_.points = features_.points;
    }
    const MeshView& view() const { return view_; }

   private:
    io::MeshFeatures features_;
    MeshView view_;
};

/// Returns work(scene) for the scene of an input, and adds the name of the input to the message of any Error. `end`: if
/// not null, the first mesh moves to the vertices of `end`; the input must then have one mesh.
template <class Work>
decltype(auto) on_scene(const InputMeshes& input, const io::TriangleMesh* end, Work work) {
    return named(input.name, [&]() -> decltype(auto) {
        const CodimensionalView first(input.first);
        if (!input.second) return work(Scene(end ? first.view().moving_to(end->view().vertices) : first.view()));
        const CodimensionalView second(*input.second);
        return work(Scene(first.view(), second.view()));
    });
}

}  // namespace

const Intersections& SearchSession::find(const InputMeshes& input) {
    if (!query_options_.part) return find(input, query());
    return on_scene(input, nullptr, [&](const Scene& scene) -> const Intersections& {
        const auto [index, count] = *query_options_.part;
        detector_.find(detector_.partition(scene, query(), count)[static_cast<std::size_t>(index) - 1], query());
        detector_.swap_result(of_part_);
        warn_of_losses(of_part_.statistics);
        index_by_triangle(of_part_, input.first.triangle_count(), input.second ? input.second->triangle_count() : 0);
        return of_part_;
    });
}

bool SearchSession::any(const InputMeshes& input) {
    if (query_options_.part || detector_.options().method.membership != Membership::ball)
        return find(input).statistics.pairs > 0;
    return on_scene(input, nullptr, [&](const Scene& scene) { return detector_.any(scene, query()); });
}

Clustering SearchSession::cluster(const InputMeshes& input) {
    Clustering clustering = on_scene(input, nullptr, [&](const Scene& scene) { return detector_.cluster(scene); });
    Statistics statistics;
    statistics.complete = clustering.complete;
    warn_of_losses(statistics);
    return clustering;
}

template <class Query>
const typename Query::Result& SearchSession::find(const InputMeshes& input, const Query& query,
                                                  const io::TriangleMesh* end) {
    return on_scene(
        input, end, [&](const Scene& scene) -> auto& {
            const auto& found = detector_.find(scene, query);
            warn_of_losses(found.statistics);
            return found;
        });
}

template <class Query>
Statistics SearchSession::stream(const InputMeshes& input, const Query& query,
                                 FunctionRef<void(const typename Query::Result&)> take, const io::TriangleMesh* end) {
    return on_scene(input, end, [&](const Scene& scene) {
        const Statistics statistics = detector_.stream(scene, query, take);
        warn_of_losses(statistics);
        return statistics;
    });
}

template const Impacts& SearchSession::find(const InputMeshes&, const ImpactQuery&, const io::TriangleMesh*);
template const Proximities& SearchSession::find(const InputMeshes&, const ProximityQuery&, const io::TriangleMesh*);
template const Candidates& SearchSession::find(const InputMeshes&, const CandidateQuery&, const io::TriangleMesh*);
template Statistics SearchSession::stream(const InputMeshes&, const IntersectionQuery&,
                                          FunctionRef<void(const Intersections&)>, const io::TriangleMesh*);
template Statistics SearchSession::stream(const InputMeshes&, const ImpactQuery&, FunctionRef<void(const Impacts&)>,
                                          const io::TriangleMesh*);
template Statistics SearchSession::stream(const InputMeshes&, const ProximityQuery&,
                                          FunctionRef<void(const Proximities&)>, const io::TriangleMesh*);
template Statistics SearchSession::stream(const InputMeshes&, const CandidateQuery&,
                                          FunctionRef<void(const Candidates&)>, const io::TriangleMesh*);

namespace {

/// Replaces names of the C++ API in a message by the corresponding options of the command line.
std::string in_words_of_options(std::string message) {
    constexpr std::pair<std::string_view, std::string_view> options[] = {
        {"open_edges lists", "info --open-edges lists"},
        {"OverlapQuery::weld", "--weld"},
        {"OverlapQuery::open", "--open skip"},
        {"IntersectionQuery::weld", "--weld"},
        {"IntersectionQuery::open", "--open skip"}};
    for (const auto& [member, option] : options)
        if (const std::size_t at = message.find(member); at != message.npos) message.replace(at, member.size(), option);
    return message;
}

}  // namespace

Error with_origin(const Error& error, const BodyOrigins& origins, std::int64_t first_configuration) {
    Error reworded(error.code, in_words_of_options(error.what()), error.element, error.index, error.bytes_needed,
                   error.system_error);
    reworded.rank = error.rank;
    return io::with_body_name(reworded, origins, first_configuration);
}

template <class Query>
const typename Query::Result& SearchSession::find(const BodyOrigins& origins, std::int64_t first_configuration,
                                                  const World& world, const Query& query) {
    try {
        const auto& found = detector_.find(world, query);
        warn_of_losses(found.statistics);
        return found;
    } catch (const Error& error) {
        throw with_origin(error, origins, first_configuration);
    }
}

template const Intersections& SearchSession::find(const BodyOrigins&, std::int64_t, const World&,
                                                  const IntersectionQuery&);
template const Overlaps& SearchSession::find(const BodyOrigins&, std::int64_t, const World&, const OverlapQuery&);
template const Distances& SearchSession::find(const BodyOrigins&, std::int64_t, const World&, const DistanceQuery&);

}  // namespace crumple::cli
