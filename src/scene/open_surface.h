#pragma once

// Error for a surface that must be closed and is not.

#include <cstdint>
#include <string>

#include "crumple/error.h"
#include "crumple/open_edges.h"

namespace crumple {

/// Throws the error. `edges`: number of open edges of the body, `first`: the lowest of them. `query`: name of the query
/// whose options the message mentions.
[[noreturn]] inline void fail_open_surface(std::int32_t body, std::size_t edges, const OpenEdge& first,
                                           const std::string& query) {
    throw Error(
        ErrorCode::invalid_argument,
        "body " + std::to_string(body) + ": its surface is not closed: " + std::to_string(edges) +
            " edges occur in its triangles more often in one direction than in the other, the first between vertices " +
            std::to_string(first.edge.a) + " and " + std::to_string(first.edge.b) + ", of triangle " +
            std::to_string(first.triangle) + "; open_edges lists them all, " + query + "::weld closes seams, " + query +
            "::open leaves such bodies out",
        Element::body, body);
}

}  // namespace crumple
