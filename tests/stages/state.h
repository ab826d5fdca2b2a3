#pragma once

// Results of all stages of a search, in one form for all backends, so that one test checks a stage's guarantee for all
// of them (ARCHITECTURE.md, Stages). Each backend has an adapter: cpu.cpp runs the kernels of each instruction set,
// cuda.cu the kernels of the device.

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

/// State of one leaf. Pairs are pairs of triangles, lower id first. Each comment begins with the stage that makes the
/// array.
struct LeafState {
    std::vector<std::int32_t> member;  ///< subdivide: triangles of the leaf
    std::vector<Pair> owned;           ///< subdivide: pairs of members that are not both in an earlier cluster too; for
                                       ///< two meshes, only pairs of different meshes
    LeafFrame frame;                   ///< align: origin and axes of the leaf, along which boxes are made
    std::vector<Box> box;              ///< align: box of each member, with its margin; infinite along axes for which
                                       ///< the backend stores no bounds
    std::vector<Pair> met;             ///< sort: pairs of each row and the later rows before its `end`
    std::vector<Pair> candidates;      ///< sweep: all pairs that it lists by boxes and ownership; the first filters of
                                       ///< `narrow`, which cuda runs in the same kernel, are off
    bool sweep_checks_owners = true;   ///< true if the sweep drops all pairs that other leaves own; otherwise `narrow`
                                       ///< drops those that the sweep has kept
    std::vector<Pair> found;           ///< narrow: colliding pairs, lower id first
};

struct StageState {
    std::vector<Vec3d> point;  ///< bounds: normalised vertices; in moving scenes followed by the vertices at t1
    std::vector<Ball> ball;    ///< bounds: ball of each triangle
    std::vector<LeafState> leaves;
    Intersections result;  ///< output: result from the pairs of all leaves
};

struct StageBackend {
    std::string name;
    std::function<StageState(const PreparedScene&, const Options&)> run;
    bool moves = false;  ///< true if `run` accepts moving scenes; it runs them up to `sweep`
};
inline void PrintTo(const StageBackend& backend, std::ostream* out) { *out << backend.name; }
std::vector<StageBackend> stage_backends();

}  // namespace crumple::test
