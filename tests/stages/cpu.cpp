// Runs the stages of the cpu backend, with the kernels of each instruction set that the machine supports.

#include <limits>

#include "backends/cpu/features/find_features.h"
#include "backends/cpu/intersections/intersection_narrow.h"
#include "backends/cpu/intersections/intersection_records.h"
#include "backends/cpu/stages/align.h"
#include "backends/cpu/stages/bounds.h"
#include "backends/cpu/stages/output.h"
#include "backends/cpu/stages/ownership.h"
#include "backends/cpu/stages/sort.h"
#include "backends/cpu/stages/sweep.h"
#include "base/float_environment.h"
#include "cpu/tables.h"
#include "stages/state.h"

namespace crumple::test {
namespace {

using namespace cpu;

Pair ordered(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Scratch and results of one run.
struct Run {
    const Tables& tables;
    const PreparedScene& scene;
    const Options& options;
    const SceneFeatures& features;
    const Inflation inflation;
    Points points{nullptr};
    Array<Ball> balls{nullptr};
    Array<std::uint8_t> included{nullptr};  ///< 1 for each triangle that the stages search, else 0; empty: all
    Subdivision subdivision{nullptr};

    PointRows rows() const {
        return scene.float32 ? PointRows{points.f.data(), nullptr} : PointRows{nullptr, points.d.data()};
    }

    LeafState leaf(const Leaf& leaf, Cancellation& cancellation) const {
        LeafState state;
        LeafMembers members(nullptr);
        members.gather(scene, subdivision, leaf);
        state.member.assign(members.triangle.begin(), members.triangle.begin() + members.size());
        if (members.size() < 2) return state;
        Ownership ownership(scene, Levels(), subdivision, leaf);
        ownership.bits(members.triangle.data(), members.member.data(), members.size(), false, members.lower.data());
        state.sweep_checks_owners = ownership.complete();
        for (std::int64_t i = 0; i < members.size(); ++i)
            for (std::int64_t j = i + 1; j < members.size(); ++j) {
                const std::int32_t a = members.triangle[i], b = members.triangle[j];
                const bool ours = !(members.lower[i] & members.lower[j]) &&
                                  ownership.owns(a, members.member[i], b, members.member[j]);
                if (ours && (!scene.between || scene.second(a) != scene.second(b)))
                    state.owned.push_back(ordered(a, b));
            }

        state.frame = leaf_frame(balls, rows(), scene.corners, members);
        LeafRecords records(nullptr);
        const FlushToZero mode;
        const BuildInput input{rows(),
                               scene.corners,
                               scene.triangle_count(),
                               members.triangle.data(),
                               members.size(),
                               state.frame,
                               scene.moving ? scene.vertex_count() : 0,
                               inflation};
        if (scene.moving) {
            Array<FeatureRecord<2>> moving(nullptr);
            moving.resize_discard(state.member.size() + padding);
            tables.features.moving.build(input, features, moving.data(), members.boxes, members.bounds);
        } else {
            records.build(tables.intersect, input, members);
        }
        const double margin = static_cast<double>(box_margin(members.bounds.reach));
        for (std::size_t i = 0; i < state.member.size(); ++i) {
            const BoxCorner low = members.boxes.low[i], high = members.boxes.high[i];
            state.box.push_back({{low.x - margin, low.y - margin, low.z - margin},
                                 {high.x + margin, high.y + margin, high.z + margin}});
        }

        SortScratch scratch(nullptr);
        SortedLeaf sorted(nullptr);
        sort_leaf(members, tables.stages, scratch, sorted);
        const auto triangle = [&](std::int64_t row) { return sorted.link[row].triangle; };
        for (std::int64_t row = 0; row < sorted.rows; ++row)
            for (std::int64_t column = sorted.begin_of(row); column < sorted.link[row].end; ++column)
                if (triangle(row) >= 0 && triangle(column) >= 0)
                    state.met.push_back(ordered(triangle(row), triangle(column)));

        CandidateChunk candidates(nullptr);
        sweep_chunks(
            tables.stages, sorted, 0, sorted.rows, candidates, [] { return false; },
            [&] {
                for (std::int64_t i = 0; i < candidates.count; ++i)
                    if (candidates.column[i] != candidates.dummy)
                        state.candidates.push_back(ordered(triangle(candidates.rows + candidates.row[i]),
                                                           triangle(candidates.columns + candidates.column[i])));
            });

        if (scene.moving) return state;
        records.sort(tables.intersect, sorted);
        const IntersectionQuery query;
        const SceneFilter all;
        NarrowScratch narrow(nullptr);
        sweep_and_narrow({scene, query, all, tables.stages, tables.intersect, rows(), cancellation}, sorted, records,
                         ownership, 0, sorted.rows, narrow);
        state.found.assign(narrow.pairs.begin(), narrow.pairs.end());
        return state;
    }
};

StageState run_stages(const Tables& tables, const PreparedScene& scene, const Options& options) {
    Cancellation cancellation;
    Options alone = options;
    alone.threads = 1;
    Workers workers(alone, cancellation);
    StageState state;
    workers.run([&] {
        SceneFeatures features(nullptr);
        Inflation inflation;
        const SceneFilter rule;
        if (scene.moving) {
            ParallelFor serial;
            features.prepare(scene, false, serial);
            inflation = inflation_of(scene, {.distance = query_distance, .features = features, .rule = rule});
        }
        Run run{tables, scene, options, features, inflation};
        compute_bounds(scene, inflation, tables.stages, workers, run.points, run.balls);
        const PointRows rows = run.rows();
        for (std::int32_t v = 0; v < scene.vertex_count() * (scene.moving ? 2 : 1); ++v) state.point.push_back(rows[v]);
        state.ball.assign(run.balls.begin(), run.balls.begin() + scene.triangle_count());
        if (scene.between) exclude_far(scene, workers, run.balls, run.included);
        WarmCentres warm;
        place_clusters(run.balls, scene.triangle_count(), run.included.empty() ? nullptr : run.included.data(), options,
                       tables.stages, workers, warm, run.subdivision);
        gather_leaves(run.balls, scene.triangle_count(), 0, run.subdivision.clusters, options, tables.stages, workers,
                      warm, run.subdivision);
        std::vector<Array<Pair>> lists;  // one list per leaf, as if each leaf had had a worker of its own
        for (const Leaf& leaf : run.subdivision.leaves) {
            state.leaves.push_back(run.leaf(leaf, cancellation));
            for (Array<Pair>& list = lists.emplace_back(); const Pair& pair : state.leaves.back().found)
                list.push_back(pair);
        }
        std::vector<const Array<Pair>*> found;
        for (const Array<Pair>& list : lists) found.push_back(&list);
        OutputScratch scratch(nullptr);
        write_output(scene, workers, found, scratch, state.result);
    });
    return state;
}

}  // namespace

std::vector<StageBackend> stage_backends() {
    std::vector<StageBackend> backends;
    for (const Tables& tables : kernel_tables())
        backends.push_back({tables.name,
                            [tables](const PreparedScene& scene, const Options& options) {
                                return run_stages(tables, scene, options);
                            },
                            true});
    return backends;
}

}  // namespace crumple::test
