#include "cuda_worlds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "comparison.h"
#include "crumple/crumple.h"
#include "device_array.h"
#include "scenes/scenes.h"

namespace crumple::benchmark {
namespace {

/// Times `frames` launches with poses and result on the device. Describes in `wrong` how `any` of one of the results,
/// or the flags and pairs of the last one, differ from `expected`.
Summary steps_on_device(const Options& options, int frames, const World& world, const IntersectionQuery& query,
                        const Intersections& expected, std::string& wrong) {
    const DeviceArray poses(world.poses.data(), world.poses.size_bytes());
    World there = world;
    there.poses = {};
    there.device_poses = {static_cast<const Pose*>(poses.data()), static_cast<std::int64_t>(world.poses.size())};
    Detector detector(options);
    bool differs = false;
    const auto step = [&] { differs |= detector.launch(there, query).wait().any != expected.any; };
    for (int warm_up = 0; warm_up < 4; ++warm_up) step();
    const Summary times = repeated(frames, step);
    const auto last = detector.launch(there, query);
    last.wait();
    const Intersections& found = last.download();
    if (differs) wrong += "some steps on the device differ. ";
    wrong += array_difference("world flags of a step", found.world_hit, expected.world_hit) +
             array_difference("pairs of a step", found.pairs, expected.pairs);
    return times;
}

}  // namespace

Table table_of_worlds() {
    return {"worlds side by side in one call, milliseconds",
            {"output", "worlds", "triangles", "hit", "pairs", "step on device", "host to host", "quartiles", "stages",
             "cpu", "first"}};
}

void measure_worlds(int count, const Options& options, int frames, Table& table, const RowSink& add) {
    const io::TriangleMesh mesh = scenes::make("model", {.triangles = 500});
    const double reach = std::visit(
        [](const auto& vertices) {
            double most = 0;
            for (const auto& v : vertices) most = std::max(most, std::abs(static_cast<double>(v)));
            return most;
        },
        mesh.vertices);
    const std::vector<Shape> shapes{Shape(mesh.view())};
    std::vector<Body> bodies;
    std::vector<Pose> poses(2 * static_cast<std::size_t>(count));
    for (int w = 0; w < count; ++w) {
        bodies.insert(bodies.end(), 2, {.shape = 0, .world = w});
        poses[bodies.size() - 1].rows[3] = 4 * reach * w / count;
    }
    const World world{shapes, bodies, poses};
    for (const auto& [name, wants] : {std::pair{"flags", Output::any_by_world}, std::pair{"pairs", Output::pairs}}) {
        const IntersectionQuery query{.output = wants};
        Detector detector(options), cpu({.backend = Backend::cpu});
        const double first = milliseconds_of([&] { detector.find(world, query); });
        const Intersections* expected = nullptr;
        const double on_cpu = milliseconds_of([&] { expected = &cpu.find(world, query); });
        const Intersections& found = detector.find(world, query);
        std::string wrong = array_difference("world flags", found.world_hit, expected->world_hit) +
                            array_difference("pairs", found.pairs, expected->pairs);
        const auto hits = std::count(found.world_hit.begin(), found.world_hit.end(), 1);
        const std::int64_t triangles = found.statistics.triangles, pairs = found.count;
        const double stages = std::accumulate(found.statistics.stage_milliseconds.begin(),
                                              found.statistics.stage_milliseconds.end(), 0.0);
        const Summary times = repeated(std::min(5, frames), [&] { detector.find(world, query); });
        const Summary steps = steps_on_device(options, frames, world, query, *expected, wrong);
        table.row({name, std::to_string(count), std::to_string(triangles), std::to_string(hits), std::to_string(pairs),
                   number(steps.median), number(times.median), range(times),
                   wants == Output::pairs ? number(stages) : "", number(on_cpu), number(first)});
        nlohmann::json row{{"wants", name},
                           {"worlds", count},
                           {"triangles", triangles},
                           {"worlds_hit", hits},
                           {"pairs", pairs},
                           {"on_device", to_json(steps)},
                           {"from_and_to_host", to_json(times)},
                           {"stages", stages},
                           {"cpu_all_threads", on_cpu},
                           {"first_milliseconds", first}};
        set_right(row, fmt::format("{} worlds, {}", count, name), wrong);
        add(std::move(row));
    }
}

}  // namespace crumple::benchmark
