#include "cli/bodies/body_scene.h"

#include <cctype>
#include <iostream>

namespace crumple::cli {

void BodyOptions::add_files(std::vector<std::string>& files) const {
    for (const std::string* const path : {&exclude_from, &poses})
        if (!path->empty()) files.push_back(*path);
}

std::string help_under(const std::string& condition, std::string help) {
    if (condition.empty() && !help.empty())
        help[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(help[0])));
    return condition + help;
}

std::vector<const CLI::Option*> add_excluded_options(CLI::App& app, BodyOptions& options,
                                                     const BodyOptionWords& words) {
    return {app.add_option("--excluded-bodies", options.excluded,
                           help_under(words.condition, std::string(words.excluded) + ". May be repeated"))
                ->type_name("A,B")
                ->allow_extra_args(false),
            app.add_option("--excluded-bodies-from", options.exclude_from,
                           "The same for all pairs in a file: two names per line, separated by a tab, or a .csv or "
                           ".json, as detect --groups bodies writes them")
                ->type_name("FILE")};
}

std::vector<const CLI::Option*> add_body_options(CLI::App& app, BodyOptions& options, const BodyOptionWords& words) {
    std::vector<const CLI::Option*> added = add_excluded_options(app, options, words);
    const std::string poses = help_under(
        words.condition,
        "many configurations instead of that of the files: for each configuration and body a row of 12 numbers, the "
        "rows of its matrix (A | t); text or .npy. " +
            std::string(words.rows));
    added.push_back(app.add_option("--poses", options.poses, poses)->type_name("FILE"));
    return added;
}

BodyScene::BodyScene(const std::vector<std::string>& files, const ReadingOptions& reading, const BodyOptions& options)
    : mesh_(read_bodies(files, reading, &origins_.file_of_body)) {
    origins_.files = fmt::format("{}", fmt::join(files, ", "));
    const BodyNames names(mesh_.bodies);
    origins_.names = names.list();
    for (const std::string& text : options.excluded) excluded_.push_back(names.pair(text));
    if (options.exclude_from.empty()) return;
    const std::vector<BodyPair> more = names.read_pairs(options.exclude_from);
    excluded_.insert(excluded_.end(), more.begin(), more.end());
}

std::vector<Body> BodyScene::bodies(std::size_t count, bool self) const {
    std::vector<Body> result;
    result.reserve(count * mesh_.bodies.size());
    for (std::size_t c = 0; c < count; ++c)
        for (const io::NamedBody& body : mesh_.bodies)
            result.push_back({.shape = body.shape, .world = static_cast<std::int32_t>(c), .self = self});
    for (const BodyPair& pair : excluded_)
        for (std::size_t c = 0; c < count && pair.first == pair.second; ++c)
            result[c * mesh_.bodies.size() + static_cast<std::size_t>(pair.first)].self = false;
    return result;
}

std::vector<BodyPair> BodyScene::excluded(std::size_t count) const {
    std::vector<BodyPair> result;
    const auto n = static_cast<std::int32_t>(mesh_.bodies.size());
    for (std::int32_t c = 0; c < static_cast<std::int32_t>(count); ++c)
        for (const BodyPair& pair : excluded_)
            if (pair.first != pair.second) result.push_back({c * n + pair.first, c * n + pair.second});
    return result;
}

std::vector<Pose> BodyScene::read_poses(const std::string& path) const {
    std::vector<Pose> poses =
        is_standard(path) ? io::read_poses(std::cin, "standard input", names()) : io::read_poses(path, names());
    if (names().empty() && !poses.empty()) refuse("--poses " + path + ": the files hold no body to pose");
    return poses;
}

void BodyScene::print_skipped(const std::set<std::int32_t>& bodies, const char* consequence) const {
    std::vector<std::string> skipped;
    skipped.reserve(bodies.size());
    for (const std::int32_t body : bodies) skipped.push_back(quoted_name(names()[static_cast<std::size_t>(body)]));
    if (skipped.empty()) return;
    print_note(fmt::format("{} not closed, and {}: {}", skipped.size() == 1 ? "this body is" : "these bodies are",
                           consequence, fmt::join(skipped, ", ")));
}

}  // namespace crumple::cli
