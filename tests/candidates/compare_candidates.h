#pragma once

// Comparison of complete candidate lists, byte by byte; statistics are ignored.

#include "agreement/compare.h"

namespace crumple::test {

inline const std::vector<CandidateKind>& all_candidate_kinds() {
    static const std::vector<CandidateKind> all{CandidateKind::vertex_face, CandidateKind::edge_edge,
                                                CandidateKind::edge_face,   CandidateKind::face_face,
                                                CandidateKind::vertex_edge, CandidateKind::vertex_vertex};
    return all;
}

inline testing::AssertionResult same_candidates(const Candidates& found, const Candidates& expected) {
    testing::AssertionResult same = testing::AssertionSuccess();
    for (const CandidateKind kind : all_candidate_kinds()) {
        same = same_bytes(found[kind].pairs, expected[kind].pairs, "pairs");
        if (!same && found[kind].bodies.empty())
            same << ": " << same_pairs(found[kind].pairs.span(), expected[kind].pairs.span()).message();
        if (same) same = same_bytes(found[kind].bodies, expected[kind].bodies, "bodies");
        if (!same) return same << " (" << candidate_kind_name(kind) << ')';
    }
    same = same_bytes(found.edges, expected.edges, "edges");
    if (same) same = same_bytes(found.first_edge, expected.first_edge, "first edges");
    if (same) same = same_bytes(found.points, expected.points, "points");
    if (same) same = same_bytes(found.first_point, expected.first_point, "first points");
    if (same && found.listed != expected.listed) same = testing::AssertionFailure() << "other kinds are listed";
    if (same && found.count != expected.count)
        same = testing::AssertionFailure() << "count " << found.count << " instead of " << expected.count;
    return same;
}

}  // namespace crumple::test
