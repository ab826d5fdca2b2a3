#include "backends/cpu/candidates/find_candidates.h"

#include <algorithm>

namespace crumple::cpu {
namespace {

// Finds pairs of features that one triangle owns: two vertices, or a vertex and the opposite edge; with neighbours, any
// two.
void search_within(const Call& call, const FeatureRequest& query, CandidateLeaves& leaves) {
    const bool has_pairs = query.lists(CandidateKind::vertex_vertex) || query.lists(CandidateKind::vertex_edge);
    if (!has_pairs && !query.neighbours) return;
    const std::int64_t n = call.scene.triangle_count();
    if (call.low_memory && !call.units) return leaves.search_within(0, n, 0);
    constexpr std::int64_t chunk = 4096;
    for_each_unit(call, static_cast<std::size_t>((n + chunk - 1) / chunk), [&](std::size_t c, std::size_t w) {
        const std::int64_t begin = static_cast<std::int64_t>(c) * chunk;
        leaves.search_within(begin, std::min(n, begin + chunk), w);
    });
}

// Runs stage `output` for one kind.
void sort_candidates(const Call& call, const FeatureRequest& query, CandidateKind kind, CandidateBuffers& buffers,
                     Array<Pair>& pairs) {
    const auto count = [&](FeatureType type) { return static_cast<std::int32_t>(count_of(query.features, type)); };
    const FeatureTypes types = types_of(kind);
    const PairCounts counts{count(types.first), count(types.second), 0, call.low_memory};
    const auto nothing = [](std::span<const std::span<const Pair>>) {};
    // In a low-memory call, the first worker has found all pairs. The lists of the other workers are left out, as they
    // would make memory depend on the number of workers.
    const auto found = buffers.leaves.found(kind);
    sort_pairs(call.workers, call.low_memory ? found.first(1) : found, counts, buffers.sorting, pairs, buffers.offsets,
               nothing);
}

}  // namespace

void search_candidates(const Call& call, const FeatureRequest& query, CandidateLeaves& leaves) {
    search(call);
    search_within(call, query, leaves);
}

void write_candidates(const Call& call, const FeatureRequest& query, CandidateBuffers& buffers, FeatureResult& result) {
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        const auto kind = static_cast<CandidateKind>(k);
        if (query.lists(kind)) sort_candidates(call, query, kind, buffers, result.rows[kind].pairs);
    }
    result.any = result.rows.size() > 0;
}

}  // namespace crumple::cpu
