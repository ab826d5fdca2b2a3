#pragma once

// Choices of the host before a pass: the number of clusters of each level, and the capacity of each list. Only the
// device learns how long the lists get; its counters show after the pass whether the capacities sufficed.

#include <algorithm>
#include <cstdint>

#include "backends/cuda/stages/layout.h"
#include "crumple/options.h"
#include "partition/fuzzy_c_means.h"

namespace crumple::cuda {

struct Plan {
    int worlds = 1;             ///< worlds side by side, each subdivided separately
    int fan_out[2] = {0, 0};    ///< children of each world, and of each of its clusters; 0: no such level
    bool cold = true;           ///< no earlier centres to start from
    bool warm_started = false;  ///< warm-started: the previous pass has left centres, places and frames (WarmStart)
    unsigned long long members[2] = {0, 0};  ///< capacities: places of each level's members
    unsigned long long units = 0;
    unsigned long long survivors = 0, undecided = 0, beyond = 0, hits = 0;
    unsigned long long tests[feature_kinds] = {}, open[feature_kinds] = {};  ///< for feature queries, by kind

    friend bool operator==(const Plan&, const Plan&) = default;

    int levels() const { return fan_out[1] > 0 ? 2 : 1; }
    int leaves_a_world() const { return fan_out[0] * std::max(1, fan_out[1]); }
    int leaves() const { return worlds * leaves_a_world(); }
    /// Returns the number of clusters of a level, in all worlds.
    int children(int level) const { return worlds * fan_out[0] * (level == 0 ? 1 : fan_out[1]); }
    unsigned long long last_members() const { return members[levels() - 1]; }

    /// Chooses clusters and capacities for a scene of n triangles unlike the previous one. `between`: two meshes.
    void choose(std::int64_t n, bool between, const Options& options) {
        *this = {};
        const std::int64_t leaves = std::max<std::int64_t>(1, (n + options.leaf_size - 1) / options.leaf_size);
        const std::int64_t most = between ? max_fan_out_between : max_fan_out;
        fan_out[0] = static_cast<int>(options.clusters > 0 ? std::min<std::int64_t>(options.clusters, most)
                                                           : std::min(leaves, most));
        if (leaves > fan_out[0]) fan_out[1] = static_cast<int>(std::min((leaves + fan_out[0] - 1) / fan_out[0], most));
        reserve(n, 1024);
    }

    /// Chooses clusters and capacities for `count` worlds side by side with n triangles in all. The largest world, with
    /// `largest` triangles, determines how many clusters each world gets.
    void choose_worlds(std::int64_t n, int count, std::int64_t largest, const Options& options) {
        choose(largest, false, options);
        worlds = count;
        fan_out[0] = std::min(fan_out[0], max_leaves / worlds);
        fan_out[1] = std::min(fan_out[1], max_leaves / children(0));
        if (fan_out[1] < 2) fan_out[1] = 0;
        // Each leaf's members, and its units, are rounded up to whole warps.
        reserve(n, 1024 + 64 * static_cast<unsigned long long>(leaves()));
    }
    /// Chooses clusters and capacities for a feature query. `all_kinds`: codimensional edges or points, which
    /// the caller lists, add tests of further kinds.
    void choose_features(std::int64_t n, bool all_kinds, const Options& options) {
        choose(n, false, options);
        for (std::size_t k = 0; k < (all_kinds ? feature_kinds : 2u); ++k)
            tests[k] = open[k] = survivors / (k < 2 ? 4 : 16) + 1024;
        undecided = 0;
    }

    /// Chooses short lists for a search in chunks, in slices: as many candidates as `bytes` hold, but no fewer than one
    /// unit can have.
    void choose_chunks(std::int64_t n, bool between, const Options& options, std::int64_t bytes) {
        constexpr unsigned long long least = 32ull * unit_columns, each = 2 * sizeof(Candidate) + sizeof(Pair);
        choose(n, between, options);
        const unsigned long long candidates =
            std::clamp(static_cast<unsigned long long>(bytes) / each, least, std::max(least, survivors));
        members[0] = members[1] = 1024;
        units = 1024;
        survivors = undecided = beyond = candidates;
        hits = 0;
    }

    /// Chooses clusters and capacities for a candidate query: most pairs of triangles whose boxes overlap yield pairs
    /// of features.
    void choose_candidates(std::int64_t n, const Options& options) {
        choose(n, false, options);
        survivors *= 4;
        hits = 2 * survivors;
        undecided = beyond = 0;
    }
    /// Chooses short lists for a candidate query in chunks: a pair of triangles has at most 49 pairs of features, and a
    /// single triangle at most 12.
    void choose_candidate_chunks(std::int64_t n, const Options& options, std::int64_t bytes, std::size_t bytes_of_hit) {
        choose_chunks(n, false, options, 0);
        const unsigned long long least = survivors, each = sizeof(Candidate) + 49 * bytes_of_hit;
        survivors = std::clamp(static_cast<unsigned long long>(bytes) / each, least,
                               std::max(least, 4ull * static_cast<unsigned long long>(n)));
        hits = std::max(49 * survivors, 12ull * static_cast<unsigned long long>(n));
        undecided = beyond = 0;
    }

    /// Chooses short lists for a feature query in chunks: a pair of triangles expands to at most 15 tests, or 20 with
    /// all kinds.
    void choose_feature_chunks(std::int64_t n, bool all_kinds, const Options& options, std::int64_t bytes,
                               std::size_t bytes_of_test) {
        constexpr unsigned long long most[feature_kinds] = {6, 9, 4, 1};
        const unsigned long long together = all_kinds ? 20 : 15;
        choose_chunks(n, false, options, 0);
        const unsigned long long least = survivors, each = sizeof(Candidate) + together * bytes_of_test;
        survivors = std::clamp(static_cast<unsigned long long>(bytes) / each, least,
                               std::max(least, 4ull * static_cast<unsigned long long>(n)));
        for (std::size_t k = 0; k < (all_kinds ? feature_kinds : 2u); ++k) tests[k] = open[k] = most[k] * survivors;
        beyond = hits = together * survivors;
        undecided = 0;
    }

    /// Returns false, and changes the plan, if a list of members was too short or triangles joined too many clusters
    /// (docs/subdivide.md).
    bool accepts_members(const Counters& c, std::int64_t n, const Options& options) {
        // The scene has jumped, or triangles have crowded together: the next pass finds places and centres anew.
        if (warm_started && c.unplaced[0] + c.unplaced[1] > 0) {
            warm_started = false;
            return false;
        }
        // Tolerates 64 extra memberships, so that scenes of very few triangles pass.
        const auto pays = [](unsigned long long joined, unsigned long long items, int k) {
            return splitting_pays(static_cast<double>(joined) - 64, static_cast<double>(items), k);
        };
        if (options.clusters == 0 && fan_out[0] > 1 &&
            !pays(c.members[0], static_cast<unsigned long long>(n), fan_out[0])) {
            fan_out[0] /= 2;
            start_anew();
            return false;
        }
        if (!accepts_places(c, 0)) return false;
        if (levels() == 1) return true;
        if (fan_out[1] > 1 && !pays(c.members[1], c.members[0], fan_out[1])) {
            fan_out[1] = fan_out[1] > 3 ? fan_out[1] / 2 : 0;
            start_anew();
            return false;
        }
        return accepts_places(c, 1);
    }

    /// Returns true if accepts_members() does and all other lists were long enough; else grows those that were too
    /// short. `listed`: true if hits were listed.
    bool accepts(const Counters& c, std::int64_t n, const Options& options, bool listed = true) {
        if (!accepts_members(c, n, options)) return false;
        bool fits = grow(units, c.units);
        fits = grow(survivors, c.survivors) && fits;
        fits = grow(undecided, c.undecided) && fits;
        fits = grow(beyond, c.beyond) && fits;
        for (std::size_t k = 0; k < feature_kinds; ++k) {
            fits = grow(tests[k], c.tests[k]) && fits;
            fits = grow(open[k], c.open[k]) && fits;
        }
        return (!listed || grow(hits, c.hits)) && fits;
    }

    bool accepts_hits(unsigned long long wanted) { return grow(hits, wanted); }

    /// Returns true if the members of a chunk, which is one cluster, had enough places. Does not judge the split into
    /// clusters, about which one cluster says nothing.
    bool accepts_chunk(const Counters& c) { return accepts_places(c, 0) && (levels() == 1 || accepts_places(c, 1)); }
    /// Returns true if the units of a sorted chunk fit their list.
    bool accepts_units(const Counters& c) { return grow(units, c.units); }

   private:
    void reserve(std::int64_t n, unsigned long long spare) {
        const auto count = static_cast<unsigned long long>(n);
        members[0] = members[1] = count + 3 * count / 4 + spare;
        units = count / 2 + spare;
        survivors = 4 * count + 1024;
        undecided = count / 2 + 1024;
        beyond = 1024;
        hits = count + 1024;
    }
    void start_anew() {
        cold = true;
        warm_started = false;
    }
    // A warm-started pass that has placed all members had enough places; its counters of places are for the next pass.
    bool accepts_places(const Counters& c, int level) { return warm_started || grow(members[level], c.places[level]); }
    static bool grow(unsigned long long& capacity, unsigned long long wanted) {
        if (wanted <= capacity) return true;
        capacity = wanted + wanted / 4;
        return false;
    }
};

}  // namespace crumple::cuda
