#pragma once

// What the stages of a backend leave behind, in one form for all backends, so that a stage's promise is one test
// (ARCHITECTURE.md, Stages). A backend brings an adapter: cpu.cpp runs each table of kernels, cuda.cu the kernels of
// the device.

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

/// Of scenes that move it is asked which features come within this distance of each other.
inline constexpr double asked_distance = 0.01;

struct Box {
    Vec3d low, high;
};

/// Of one leaf. Pairs are of triangles, lower id first.
struct LeafState {
    std::vector<std::int32_t> member;  ///< subdivide: triangles
    std::vector<Pair> owned;       ///< subdivide: pairs of members that no lower cluster holds; across, of two meshes
    LeafFrame frame;               ///< align
    std::vector<Box> box;          ///< align: by member, with its margin; infinite along an axis without one
    std::vector<Pair> met;         ///< sort: pairs that the rows bring together
    std::vector<Pair> candidates;  ///< sweep, with a filter that keeps all
    bool sweep_asks_all = true;    ///< the sweep knows all about owners; otherwise `narrow` drops the rest
    std::vector<Pair> found;       ///< narrow: those that collide; lower id first
};

struct StageState {
    std::vector<Vec3d> point;  ///< bounds: normalised vertices; if they move, then those at the end
    std::vector<Ball> ball;    ///< bounds: by triangle
    std::vector<LeafState> leaves;
    Intersections answer;  ///< output, of what the leaves found
};

struct StageBackend {
    std::string name;
    std::function<StageState(const PreparedScene&, const Options&)> run;
    bool moves = false;  ///< also runs scenes that move, up to `sweep`
};
inline void PrintTo(const StageBackend& backend, std::ostream* out) { *out << backend.name; }
std::vector<StageBackend> stage_backends();

}  // namespace crumple::test
