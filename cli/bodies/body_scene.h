#pragma once

// Worlds of bodies read from files, with excluded pairs, and searches in one or many configurations (a configuration is
// a pose for each body).

#include <algorithm>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cli/bodies_of_files.h"
#include "cli/search.h"
#include "cli/terminal.h"

namespace crumple::cli {

/// Options that only worlds of bodies have.
struct BodyOptions {
    std::vector<std::string> excluded;  ///< each "A,B": names of two bodies
    std::string exclude_from;           ///< path of a file of excluded pairs; empty if the option is absent
    std::string poses;                  ///< path of a file of poses; empty: bodies have the poses of the input files
    bool any = false;                   ///< --any-by-world: lists only a flag for each configuration

    /// Appends to `files` the files that these options name.
    void add_files(std::vector<std::string>& files) const;
};

/// Returns `condition` followed by `help`, the help of an option. If `condition` is empty, the help begins with a
/// capital letter.
std::string help_under(const std::string& condition, std::string help);

/// Parts of the help of these options that differ between commands.
struct BodyOptionWords {
    const char* condition;  ///< prefix of the help, such as "With --groups bodies: "; may be empty
    const char* excluded;   ///< effect of an excluded pair: "these two bodies may collide"
    const char* rows;       ///< sentence about the rows that the command writes for a configuration
};
/// Adds --excluded-bodies and --excluded-bodies-from to a command. Returns the added options.
std::vector<const CLI::Option*> add_excluded_options(CLI::App& app, BodyOptions& options, const BodyOptionWords& words);
/// Adds the options of BodyOptions to a command, except --any-by-world, which only commands that list configurations
/// have. Returns the added options.
std::vector<const CLI::Option*> add_body_options(CLI::App& app, BodyOptions& options, const BodyOptionWords& words);

/// World that was read from files, and searches in it.
class BodyScene {
   public:
    /// Reads the files. Throws Error if a file is not valid, or if an option names a body that does not exist.
    BodyScene(const std::vector<std::string>& files, const ReadingOptions& reading, const BodyOptions& options);

    const io::WorldMesh& mesh() const { return mesh_; }
    const BodyOrigins& origins() const { return origins_; }
    const std::vector<std::string>& names() const { return origins_.names; }

    /// Returns the bodies of `count` configurations, one configuration after the other; each is a world of its own.
    /// `self`: also search for pairs within a body, unless the body is excluded as a pair with itself.
    std::vector<Body> bodies(std::size_t count, bool self) const;
    /// Returns the excluded pairs of bodies, as they are given.
    const std::vector<BodyPair>& given_excluded() const { return excluded_; }
    /// Returns the excluded pairs of different bodies in `count` configurations, with the indices of bodies().
    std::vector<BodyPair> excluded(std::size_t count) const;
    /// Reads a file of poses: one pose for each body, in their order, for each configuration. Throws Error.
    std::vector<Pose> read_poses(const std::string& path) const;

    /// Prints which bodies are not closed, and the consequence, such as "left out".
    void print_skipped(const std::set<std::int32_t>& bodies, const char* consequence) const;

    /// Searches the configurations with these poses in batches of at most 100,000 bodies, or of one configuration, to
    /// limit memory. query_of(count) returns the query for a batch of `count` configurations; take(found, first, count)
    /// consumes the result of the batch that begins with configuration `first`, and returns true to continue.
    template <class QueryOf, class Take>
    void search_all(SearchSession& search, const std::vector<Pose>& poses, bool self, QueryOf query_of,
                    Take take) const;

   private:
    BodyOrigins origins_;  // declared before mesh_, because the initialisation of mesh_ fills it
    io::WorldMesh mesh_;
    std::vector<BodyPair> excluded_;
};

template <class QueryOf, class Take>
void BodyScene::search_all(SearchSession& search, const std::vector<Pose>& poses, bool self, QueryOf query_of,
                           Take take) const {
    constexpr std::size_t bodies_at_once = 100'000;
    const io::WorldView view = mesh_.view(1);
    const std::size_t n = view.bodies.size(), configurations = n ? poses.size() / n : 0;
    std::vector<Body> all;
    decltype(query_of(std::size_t{})) query;
    Progress progress(configurations);
    for (std::size_t first = 0, count; first < configurations; first += count) {
        progress.show(first, "");
        count = std::min(configurations - first, std::max<std::size_t>(1, bodies_at_once / n));
        if (all.size() != count * n) {
            all = bodies(count, self);
            query = query_of(count);
        }
        const std::span<const Pose> batch(&poses[first * n], count * n);
        const World world{view.shapes, all, batch};
        if (!take(search.find(origins_, static_cast<std::int64_t>(first), world, query), first, count)) return;
    }
}

}  // namespace crumple::cli
