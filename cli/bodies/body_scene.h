#pragma once

// Worlds of bodies that files hold: which pairs of bodies count, and in which configurations they are searched.

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

    /// Adds the files that these options name.
    void add_files(std::vector<std::string>& files) const;
};

/// The help of an option that there is under a condition; without one it begins with a capital.
std::string help_under(const std::string& condition, std::string help);

/// Words of a command for the help of these options.
struct BodyOptionWords {
    const char* condition;  ///< of all of them: "With --groups bodies: "; may be empty
    const char* excluded;   ///< of pairs that are left out: "these two bodies may collide"
    const char* rows;       ///< sentence about the rows of a configuration
};
/// Adds all of them but --any-by-world, which is for commands that list configurations. Returns the options that were
/// added.
std::vector<const CLI::Option*> add_body_options(CLI::App& app, BodyOptions& options, const BodyOptionWords& words);

/// World that was read from files, and queries of it.
class BodyScene {
   public:
    /// Throws Error.
    BodyScene(const std::vector<std::string>& files, const ReadingOptions& reading, const BodyOptions& options);

    const io::WorldMesh& mesh() const { return mesh_; }
    const BodyOrigins& origins() const { return origins_; }
    const std::vector<std::string>& names() const { return origins_.names; }

    /// Bodies of `count` configurations, each a world, whose bodies follow those of the one before. `self`: they are
    /// also searched for what they do with themselves, unless that is excluded.
    std::vector<Body> bodies(std::size_t count, bool self) const;
    /// The pairs that are excluded, in `count` configurations.
    std::vector<BodyPair> excluded(std::size_t count) const;
    /// Reads a file of poses: those of each body in turn, configuration after configuration. Throws Error.
    std::vector<Pose> read_poses(const std::string& path) const;

    /// Tells which bodies are not closed, and what follows: "left out".
    void print_skipped(const std::set<std::int32_t>& bodies, const char* consequence) const;

    /// Searches the configurations with these poses, as many at once as take little memory beside the shapes.
    /// query_of(count) returns the query of so many configurations; take(found, first, count) takes their result, and
    /// returns whether to go on.
    template <class QueryOf, class Take>
    void search_all(Search& search, const std::vector<Pose>& poses, bool self, QueryOf query_of, Take take) const;

   private:
    BodyOrigins origins_;  // before the mesh, whose reader fills them
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
