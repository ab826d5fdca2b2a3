#pragma once

// Worlds of bodies read from files, with excluded pairs, and searches in one or many configurations.

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
    std::vector<std::string> excluded;  ///< "A,B"
    std::string exclude_from;           ///< a file of pairs; empty: none
    std::string poses;                  ///< a file of poses; empty: those of the files
    bool any = false;                   ///< with poses: only which configurations have a result

    /// Adds the files that these options name to `files`.
    void add_files(std::vector<std::string>& files) const;
};

/// Returns the help of an option that applies under a condition. Without a condition it begins with a capital.
std::string help_under(const std::string& condition, std::string help);

/// Words of a command for the help of these options.
struct BodyOptionWords {
    const char* condition;  ///< prefix of all helps: "With --groups bodies: "; may be empty
    const char* excluded;   ///< effect of an excluded pair: "these two bodies may collide"
    const char* rows;       ///< sentence about the rows of a configuration
};
/// Adds these options, except --any-by-world, which is for commands that list configurations. Returns the added
/// options.
std::vector<const CLI::Option*> add_body_options(CLI::App& app, BodyOptions& options, const BodyOptionWords& words);

/// World that was read from files, and searches in it.
class BodyScene {
   public:
    /// Throws Error.
    BodyScene(const std::vector<std::string>& files, const ReadingOptions& reading, const BodyOptions& options);

    const io::WorldMesh& mesh() const { return mesh_; }
    const BodyOrigins& origins() const { return origins_; }
    const std::vector<std::string>& names() const { return origins_.names; }

    /// Returns the bodies of `count` configurations, one after the other, each a world. `self`: bodies are also
    /// searched for pairs with themselves, unless these are excluded.
    std::vector<Body> bodies(std::size_t count, bool self) const;
    /// Returns the excluded pairs in `count` configurations.
    std::vector<BodyPair> excluded(std::size_t count) const;
    /// Reads a file of poses: those of each body in turn, configuration after configuration. Throws Error.
    std::vector<Pose> read_poses(const std::string& path) const;

    /// Prints which bodies are not closed, and the consequence, such as "left out".
    void print_skipped(const std::set<std::int32_t>& bodies, const char* consequence) const;

    /// Searches the configurations with these poses in batches, whose size limits the memory that they need.
    /// query_of(count) returns the query for a batch; take(found, first, count) consumes its result, and returns true
    /// to continue.
    template <class QueryOf, class Take>
    void search_all(Search& search, const std::vector<Pose>& poses, bool self, QueryOf query_of, Take take) const;

   private:
    BodyOrigins origins_;  // before mesh_, whose initialisation fills them
    io::WorldMesh mesh_;
    std::vector<BodyPair> excluded_;
};

template <class QueryOf, class Take>
void BodyScene::search_all(Search& search, const std::vector<Pose>& poses, bool self, QueryOf query_of,
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
