#pragma once

// Impacts and near pairs: the rows of all ranks together. Ranks have those of vertices and edges that their triangles
// own, whatever numbers these have; lists are in the order of these numbers. So rows change hands once more.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cli/ranks/rank_input.h"
#include "cli/ranks/rank_link.h"
#include "cli/ranks/rank_output.h"
#include "crumple/distributed.h"
#include "crumple/io_features.h"

namespace crumple::cli {

/// A row of one kind on its way.
struct TravellingRow {
    Pair pair;
    std::array<Edge, 2> ends;  ///< of edges, their vertices
    double value;              ///< time, or squared distance
    std::uint8_t flag;         ///< they touch, at the start
};

/// This rank's piece of each list, by FeatureKind: the pieces of the ranks follow each other.
using OrderedRows = std::array<std::vector<TravellingRow>, feature_kinds>;

/// Collective.
OrderedRows in_order(RankLink& link, const DistributedImpacts& found);
OrderedRows in_order(RankLink& link, const DistributedProximities& found);

/// This rank's piece of each list as .txt or .csv; rank 0 begins with what stands before all rows. `rows`: kept by
/// reference.
RankText text_of(const RankLink& link, const OrderedRows& rows, io::ListKind of, io::PairFormat format);

/// Collective. On rank 0 the edges of all triangles, as one process numbers them.
Array<Edge> collect_edges(RankLink& link, const RankInput& input);

/// Collective. On rank 0 the lists, with all edges.
void collect(RankLink& link, const OrderedRows& rows, const RankInput& input, Impacts& all);
void collect(RankLink& link, const OrderedRows& rows, const RankInput& input, Proximities& all);

}  // namespace crumple::cli
