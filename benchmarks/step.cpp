#include "step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "crumple/error.h"
#include "scenes/scenes.h"
#include "sequence.h"
#include "workload.h"

namespace crumple::benchmark {
namespace {

constexpr double way = 0.5, reach = 0.25;  // mean motion of a vertex, and radius: multiples of the mean edge length

const std::vector<std::string> from_files{"unc_funnel", "unc_cloth_ball", "unc_n_body"};

double distance(const std::vector<double>& p, std::size_t a, const std::vector<double>& q, std::size_t b) {
    return std::hypot(p[3 * a] - q[3 * b], p[3 * a + 1] - q[3 * b + 1], p[3 * a + 2] - q[3 * b + 2]);
}

double mean_edge_length(const io::TriangleMesh& mesh, const std::vector<double>& xyz) {
    std::vector<std::array<std::int32_t, 2>> edges;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t a = mesh.triangles[t + k], b = mesh.triangles[t + (k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b)});
        }
    std::ranges::sort(edges);
    edges.erase(std::ranges::unique(edges).begin(), edges.end());
    double sum = 0;
    for (const auto& [a, b] : edges)
        sum += distance(xyz, static_cast<std::size_t>(a), xyz, static_cast<std::size_t>(b));
    return sum / static_cast<double>(edges.size());
}

double mean_way(const std::vector<double>& from, const std::vector<double>& to) {
    double sum = 0;
    for (std::size_t v = 0; v < from.size() / 3; ++v) sum += distance(from, v, to, v);
    return sum / static_cast<double>(from.size() / 3);
}

/// Returns the last two frames of a procedural scene.
Step procedural(const std::string& name) {
    const auto [scene, parameters] = parse(name);
    scenes::Animation animation(scene, parameters);
    const int last = animation.description().frames - 1;
    if (last < 1) throw Error(ErrorCode::invalid_argument, scene + " does not move");
    return {name, animation.frame(last - 1), animation.frame(last)};
}

}  // namespace

Step load_step(const std::string& name) {
    const bool file = std::ranges::find(from_files, name) != from_files.end();
    Step step;
    if (file) {
        Sequence sequence = load_sequence(name);
        step = {name, std::move(sequence.frames[0]), std::move(sequence.frames[1])};
    } else {
        step = procedural(name);
    }
    step.start.groups.clear();
    const std::vector<double> start = coordinates<double>(step.start);
    const double edge = mean_edge_length(step.start, start);
    step.radius = static_cast<float>(reach * edge);
    if (file) return step;
    std::vector<double> end = coordinates<double>(step.end);
    const double share = way * edge / mean_way(start, end);
    for (std::size_t i = 0; i < end.size(); ++i) end[i] = start[i] + share * (end[i] - start[i]);
    step.end.vertices = std::vector<float>(end.begin(), end.end());
    return step;
}

std::vector<std::string> steps() {
    std::vector<std::string> names = sequences();
    std::erase_if(names, [](const auto& name) { return std::ranges::find(from_files, name) == from_files.end(); });
    return names.empty() ? std::vector<std::string>{"cloth", "bodies"} : names;
}

}  // namespace crumple::benchmark
