// Impacts, near pairs and candidates as NumPy arrays.

#include "io/bytes/npz.h"
#include "io/lists/feature_list_view.h"

namespace crumple::io {

namespace {

/// `pairs`: refered to until the archive is written.
void add_list(NpzWriter& archive, const FeatureAnswer& answer, CandidateKind kind, std::vector<Pair>& pairs) {
    const FeatureListView& list = answer[kind];
    if (!list.listed) return;
    for (std::size_t i = 0; i < list.pairs.size(); ++i) pairs.push_back(answer.by_vertex(kind, i));
    archive.add<std::int32_t>(array_of(kind).c_str(), pairs.data(), pairs.size(), 2);
    if (answer.has_bodies())
        archive.add<std::int32_t>(array_of(kind, "bodies").c_str(), list.bodies.data(), list.bodies.size(), 2);
    if (!answer.words.has_values()) return;
    archive.add<double>(array_of(kind, answer.words.value).c_str(), list.values.data(), list.values.size());
    archive.add<std::uint8_t>(array_of(kind, answer.words.flag).c_str(), list.flags.data(), list.flags.size());
}

void add_edges(NpzWriter& archive, const FeatureAnswer& answer) {
    archive.add<std::int32_t>("edges", answer.edges.data(), answer.edges.size(), 2);
    if (answer.has_bodies())
        archive.add<std::int64_t>("first_edge", answer.first_edge.data(), answer.first_edge.size());
}

}  // namespace

void write_features_npz(std::ostream& out, const FeatureAnswer& answer) {
    NpzWriter archive;
    std::array<std::vector<Pair>, candidate_kinds> pairs;
    for (const CandidateKind kind : all_kinds) {
        if (kind == CandidateKind::edge_edge && answer.lists_edges()) add_edges(archive, answer);
        add_list(archive, answer, kind, pairs[static_cast<std::size_t>(kind)]);
    }
    archive.write(out);
}

}  // namespace crumple::io
