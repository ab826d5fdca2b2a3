#include "cli/commands/detect_bodies.h"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "cli/bodies_of_files.h"
#include "cli/body_lists.h"
#include "cli/commands.h"
#include "cli/search.h"
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
        if (picture && !task.bodies.poses.empty()) refuse("-o " + path + ": --poses give rows, as .txt, .csv or .json");
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

/// A world that was read, and queries of it.
struct Scene {
    io::WorldMesh mesh;
    BodyNames names;
    std::string files;  ///< for messages
    std::vector<BodyPair> excluded;

    explicit Scene(const BodyTask& task)
        : mesh(read_bodies(task.files, task.query_options)),
          names(mesh.bodies),
          files(fmt::format("{}", fmt::join(task.files, ", "))) {
        for (const std::string& text : task.bodies.excluded) excluded.push_back(names.pair(text));
        if (task.bodies.exclude_from.empty()) return;
        const std::vector<BodyPair> more = names.read_pairs(task.bodies.exclude_from);
        excluded.insert(excluded.end(), more.begin(), more.end());
    }

    /// In `count` configurations, each a world, whose bodies follow those of the one before. --filter says whether
    /// pairs within a body count, and --excluded-bodies A,A switches them off for one.
    std::vector<Body> bodies(std::size_t count) const {
        std::vector<Body> result;
        result.reserve(count * mesh.bodies.size());
        for (std::size_t c = 0; c < count; ++c)
            for (const io::NamedBody& body : mesh.bodies)
                result.push_back({.shape = body.shape, .world = static_cast<std::int32_t>(c), .self = true});
        for (const BodyPair& pair : excluded)
            for (std::size_t c = 0; c < count && pair.first == pair.second; ++c)
                result[c * mesh.bodies.size() + static_cast<std::size_t>(pair.first)].self = false;
        return result;
    }
    IntersectionQuery query(const QueryOptions& query_options, Output output, std::size_t count) const {
        IntersectionQuery query;
        query.output = output;
        query.neighbours = query_options.neighbours;
        query.kind = query_options.kind;
        query.weld = query_options.weld.value_or(false);
        query.filter.bodies = query_options.filter.value_or(PairScope::between);
        const auto n = static_cast<std::int32_t>(mesh.bodies.size());
        for (std::int32_t c = 0; c < static_cast<std::int32_t>(count); ++c)
            for (const BodyPair& pair : excluded)
                if (pair.first != pair.second)
                    query.filter.excluded_bodies.push_back({c * n + pair.first, c * n + pair.second});
        return query;
    }
};

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

/// Each pair of bodies once, in order.
std::vector<BodyPair> distinct(const Array<BodyPair>& bodies) {
    std::vector<BodyPair> pairs(bodies.begin(), bodies.end());
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

std::string summary(const BodyList& list) {
    const auto bodies = static_cast<std::int64_t>(list.names.size());
    if (list.pairs.empty())
        return fmt::format("nothing collides: {} {}, {:.1f} ms\n", grouped(bodies), bodies == 1 ? "body" : "bodies",
                           list.statistics.milliseconds);
    std::vector<std::uint8_t> hit(list.names.size());
    for (const BodyPair& pair : list.pairs)
        for (const std::int32_t b : {pair.first, pair.second}) hit[static_cast<std::size_t>(b)] = 1;
    return fmt::format("{} pair{} of bodies, {} of {} bodies, {:.1f} ms\n",
                       grouped(static_cast<std::int64_t>(list.pairs.size())), list.pairs.size() == 1 ? "" : "s",
                       grouped(std::count(hit.begin(), hit.end(), 1)), grouped(bodies), list.statistics.milliseconds);
}

bool tells_summary(const BodyTask& task) { return !std::all_of(task.outputs.begin(), task.outputs.end(), is_standard); }

int find_once(const BodyTask& task, Search& search, const Scene& scene, const Steps& steps) {
    const io::WorldView view = scene.mesh.view();
    const std::vector<Body> bodies = scene.bodies(1);
    const World world{view.shapes, bodies, view.poses};
    const bool only_status = task.check && task.outputs.empty(), pictures = has_pictures(task);
    IntersectionQuery query = scene.query(task.query_options,
                                          only_status ? Output::any
                                          : pictures  ? Output::pairs
                                                      : Output::body_pairs,
                                          1);
    query.index = pictures;
    steps.begin("search");
    const Intersections& found = search.find(scene.files, scene.names.list(), -1, world, query);
    if (only_status) return report(found.any);

    steps.begin("write");
    const BodyList list{scene.names.list(), distinct(found.bodies), found.statistics};
    for (const std::string& path : task.outputs) {
        const std::string extension = extension_of(path, task.format);
        if (const auto format = list_format(extension))
            write(path, list, *format);
        else if (is_standard(path))
            to_standard_output(
                [&](std::ostream& out) { io::write_coloured(out, scene.mesh, found, io::mesh_format_of(extension)); });
        else
            io::write_coloured(path, scene.mesh, found);
    }
    if (task.outputs.empty()) write("-", list, ListFormat::txt);
    if (list.pairs.empty() || tells_summary(task)) say(summary(list));
    return task.check && found.any ? collided : done;
}

std::vector<Pose> read_poses(const std::string& path, const std::vector<std::string>& names) {
    std::vector<Pose> poses =
        is_standard(path) ? io::read_poses(std::cin, "standard input", names) : io::read_poses(path, names);
    if (names.empty() && !poses.empty()) refuse("--poses " + path + ": there is no body to pose");
    return poses;
}

/// Adds a batch of configurations. Bodies of the batch are those of the list, over and over.
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
    list.milliseconds += found.statistics.milliseconds;
}

/// So many configurations are searched at once that what they take beside the shapes stays small.
constexpr std::size_t bodies_at_once = 100'000;

int find_configurations(const BodyTask& task, Search& search, const Scene& scene, const Steps& steps) {
    const std::vector<Pose> poses = read_poses(task.bodies.poses, scene.names.list());
    const io::WorldView view = scene.mesh.view(1);
    const std::size_t n = view.bodies.size(), count = n ? poses.size() / n : 0;
    const bool only_status = task.check && task.outputs.empty();
    const Output output = only_status ? Output::any : task.bodies.any ? Output::any_by_world : Output::body_pairs;
    ConfigurationList list{scene.names.list(), !task.bodies.any};
    std::vector<Body> bodies;
    IntersectionQuery query;
    steps.begin("search");
    Progress progress(count);
    for (std::size_t first = 0, size; first < count; first += size) {
        progress.show(first, "");
        size = std::min(count - first, std::max<std::size_t>(1, bodies_at_once / n));
        if (bodies.size() != size * n) {
            bodies = scene.bodies(size);
            query = scene.query(task.query_options, output, size);
        }
        const std::span<const Pose> batch(&poses[first * n], size * n);
        try {
            const Intersections& found = search.find(scene.files, scene.names.list(), static_cast<std::int64_t>(first),
                                                     {view.shapes, bodies, batch}, query);
            if (only_status && found.any) return progress.clear(), report(true);
            if (!only_status) add(found, size, list);
        } catch (...) {
            progress.clear();
            throw;
        }
    }
    progress.clear();
    if (only_status) return report(false);
    steps.begin("write");
    for (const std::string& path : task.outputs) write(path, list, *list_format(extension_of(path, task.format)));
    if (task.outputs.empty()) write("-", list, ListFormat::csv);
    const std::int64_t colliding = list.colliding();
    if (tells_summary(task))
        say("{} of {} configurations collide, {:.1f} ms\n", grouped(colliding),
            grouped(static_cast<std::int64_t>(count)), list.milliseconds);
    return task.check && colliding ? collided : done;
}

}  // namespace

void BodyOptions::check(const QueryOptions& query_options) const {
    if (any && poses.empty())
        refuse("--any-by-world changes nothing without --poses; --check tells whether anything collides");
    if (query_options.of_bodies()) return;
    if (!excluded.empty()) refuse("--excluded-bodies needs --groups bodies");
    if (!exclude_from.empty()) refuse("--excluded-bodies-from needs --groups bodies");
    if (!poses.empty()) refuse("--poses needs --groups bodies");
}

void add_body_options(CLI::App& app, BodyOptions& options) {
    app.add_option("--excluded-bodies", options.excluded,
                   "With --groups bodies: these two bodies may collide; A,A: with itself. May be repeated")
        ->type_name("A,B")
        ->allow_extra_args(false);
    app.add_option("--excluded-bodies-from", options.exclude_from,
                   "The same for all pairs in a file, two names a line with a tab between, as detect lists them")
        ->type_name("FILE");
    app.add_option("--poses", options.poses,
                   "With --groups bodies: many configurations instead of that of the files. A row of 12 numbers, those "
                   "of (A | t) by rows, for each body, configuration after configuration; text or .npy. For each "
                   "configuration a row tells its number, whether anything collides, and how many pairs of bodies do")
        ->type_name("FILE");
    app.add_flag("--any-by-world", options.any,
                 "With --poses: only whether anything collides in each configuration, which is a world; faster");
}

int detect_bodies(const BodyTask& task) {
    check_output_formats(task);
    std::vector<std::string> inputs = task.files;
    for (const std::string* const path : {&task.bodies.exclude_from, &task.bodies.poses})
        if (!path->empty()) inputs.push_back(*path);
    check_standard_input(inputs);
    check_outputs(task.outputs, inputs, task.query_options);
    Search search(task.query_options, task.options);
    const Steps steps(task.progress);
    steps.begin("read");
    const Scene scene(task);
    return task.bodies.poses.empty() ? find_once(task, search, scene, steps)
                                     : find_configurations(task, search, scene, steps);
}

}  // namespace crumple::cli
