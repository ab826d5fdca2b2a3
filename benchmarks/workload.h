#pragma once

// What is measured: a mesh or two, and a question about them.
//
// A workload is named [any:|between:]SCENE[:TRIANGLES][@FRAME]. SCENE is a file's short name (`real_scenes`) or a
// procedural scene of crumple::scenes, whose last frame is taken if none is named. Without a prefix the question is the
// one that the scene is listed with, all pairs of one soup for the procedural ones; `any` asks whether there is a
// collision at all, `between` sets the procedural scene's even groups against its odd ones.

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

enum class Question : std::uint8_t {
    self,     ///< all colliding pairs of one soup
    between,  ///< all colliding pairs of a triangle of `a` and a triangle of `b`
    any,      ///< whether any two triangles of one soup collide
};
std::string_view name_of(Question question);

struct Workload {
    std::string name;
    Question question = Question::self;
    io::TriangleMesh a, b;  ///< `b` is empty unless the question is `between`

    std::int64_t triangle_count() const { return a.triangle_count() + b.triangle_count(); }
    std::string_view scalar() const { return a.precision() == ScalarType::float32 ? "float32" : "float64"; }
};

/// Throws Error for a name that is unknown or a file that is not there.
Workload load(const std::string& name);

/// A procedural scene and its parameters, from SCENE[:TRIANGLES][@FRAME].
std::pair<std::string, scenes::Parameters> parse(const std::string& name);

/// Where the files lie: $CRUMPLE_DATA or, failing that, ../shared/data beside the checkout. May not exist.
std::filesystem::path data_folder();

/// Names of the files' workloads; empty if there are no files.
std::vector<std::string> real_scenes();

/// Names of procedural workloads that cover all questions, for races that take minutes a scene.
std::vector<std::string> procedural_scenes();

/// These, and every other procedural scene at the size that it is made for. Some are simulated at their first use.
std::vector<std::string> every_procedural_scene();

/// A few small ones of either kind.
std::vector<std::string> quick_scenes();

/// A mesh's coordinates as three of `Scalar` a vertex, converted if need be.
template <class Scalar>
std::vector<Scalar> coordinates(const io::TriangleMesh& mesh) {
    return std::visit([](const auto& values) { return std::vector<Scalar>(values.begin(), values.end()); },
                      mesh.vertices);
}

/// Sorted, a < b if the question is about one soup, without repetitions and pairs of a triangle with itself.
void normalise(std::vector<Pair>& pairs, Question question);

}  // namespace crumple::benchmark
