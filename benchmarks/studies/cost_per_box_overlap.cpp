// Study of triangles of very different size, which [MZ] 5.1 discusses ([MZ] is the paper that the library follows):
// time per overlapping pair of boxes in scenes full of needles or with triangle sizes over several decades, compared
// with cloth. Boxes are aligned with the coordinate axes here, although the detector uses other frames, so that their
// number of overlaps depends on the scene only.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

constexpr double limit = 2;  // aim for the largest cost, as a multiple of the cost on the first scene, a cloth

struct Box {
    std::array<double, 3> low, high;
};

/// Returns the number of pairs of triangles whose closed boxes overlap, adjacent ones included, by a sweep along x.
std::int64_t overlapping_boxes(const io::TriangleMesh& mesh) {
    const std::vector<double> xyz = coordinates<double>(mesh);
    std::vector<Box> boxes(static_cast<std::size_t>(mesh.triangle_count()));
    for (std::size_t c = 0; c < mesh.triangles.size(); ++c) {
        Box& box = boxes[c / 3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double x = xyz[3 * static_cast<std::size_t>(mesh.triangles[c]) + axis];
            box.low[axis] = c % 3 ? std::min(box.low[axis], x) : x;
            box.high[axis] = c % 3 ? std::max(box.high[axis], x) : x;
        }
    }
    std::ranges::sort(boxes, {}, [](const Box& box) { return box.low[0]; });
    std::int64_t count = 0;
    for (auto a = boxes.begin(); a != boxes.end(); ++a) {
        for (auto b = a + 1; b != boxes.end() && b->low[0] <= a->high[0]; ++b) {
            count += a->low[1] <= b->high[1] && b->low[1] <= a->high[1] && a->low[2] <= b->high[2] &&
                     b->low[2] <= a->high[2];
        }
    }
    return count;
}

}  // namespace

nlohmann::json study_cost_per_box_overlap(const StudySettings& settings) {
    // Costs are compared with that of the first scene.
    const std::vector<std::string> scenes =
        choose_scenes(settings, {"cloth_ball92", "Generic_Twin_right", "needles", "five_decades", "fans", "soup"},
                      {"cloth", "needles", "five_decades", "fans", "soup"});
    std::vector<Workload> workloads;
    for (const std::string& scene : scenes) workloads.push_back(load(scene));
    std::vector<Contestant> contestants;
    for (const Workload& workload : workloads) contestants.push_back(crumple_with({}, workload, workload.name));
    const std::vector<Times> times = race(contestants, settings.effort);

    Table table(fmt::format("cost of an overlapping pair of boxes, limit {} times that of {}", limit, scenes.front()),
                {"scene", "triangles", "overlapping boxes", "ms", "ns a box pair", "times " + scenes.front()});
    nlohmann::json rows = nlohmann::json::array();
    double yardstick = 0;
    for (std::size_t i = 0; i < workloads.size(); ++i) {
        const std::int64_t overlaps = overlapping_boxes(workloads[i].a);
        const Summary time = times[i].summary();
        const double cost = 1e6 * time.median / static_cast<double>(overlaps);
        if (i == 0) yardstick = cost;
        table.row({scenes[i], std::to_string(workloads[i].triangle_count()), std::to_string(overlaps),
                   number(time.median), number(cost), number(cost / yardstick)});
        rows.push_back({{"workload", scenes[i]},
                        {"overlapping_boxes", overlaps},
                        {"milliseconds", to_json(time)},
                        {"nanoseconds_a_box_pair", cost},
                        {"relative", cost / yardstick}});
    }
    table.print();
    return rows;
}

}  // namespace crumple::benchmark
