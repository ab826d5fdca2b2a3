#include "cli/search.h"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <string_view>

#ifdef CRUMPLE_WITH_TBB
#include <tbb/global_control.h>
#endif

#include "cli/topology.h"
#include "crumple/error.h"

namespace crumple::cli {
namespace {

/// One integer a line. Throws Error (file, format) that names the line.
std::vector<std::int32_t> read_groups(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw Error(ErrorCode::file, "cannot read " + path);
    std::vector<std::int32_t> groups;
    for (std::string line; std::getline(in, line);) {
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
        const char* const end = line.data() + line.size();
        std::int32_t group = 0;
        const auto [last, error] = std::from_chars(line.data(), end, group);
        if (error != std::errc() || last != end) {
            const auto number = static_cast<std::int64_t>(groups.size()) + 1;
            throw Error(ErrorCode::format, path + ", line " + std::to_string(number) + ": not one integer of 32 bits",
                        Element::line, number);
        }
        groups.push_back(group);
    }
    if (in.bad()) throw Error(ErrorCode::file, "cannot read " + path);
    return groups;
}

void group_by_components(Input& input) {
    const std::int32_t count = label_components(input.first, input.first.groups);
    if (!input.second) return;
    label_components(*input.second, input.second->groups);
    for (std::int32_t& group : input.second->groups) group += count;
}

void group_by_file(Input& input, const std::string& path) {
    const std::vector<std::int32_t> groups = read_groups(path);
    if (static_cast<std::int64_t>(groups.size()) != input.triangle_count()) {
        throw Error(ErrorCode::format, path + ": " + std::to_string(groups.size()) + " groups for " +
                                           std::to_string(input.triangle_count()) + " triangles");
    }
    const auto middle = groups.begin() + input.first.triangle_count();
    input.first.groups.assign(groups.begin(), middle);
    if (input.second) input.second->groups.assign(middle, groups.end());
}

}  // namespace

io::ReadOptions read_options(const ReadingOptions& options) {
    const io::Weld weld = !options.weld ? io::Weld::automatic : *options.weld ? io::Weld::yes : io::Weld::no;
    return {.precision = options.precision, .weld = weld};
}

Input read_input(const std::vector<std::string>& files, const AnswerOptions& options) {
    io::ReadOptions how = read_options(options);
    const bool components = options.groups == "components";
    const bool from_file = !components && std::filesystem::exists(options.groups);
    if (!components && !from_file) how.group_property = options.groups;

    Input input{files[0], io::read_mesh(files[0], how), {}};
    if (files.size() > 1) {
        input.name += ", " + files[1];
        input.second = io::read_mesh(files[1], how);
    }
    if (components) group_by_components(input);
    if (from_file) group_by_file(input, options.groups);
    return input;
}

// The library never raises the number of threads that oneTBB allows in the process; that is for its user to do.
struct Search::Threads {
#ifdef CRUMPLE_WITH_TBB
    explicit Threads(int count)
        : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)) {}
    tbb::global_control control;
#else
    explicit Threads(int) {}
#endif
};

Search::Search(const AnswerOptions& answer, const Options& options)
    : answer_(answer),
      threads_(options.threads ? std::make_unique<Threads>(options.threads) : nullptr),
      detector_((answer.check(), check_cost_options(options), options)) {}

Search::~Search() = default;

const Collisions& Search::find(const Input& input) {
    Query query;
    query.neighbours = answer_.neighbours;
    query.intersections = answer_.intersections;
    query.weld = answer_.weld.value_or(false);
    query.contacts = answer_.contacts;
    query.wanted = answer_.wanted.value_or(Wanted::both);
    const MeshView a = input.first.view();
    const MeshView b = input.second ? input.second->view() : MeshView();
    try {
        if (!answer_.part) return input.second ? detector_.find_between(a, b, query) : detector_.find_self(a, query);
        const auto [index, count] = *answer_.part;
        const auto parts = input.second ? detector_.partition(a, b, count) : detector_.partition(a, count);
        const Part& part = parts[static_cast<std::size_t>(index) - 1];
        return input.second ? detector_.find_between(a, b, part, query) : detector_.find_self(a, part, query);
    } catch (const Error& error) {
        throw Error(error.code, input.name + ": " + error.what(), error.element, error.index, error.bytes_needed);
    }
}

}  // namespace crumple::cli
