// crumple_cuda_benchmark: the cuda backend alone, on meshes that lie on the device, as in a simulation on the device.
//
// A detector is warmed up, then queries the same frame repeatedly by launch and wait. The time of a frame is the
// device's: between events before and after the graph on the caller's stream, which a kernel keeps busy until the graph
// is enqueued. Other columns: on an idle stream, which includes the host's launch; by the host's clock, which includes
// wait(); with the mesh on the host, which includes upload and download; the cpu backend on all threads; and, for each
// stage, the lower bound that bandwidth and launches imply. Each result is compared with that of the cpu backend. A
// wrong result is marked in its row ("right": false, with a sentence); the run continues, and the program's exit status
// is 1. The file of figures grows row by row, so that an interrupted run leaves its figures.
//
// With --serve, the program is a contestant of peers_python.py --on-device, which measures peers on the same device.

#include <cuda_profiler_api.h>
#include <cuda_runtime.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "comparison.h"
#include "crumple/crumple.h"
#include "cuda_features.h"
#include "cuda_worlds.h"
#include "device_array.h"
#include "device_limits.h"
#include "least_work.h"
#include "race.h"
#include "report.h"
#include "scenes/scenes.h"
#include "step.h"
#include "workload.h"

namespace crumple::benchmark {
namespace {

struct Settings {
    std::vector<std::string> scenes;
    std::string json, commit = "unknown";
    std::vector<std::string> steps;
    int frames = 200, device = 0, largest = 2'000'000, worlds = 10'000;
    bool profile = false, serving = false;
    DeviceLimits limits;

    Options options() const { return {.backend = Backend::cuda, .device = device}; }
    int host_frames() const { return std::max(1, frames / 10); }
};

/// Copy of a mesh on the device, with the stream and the events that time its frames.
class Simulation {
   public:
    explicit Simulation(const io::TriangleMesh& mesh)
        : vertices_(std::visit([](const auto& v) { return static_cast<const void*>(v.data()); }, mesh.vertices),
                    std::visit([](const auto& v) { return v.size() * sizeof(v[0]); }, mesh.vertices)),
          triangles_(mesh.triangles.data(), mesh.triangles.size() * sizeof(std::int32_t)),
          view_(mesh.view()) {
        check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking));
        for (cudaEvent_t* event : {&begin_, &end_}) check(cudaEventCreate(event));
        view_.vertices.data = vertices_.data();
        view_.triangles.data = triangles_.data();
        view_.memory = MemorySpace::cuda;
        view_.stream = stream_;
    }
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;
    ~Simulation() {
        for (cudaEvent_t event : {begin_, end_}) cudaEventDestroy(event);
        cudaStreamDestroy(stream_);
    }
    const MeshView& view() const { return view_; }

    /// Launches a frame and returns the milliseconds between events before and after it. If `busy`, a kernel keeps the
    /// stream busy until the host has launched the frame. Otherwise the stream is idle, and the time includes the
    /// host's launch, some 10 us.
    double frame(Detector& detector, bool busy) {
        if (busy) keep_busy(stream_);
        check(cudaEventRecord(begin_, stream_));
        launched_ = detector.launch(view_);
        check(cudaEventRecord(end_, stream_));
        launched_->wait();
        check(cudaEventSynchronize(end_));
        float milliseconds = 0;
        check(cudaEventElapsedTime(&milliseconds, begin_, end_));
        return static_cast<double>(milliseconds);
    }

    /// Result of the last frame, on the host.
    const Intersections& download() const { return launched_->download(); }

   private:
    DeviceArray vertices_, triangles_;
    MeshView view_;
    std::optional<LaunchTicket<IntersectionQuery>> launched_;
    cudaStream_t stream_ = nullptr;
    cudaEvent_t begin_ = nullptr, end_ = nullptr;
};

std::string difference(const Intersections& cuda, const Intersections& cpu) {
    return array_difference("pairs", cuda.pairs, cpu.pairs) + array_difference("offsets", cuda.offsets, cpu.offsets) +
           array_difference("hit flags", cuda.hit, cpu.hit);
}

/// Returns the times of the stages in settings.frames calls of find(), which does not launch a graph, so that events
/// can be recorded between the stages.
std::array<Summary, stage_count> stages(const Settings& settings, Detector& detector, const MeshView& view) {
    std::array<std::vector<double>, stage_count> times;
    for (int i = 0; i < settings.frames; ++i) {
        const Statistics& s = detector.find(view).statistics;
        for (std::size_t k = 0; k < times.size(); ++k) times[k].push_back(s.stage_milliseconds[k]);
    }
    std::array<Summary, stage_count> result;
    for (std::size_t k = 0; k < times.size(); ++k) result[k] = summarise(std::move(times[k]));
    return result;
}

/// Prints the time of each stage and its lower bound by bandwidth and launches (docs/cuda.md), and returns the rows.
/// The sum of the stages' times exceeds the frame's time, because only the frame is launched as a graph.
nlohmann::json bounds(const DeviceLimits& limits, const std::string& scene, const LeastWork& least,
                      const std::array<Summary, stage_count>& stages, const Summary& frame) {
    Table table(fmt::format("{}: microseconds, and lower bounds by {} GB/s and {} us per graph node", scene,
                            number(limits.bandwidth() / 1e9), number(1e3 * limits.node)),
                {"stage", "measured", "MB", "by bandwidth", "nodes", "by launches", "ratio"});
    nlohmann::json rows = nlohmann::json::array();
    const auto row = [&](const std::string& name, double measured, const Work& work, double by_launches) {
        const double by_bandwidth = 1e3 * work.bytes / limits.bandwidth();
        const double ratio = measured / (by_bandwidth + by_launches);
        table.row({name, number(1e3 * measured), number(work.bytes / 1e6), number(1e3 * by_bandwidth),
                   std::to_string(work.nodes), number(1e3 * by_launches), number(ratio)});
        rows.push_back({{"stage", name},
                        {"milliseconds", measured},
                        {"bytes", work.bytes},
                        {"by_bandwidth_milliseconds", by_bandwidth},
                        {"nodes", work.nodes},
                        {"by_launches_milliseconds", by_launches},
                        {"ratio", ratio}});
    };
    for (std::size_t k = 0; k < stages.size(); ++k) {
        if (least.stage[k].nodes == 0) continue;  // the stage's work runs in a parallel branch of the graph
        row(std::string(stage_name(static_cast<Stage>(k))), stages[k].median, least.stage[k],
            least.stage[k].nodes * limits.node);
    }
    row("frame", frame.median, least.frame, limits.graph + (least.frame.nodes - 1) * limits.node);
    rows.back()["nodes_beside"] = least.beside;
    table.print();
    return rows;
}

nlohmann::json counts(const Statistics& s) {
    return {{"triangles", s.triangles},
            {"clusters", s.clusters},
            {"leaves", s.leaves},
            {"members", s.members},
            {"interval_tests", s.interval_tests},
            {"box_overlaps", s.box_overlaps},
            {"edge_tests", s.edge_tests},
            {"double_tests", s.double_tests},
            {"exact_tests", s.exact_tests},
            {"rational_tests", s.rational_tests},
            {"pairs", s.pairs},
            {"peak_memory_bytes", s.peak_memory_bytes}};
}

nlohmann::json measure(const Settings& settings, const std::string& scene, Table& table) {
    const Workload workload = load(scene);
    if (workload.query != Query::self) throw std::runtime_error(scene + " is not one mesh against itself");
    const MeshView host = workload.a.view();
    Simulation simulation(workload.a);
    Detector detector(settings.options()), other(settings.options()), cpu({.backend = Backend::cpu});

    const double first = milliseconds_of([&] { simulation.frame(detector, false); });
    for (int i = 0; i < 5; ++i) simulation.frame(detector, true);
    std::vector<double> device, idle, clock;
    for (int i = 0; i < settings.frames; ++i) {
        device.push_back(simulation.frame(detector, true));
        clock.push_back(milliseconds_of([&] { idle.push_back(simulation.frame(detector, false)); }));
    }
    std::string wrong = difference(simulation.download(), cpu.find(host));

    const std::array<Summary, stage_count> by_stage = stages(settings, other, simulation.view());
    nlohmann::json of_stages;
    for (std::size_t k = 0; k < by_stage.size(); ++k)
        of_stages[std::string(stage_name(static_cast<Stage>(k)))] = to_json(by_stage[k]);
    const Statistics statistics = other.find(simulation.view()).statistics;
    const nlohmann::json counted = counts(statistics);
    wrong += difference(other.find(host), cpu.find(host));
    const Summary brought = repeated(settings.host_frames(), [&] { other.find(host); });
    const Summary on_cpu = repeated(settings.host_frames(), [&] { cpu.find(host); });
    const Summary graph = summarise(std::move(device)), waited = summarise(std::move(clock));
    const Summary from_idle = summarise(std::move(idle));
    table.row({scene, std::to_string(workload.triangle_count()), counted["pairs"].dump(), number(graph.median),
               range(graph), number(from_idle.median), number(waited.median), number(brought.median),
               number(on_cpu.median), number(first)});
    const LeastWork least = least_work(host.vertices.rows, workload.scalar() == "float32", statistics);
    nlohmann::json row{{"scene", scene},
                       {"triangles", workload.triangle_count()},
                       {"scalar", workload.scalar()},
                       {"device", to_json(graph)},
                       {"device_from_idle", to_json(from_idle)},
                       {"device_and_wait", to_json(waited)},
                       {"from_and_to_host", to_json(brought)},
                       {"cpu_all_threads", to_json(on_cpu)},
                       {"first_milliseconds", first},
                       {"stages", of_stages},
                       {"bounds", bounds(settings.limits, scene, least, by_stage, graph)},
                       {"counts", counted}};
    set_right(row, scene, wrong);
    return row;
}

/// Measures cloth of 10,000 triangles up to settings.largest. "exponent" (time ~ triangles^exponent) is fitted to sizes
/// from 200,000 triangles on: frames of smaller sizes are mostly launches, whose time does not grow with the size, so
/// that they would make it too small. Calls so_far(rows) after each size.
template <class SoFar>
nlohmann::json growth(const Settings& settings, Table& table, SoFar so_far) {
    constexpr int large = 200'000;
    std::size_t small_sizes = 0;
    nlohmann::json rows = nlohmann::json::array();
    std::vector<double> triangles, times;
    for (const int size :
         {10'000, 20'000, 50'000, 100'000, 200'000, 400'000, 800'000, 1'200'000, 2'000'000, 5'000'000, 10'000'000}) {
        if (size > settings.largest) break;
        small_sizes += size < large;
        rows.push_back(measure(settings, fmt::format("cloth:{}", size), table));
        so_far(rows);
        triangles.push_back(rows.back()["triangles"].get<double>());
        times.push_back(rows.back()["device"]["median"].get<double>());
    }
    nlohmann::json result{{"sizes", rows}};
    const auto fit = [&](const char* name, std::size_t first) {
        if (times.size() >= first + 2)
            result[name] = exponent(std::span(triangles).subspan(first), std::span(times).subspan(first));
    };
    fit("exponent_of_all_sizes", 0);
    fit("exponent", small_sizes);
    return result;
}

/// Runs settings.frames frames of each scene and step and nothing else. The range that a profiler records
/// (cudaProfilerStart to cudaProfilerStop) is the last frame of each.
void play(const Settings& settings) {
    for (const std::string& scene : settings.scenes) {
        const Workload workload = load(scene);
        Simulation simulation(workload.a);
        Detector detector(settings.options());
        for (int i = 1; i < settings.frames; ++i) detector.find(simulation.view());
        check(cudaProfilerStart());
        detector.find(simulation.view());
        check(cudaProfilerStop());
    }
    for (const std::string& step : settings.steps) play_step(step, settings.options(), settings.frames);
}

template <class T>
void write(const std::string& path, std::span<const T> values) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
    if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

/// Writes the mesh and crumple's pairs to a folder, where peers read them, and returns their description.
nlohmann::json dump(const Workload& workload, const Intersections& found, const std::string& folder) {
    std::visit([&](const auto& values) { write(folder + "/vertices", std::span(values)); }, workload.a.vertices);
    write(folder + "/triangles", std::span(workload.a.triangles));
    write(folder + "/pairs", std::span(found.pairs.begin(), found.pairs.end()));
    return {{"workload", workload.name},
            {"question", name_of(workload.query)},
            {"scalar", workload.scalar()},
            {"triangles", workload.triangle_count()},
            {"pairs", found.pairs.size()}};
}

/// Serves requests like crumple_benchmark --serve (requests.h), except for `parts`. A call of the request `run` is a
/// frame on the device, timed by the host's clock including wait(), as calls of peers are. Ignores the number of
/// threads.
void serve(const Settings& settings) {
    const Workload workload = load(settings.scenes.at(0));
    Simulation simulation(workload.a);
    Detector detector(settings.options());
    const Contestant contestant{"crumple", "", "", [&] { simulation.frame(detector, false); }, nullptr};
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string request, folder;
        int threads = 0;
        double seconds = 0;
        words >> request;
        nlohmann::json reply;
        if (request == "dump" && words >> folder)
            reply = dump(workload, detector.find(simulation.view()), folder);
        else if (request == "processors")
            reply = processors_at_hand();
        else if (request == "run" && words >> threads >> seconds)
            reply = time_slice(contestant, seconds);
        else
            throw std::runtime_error("no such request: " + line);
        std::cout << reply.dump() << std::endl;
    }
}

void write(const Settings& settings, const nlohmann::json& result) {
    if (!settings.json.empty()) write_json(settings.json, result);
}

int run(Settings settings) {
    const DeviceList list = list_devices();
    if (list.devices.empty()) throw std::runtime_error(list.reason);
    const DeviceInfo device = list.devices.at(static_cast<std::size_t>(settings.device));
    check(cudaSetDevice(settings.device));
    if (settings.profile || settings.serving) {
        settings.serving ? serve(settings) : play(settings);
        return 0;
    }
    // Time to make the first backend of the process, which loads kernels, allocates their stacks, and compares
    // decisions of the device about test cases with those of the host.
    const double backend = milliseconds_of([&] { const Detector detector(settings.options()); });
    settings.limits = measure_limits(settings.device);
    int runtime = 0, driver = 0;
    check(cudaRuntimeGetVersion(&runtime));
    check(cudaDriverGetVersion(&driver));
    nlohmann::json result{{"commit", settings.commit},
                          {"device",
                           {{"name", device.name},
                            {"compute_capability", fmt::format("{}.{}", device.major, device.minor)},
                            {"memory_bytes", device.memory_bytes}}},
                          {"limits", to_json(settings.limits)},
                          {"cuda_runtime", runtime},
                          {"cuda_driver", driver},
                          {"first_backend_milliseconds", backend},
                          {"frames", settings.frames},
                          {"unit", "milliseconds"}};
    Table table(fmt::format("cuda on {}, milliseconds, medians of {} frames", device.name, settings.frames),
                {"scene", "triangles", "pairs", "device", "quartiles", "from idle", "with wait", "host to host", "cpu",
                 "first"});
    // Returns a function that appends a row to the list of this name in the figures, and writes the file.
    const auto add_to = [&](const char* list) {
        result[list] = nlohmann::json::array();
        return [&, list](nlohmann::json row) {
            result[list].push_back(std::move(row));
            write(settings, result);
        };
    };
    const RowSink add_scene = add_to("scenes");
    for (const std::string& scene : settings.scenes) add_scene(measure(settings, scene, table));
    if (settings.largest > 0)
        result["growth"] = growth(settings, table, [&](const nlohmann::json& rows) {
            result["growth"]["sizes"] = rows;
            write(settings, result);
        });
    table.print();
    Table worlds = table_of_worlds();
    if (settings.worlds > 0)
        measure_worlds(settings.worlds, settings.options(), settings.host_frames(), worlds, add_to("worlds"));
    Table features = table_of_steps();
    const RowSink add_step_row = add_to("steps");
    for (const std::string& step : settings.steps)
        measure_step(step, settings.options(), settings.frames, features, add_step_row);
    if (!settings.steps.empty()) features.print();
    if (settings.worlds > 0) worlds.print();
    if (result.contains("growth") && result["growth"].contains("exponent"))
        fmt::print("  time ~ triangles^{:.3f} on the device from 200,000 triangles on, ^{:.3f} over all sizes\n",
                   result["growth"]["exponent"].get<double>(), result["growth"]["exponent_of_all_sizes"].get<double>());
    write(settings, result);
    return all_right(result) ? 0 : 1;
}

}  // namespace
}  // namespace crumple::benchmark

int main(int argc, char** argv) {
    using namespace crumple::benchmark;
    std::setvbuf(stdout, nullptr, _IOLBF,
                 BUFSIZ);  // prints each line at once, so that none is lost if the program is killed
    Settings settings;
    CLI::App app("The cuda backend on meshes that lie on the device.");
    app.add_option("--scene", settings.scenes,
                   "[any number of] scenes, named as in crumple_benchmark; without it cloth_ball92, 227 and "
                   "balls16_18, if their files exist");
    app.add_option(
        "--step", settings.steps,
        "[any number of] steps for feature queries: unc_cloth_ball, unc_funnel, unc_n_body, or SCENE:TRIANGLES; "
        "without it the first three, if their files exist, else cloth and bodies; none: no step");
    app.add_option("--frames", settings.frames, "Number of frames for each median")->check(CLI::Range(1, 100'000));
    app.add_option("--largest", settings.largest, "Triangles of the largest cloth of the growth curve; 0: no curve");
    app.add_option("--worlds", settings.worlds, "Worlds of 1,000 triangles each in one call; 0: none")
        ->check(CLI::Range(0, 1'000'000));
    app.add_option("--device", settings.device, "Number of the device")->check(CLI::Range(0, 1'000));
    app.add_option("--json", settings.json, "File to write the figures to");
    app.add_option("--commit", settings.commit, "Commit to record with the figures");
    app.add_flag("--profile", settings.profile,
                 "Only run the frames of scenes and steps, for a profiler; its range is the last frame of each");
    app.add_flag("--serve", settings.serving, "Serve requests of another process (requests.h)")->needs("--scene");
    CLI11_PARSE(app, argc, argv);
    try {
        if (settings.scenes.empty() && !real_scenes().empty()) settings.scenes = {"cloth_ball92", "227", "balls16_18"};
        if (settings.steps.empty()) settings.steps = steps();
        std::erase(settings.steps, "none");
        return run(settings);
    } catch (const std::exception& error) {
        fmt::print(stderr, "crumple_cuda_benchmark: {}\n", error.what());
        return 1;
    }
}
