// Impacts and near pairs as NumPy arrays.

#include "io/feature_answer.h"
#include "io/npz.h"

namespace crumple::io {

namespace {

/// `pairs`: refered to until the archive is written.
void add_list(NpzWriter& archive, const FeatureAnswer& answer, FeatureKind kind, std::vector<Pair>& pairs) {
    const FeatureListView& list = answer.lists[static_cast<std::size_t>(kind)];
    for (std::size_t i = 0; i < list.pairs.size(); ++i) pairs.push_back(answer.by_vertex(kind, i));
    archive.add<std::int32_t>(array_of(kind).c_str(), pairs.data(), pairs.size(), 2);
    if (answer.has_bodies())
        archive.add<std::int32_t>(array_of(kind, "bodies").c_str(), list.bodies.data(), list.bodies.size(), 2);
    archive.add<double>(array_of(kind, answer.words.value).c_str(), list.values.data(), list.values.size());
    archive.add<std::uint8_t>(array_of(kind, answer.words.flag).c_str(), list.flags.data(), list.flags.size());
}

}  // namespace

void write_features_npz(std::ostream& out, const FeatureAnswer& answer) {
    NpzWriter archive;
    std::array<std::vector<Pair>, feature_kinds> pairs;
    add_list(archive, answer, FeatureKind::vertex_face, pairs[0]);
    archive.add<std::int32_t>("edges", answer.edges.data(), answer.edges.size(), 2);
    if (answer.has_bodies())
        archive.add<std::int64_t>("first_edge", answer.first_edge.data(), answer.first_edge.size());
    add_list(archive, answer, FeatureKind::edge_edge, pairs[1]);
    add_list(archive, answer, FeatureKind::vertex_edge, pairs[2]);
    add_list(archive, answer, FeatureKind::vertex_vertex, pairs[3]);
    archive.write(out);
}

}  // namespace crumple::io
