#include "cli/commands/detect_bodies.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "cli/bodies/body_lists.h"
#include "cli/bodies_of_files.h"
#include "cli/choice.h"
#include "cli/commands.h"
#include "cli/search.h"
#include "cli/search_command.h"
#include "cli/steps.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "io/bytes/atomic_file.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

std::optional<ListFormat> list_format(const std::string& extension) {
    if (extension == ".txt") return ListFormat::txt;
    if (extension == ".csv") return ListFormat::csv;
    if (extension == ".json") return ListFormat::json;
    return std::nullopt;
}

void check_output_formats(const BodyTask& task) {
    check_format(task.outputs, task.format);
    for (const std::string& path : task.outputs) {
        const std::string extension = extension_of(path, task.format);
        if (list_format(extension)) continue;
        const bool picture = io::has_colours(io::mesh_format_of(extension));
        if (picture && !task.bodies.poses.empty())
            refuse("-o " + path + ": with --poses, rows are written as .txt, .csv or .json");
        if (!picture)
            refuse("-o " + (path.empty() ? "''" : path) + (is_standard(path) ? " --format " + task.format : "") +
                   ": bodies are written as .txt, .csv or .json, coloured as .glb, .3mf, .ply, .obj or .html");
        if (is_standard(path) && extension == ".obj")
            refuse("-o - --format obj: a coloured .obj needs a file beside it");
    }
}

bool has_pictures(const BodyTask& task) {
    return std::any_of(task.outputs.begin(), task.outputs.end(),
                       [&](const std::string& path) { return !list_format(extension_of(path, task.format)); });
}

/// Returns the query for `count` configurations. --filter determines whether collisions of a body with itself count;
/// --excluded-bodies A,A excludes those of body A.
IntersectionQuery query_of(const BodyTask& task, Output output, const BodyScene& scene, std::size_t count) {
    const QueryOptions& query_options = task.query_options;
    IntersectionQuery query;
    query.output = output;
    query.neighbours = query_options.neighbours;
    query.kind = query_options.kind;
    query.weld = query_options.weld.value_or(false);
    query.containment = task.bodies.containment;
    query.open = task.bodies.open.value_or(OpenSurfaces::error);
    query.filter.bodies = query_options.filter.value_or(PairScope::between);
    query.filter.excluded_bodies = scene.excluded(count);
    return query;
}

int report(bool collides) {
    to_standard_output([&](std::ostream& out) { out << (collides ? "something collides\n" : "nothing collides\n"); });
    return collides ? collided : done;
}

template <class List>
void write(const std::string& path, const List& list, ListFormat format) {
    if (is_standard(path)) return to_standard_output([&](std::ostream& out) { write_list(out, list, format); });
    io::AtomicFile file(path);
    write_list(file.stream(), list, format);
    file.commit();
}

void print_skipped(const BodyScene& scene, const std::set<std::int32_t>& bodies) {
    scene.print_skipped(bodies, "what lies inside does not collide");
}

/// Returns the pairs sorted, each once.
std::vector<BodyPair> distinct(const Array<BodyPair>& bodies) {
    std::vector<BodyPair> pairs(bodies.begin(), bodies.end());
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

/// Returns a result, for pictures, in which all triangles of all bodies in these pairs have the hit flag.
Intersections whole_bodies(const io::WorldMesh& mesh, const std::vector<BodyPair>& pairs) {
    Intersections result;
    result.first_triangle.push_back(0);
    for (const io::NamedBody& body : mesh.bodies)
        result.first_triangle.push_back(result.first_triangle.back() +
                                        mesh.shapes[static_cast<std::size_t>(body.shape)].triangle_count());
    result.hit.assign(static_cast<std::size_t>(mesh.triangle_count()), 0);
    for (const BodyPair& pair : pairs)
        for (const std::int32_t b : {pair.first, pair.second})
            std::fill(result.hit.begin() + result.first_triangle[b], result.hit.begin() + result.first_triangle[b + 1],
                      std::uint8_t{1});
    return result;
}

std::string summary(const BodyList& list) {
    const auto bodies = static_cast<std::int64_t>(list.names.size());
    if (list.pairs.empty())
        return fmt::format("nothing collides: {} {}, {:.1f} ms\n", grouped(bodies), bodies == 1 ? "body" : "bodies",
                           list.statistics.milliseconds);
    std::vector<std::uint8_t> hit(list.names.size());
    for (const BodyPair& pair : list.pairs)
        for (const std::int32_t b : {pair.first, pair.second}) hit[static_cast<std::size_t>(b)] = 1;
    const std::int64_t inside = std::count(list.inside.begin(), list.inside.end(), 1);
    return fmt::format("{} pair{} of bodies{}, {} of {} bodies, {:.1f} ms\n",
                       grouped(static_cast<std::int64_t>(list.pairs.size())), list.pairs.size() == 1 ? "" : "s",
                       list.has_inside ? fmt::format(" ({} inside)", grouped(inside)) : "",
                       grouped(std::count(hit.begin(), hit.end(), 1)), grouped(bodies), list.statistics.milliseconds);
}

bool has_summary(const BodyTask& task) { return !std::all_of(task.outputs.begin(), task.outputs.end(), is_standard); }

int find_once(const BodyTask& task, SearchSession& search, const BodyScene& scene, const Steps& steps) {
    const io::WorldView view = scene.mesh().view();
    const std::vector<Body> bodies = scene.bodies(1, true);
    const World world{view.shapes, bodies, view.poses};
    const bool only_status = task.check && task.outputs.empty(), pictures = has_pictures(task);
    const bool of_triangles = pictures && !task.bodies.containment;  // if false, any pictures colour whole bodies
    const Output output = only_status ? Output::any : of_triangles ? Output::pairs : Output::body_pairs;
    IntersectionQuery query = query_of(task, output, scene, 1);
    query.index = of_triangles;
    steps.begin("search");
    const Intersections& found = search.find(scene.origins(), -1, world, query);
    print_skipped(scene, {found.skipped.begin(), found.skipped.end()});
    if (only_status) return report(found.any);

    steps.begin("write");
    const BodyList list{.names = scene.names(),
                        .pairs = distinct(found.bodies),
                        .inside = {found.inside.begin(), found.inside.end()},
                        .has_inside = task.bodies.containment,
                        .statistics = found.statistics};
    const Intersections of_bodies =
        pictures && !of_triangles ? whole_bodies(scene.mesh(), list.pairs) : Intersections();
    const Intersections& shown = of_triangles ? found : of_bodies;
    for (const std::string& path : task.outputs) {
        const std::string extension = extension_of(path, task.format);
        if (const auto format = list_format(extension))
            write(path, list, *format);
        else if (is_standard(path))
            to_standard_output([&](std::ostream& out) {
                io::write_coloured(out, scene.mesh(), shown, io::mesh_format_of(extension));
            });
        else
            io::write_coloured(path, scene.mesh(), shown);
    }
    if (task.outputs.empty()) write("-", list, ListFormat::txt);
    if (list.pairs.empty() || has_summary(task)) say(summary(list));
    return task.check && found.any ? collided : done;
}

/// Adds the result of a batch of `count` configurations to the list. Converts indices of bodies in the batch to indices
/// within one configuration.
void add(const Intersections& found, std::size_t count, ConfigurationList& list) {
    const auto n = static_cast<std::int32_t>(list.names.size());
    std::size_t i = 0;
    for (std::size_t c = 0; c < count; ++c) {
        list.collides.push_back(found.world_hit[c]);
        if (!list.has_pairs) continue;
        const std::int32_t first = static_cast<std::int32_t>(c) * n;
        for (; i < found.bodies.size() && found.bodies[i].first < first + n; ++i)
            list.pairs.push_back({found.bodies[i].first - first, found.bodies[i].second - first});
        list.ends.push_back(list.pairs.size());
    }
    if (list.has_inside) list.inside.insert(list.inside.end(), found.inside.begin(), found.inside.end());
    list.milliseconds += found.statistics.milliseconds;
}

int find_configurations(const BodyTask& task, SearchSession& search, const BodyScene& scene, const Steps& steps) {
    const std::vector<Pose> poses = scene.read_poses(task.bodies.poses);
    const bool only_status = task.check && task.outputs.empty();
    const Output output = only_status ? Output::any : task.bodies.any ? Output::any_by_world : Output::body_pairs;
    ConfigurationList list{.names = scene.names(), .has_pairs = !task.bodies.any};
    list.has_inside = task.bodies.containment && list.has_pairs;
    std::set<std::int32_t> skipped;
    bool any = false;
    steps.begin("search");
    scene.search_all(
        search, poses, true, [&](std::size_t count) { return query_of(task, output, scene, count); },
        [&](const Intersections& found, std::size_t, std::size_t count) {
            any = any || found.any;
            for (const std::int32_t body : found.skipped)
                skipped.insert(body % static_cast<std::int32_t>(list.names.size()));
            if (!only_status) add(found, count, list);
            return !only_status || !any;
        });
    print_skipped(scene, skipped);
    if (only_status) return report(any);
    steps.begin("write");
    for (const std::string& path : task.outputs) write(path, list, *list_format(extension_of(path, task.format)));
    if (task.outputs.empty()) write("-", list, ListFormat::csv);
    const std::int64_t colliding = list.colliding();
    if (has_summary(task))
        say("{} of {} configurations collide, {:.1f} ms\n", grouped(colliding),
            grouped(static_cast<std::int64_t>(list.collides.size())), list.milliseconds);
    return task.check && colliding ? collided : done;
}

}  // namespace

void add_detect_body_options(CLI::App& app, DetectBodyOptions& options) {
    add_body_options(app, options,
                     {"With --groups bodies: ", "these two bodies may collide; A,A: with itself",
                      "The output has a row for each configuration: its number, whether anything collides, and how "
                      "many pairs of bodies do"});
    app.add_flag("--any-by-world", options.any,
                 "With --poses: list only whether anything collides in each configuration, which is a world; faster");
    app.add_flag("--containment", options.containment,
                 "With --groups bodies: a body inside another one also collides with it, although their surfaces do "
                 "not meet. Lists mark such pairs, and pictures colour whole bodies");
    add_choice<std::optional<OpenSurfaces>, OpenSurfaces>(
        app, "--open", options.open, {{"error", OpenSurfaces::error}, {"skip", OpenSurfaces::skip}},
        "With --containment: a body whose surface is not closed is an error if something might lie inside it (error, "
        "the default), or contains nothing (skip)");
}

void check_detect_body_options(const DetectBodyOptions& options, const QueryOptions& query_options) {
    if (options.any && options.poses.empty())
        refuse("--any-by-world needs --poses; to find out whether anything collides, use --check");
    if (options.open && !options.containment) refuse("--open needs --containment");
    if (query_options.of_bodies()) return;
    if (options.containment) refuse("--containment needs --groups bodies");
    if (!options.excluded.empty()) refuse("--excluded-bodies needs --groups bodies");
    if (!options.exclude_from.empty()) refuse("--excluded-bodies-from needs --groups bodies");
    if (!options.poses.empty()) refuse("--poses needs --groups bodies");
}

int detect_bodies(const BodyTask& task) {
    check_output_formats(task);
    std::vector<std::string> inputs = task.files;
    task.bodies.add_files(inputs);
    check_standard_input(inputs);
    check_outputs(task.outputs, inputs, task.query_options);
    SearchSession search(task.query_options, task.bodies.containment ? feature_options(task.options) : task.options);
    const Steps steps(task.progress);
    steps.begin("read");
    const BodyScene scene(task.files, task.query_options, task.bodies);
    return task.bodies.poses.empty() ? find_once(task, search, scene, steps)
                                     : find_configurations(task, search, scene, steps);
}

}  // namespace crumple::cli
