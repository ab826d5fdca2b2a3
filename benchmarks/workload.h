#pragma once

// Workloads: one or two meshes, and a query about them.
//
// A workload is named [any:|between:]SCENE[:TRIANGLES][@FRAME], [any:]FILE or between:FILE,FILE. SCENE is a short name
// of files (real_scenes()) or a procedural scene of crumple::scenes; FILE is a mesh of the user. FRAME is the last
// frame by default. Without a prefix, the query of a scene from files is the one in the list of these scenes
// (workload.cpp), and that of a procedural scene is all colliding pairs of one mesh. `any` finds only whether anything
// collides. `between` makes two meshes of a procedural scene, its even and its odd groups, and finds the pairs between
// them.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "crumple/intersections.h"
#include "crumple/io.h"
#include "scenes/scenes.h"

namespace crumple::benchmark {

enum class Query : std::uint8_t {
    self,     ///< all colliding pairs of one soup
    between,  ///< all colliding pairs of a triangle of `a` and a triangle of `b`
    any,      ///< only whether any two triangles of one soup collide
};
std::string_view name_of(Query query);

struct Workload {
    std::string name;
    Query query = Query::self;
    io::TriangleMesh a, b;  ///< `b` is empty unless `query` is `between`

    std::int64_t triangle_count() const { return a.triangle_count() + b.triangle_count(); }
    std::string_view scalar() const { return a.precision() == ScalarType::float32 ? "float32" : "float64"; }
};

/// Loads a workload by its name. Throws Error for an unknown name or a missing file.
Workload load(const std::string& name);

/// Returns the procedural scene and its parameters of SCENE[:TRIANGLES][@FRAME].
std::pair<std::string, scenes::Parameters> parse(const std::string& name);

/// Returns the folder of the scenes' files: $CRUMPLE_DATA or else ../shared/data beside the checkout. May not exist.
std::filesystem::path data_folder();

/// Returns the names of the workloads from files; empty if data_folder() does not exist. Single files may be missing.
std::vector<std::string> real_scenes();

/// Returns the names of procedural workloads for races, which may take minutes each. They cover all queries.
std::vector<std::string> procedural_scenes();

/// Returns the names of procedural_scenes() and of all other procedural scenes, at their usual sizes. Some scenes are
/// simulated at their first use, which takes minutes.
std::vector<std::string> every_procedural_scene();

/// Returns the names of a few small workloads, from files if there are any.
std::vector<std::string> quick_scenes();

/// Returns a copy of a mesh's coordinates, three per vertex, converted to `Scalar` if they are of another type.
template <class Scalar>
std::vector<Scalar> coordinates(const io::TriangleMesh& mesh) {
    return std::visit([](const auto& values) { return std::vector<Scalar>(values.begin(), values.end()); },
                      mesh.vertices);
}

/// Sorts pairs and removes repetitions. If the query is about one soup, also orders each pair (a < b) and removes pairs
/// of a triangle with itself.
void normalise(std::vector<Pair>& pairs, Query query);

}  // namespace crumple::benchmark
