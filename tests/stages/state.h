#pragma once

// State that the stages of a backend leave behind, in one form for all backends, so that a stage's guarantee is one
// test (ARCHITECTURE.md, Stages). Each backend has an adapter: cpu.cpp runs each table of kernels, cuda.cu the kernels
// of the device.

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "crumple/intersections.h"
#include "crumple/options.h"
#include "geometry/ball.h"
#include "geometry/leaf_frame.h"
#include "scene/prepared_scene.h"

namespace crumple::test {

/// Distance of the query about moving scenes: features that come within it are near.
inline constexpr double query_distance = 0.01;

struct Box {
    Vec3d low, high;
};

/// State of one leaf. Pairs are pairs of triangles, lower id first.
struct LeafState {
    std::vector<std::int32_t> member;  ///< subdivide: triangles
    std::vector<Pair> owned;           ///< subdivide: pairs of members that no lower cluster contains; for two meshes,
                                       ///< pairs across them
    LeafFrame frame;                   ///< align
    std::vector<Box> box;              ///< align: by member, with its margin; infinite along an axis without one
    std::vector<Pair> met;             ///< sort: pairs of each row and the rows of its range
    std::vector<Pair> candidates;      ///< sweep, with a filter that keeps all
    bool sweep_checks_owners = true;   ///< true if the sweep drops all pairs of other leaves; otherwise `narrow` drops
                                       ///< the rest
    std::vector<Pair> found;           ///< narrow: colliding pairs, lower id first
};

struct StageState {
    std::vector<Vec3d> point;  ///< bounds: normalised vertices; in moving scenes followed by those at the end
    std::vector<Ball> ball;    ///< bounds: by triangle
    std::vector<LeafState> leaves;
    Intersections result;  ///< output: result from the pairs of all leaves
};

struct StageBackend {
    std::string name;
    std::function<StageState(const PreparedScene&, const Options&)> run;
    bool moves = false;  ///< also runs moving scenes, up to `sweep`
};
inline void PrintTo(const StageBackend& backend, std::ostream* out) { *out << backend.name; }
std::vector<StageBackend> stage_backends();

}  // namespace crumple::test
