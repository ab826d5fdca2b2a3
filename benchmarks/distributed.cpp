// crumple_mpi_benchmark: compares MPI ranks with one thread each with one process with as many threads as there are
// ranks, alternately, on two frames that alternate. Each rank has a block of the triangles. --growth compares the
// memory of the ranks with that of one process on one thread. Run it by mpirun.
//
//     mpirun -n 2 crumple_mpi_benchmark unc_cloth_ball cloth:1000000
//     mpirun -n 4 crumple_mpi_benchmark --growth cloth:100000000

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <numeric>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "crumple/crumple.h"
#include "crumple/mpi.h"
#include "race.h"
#include "rank_block.h"
#include "report.h"
#include "scenes/cloth.h"
#include "scenes/random.h"
#include "sequence.h"
#include "workload.h"

namespace crumple::benchmark {
namespace {

using Clock = std::chrono::steady_clock;

/// Resident memory of this process in MiB: now, and the peak since reset_peak().
struct Resident {
    double now = 0, peak = 0;

    static Resident measure() {
        Resident resident;
        std::ifstream status("/proc/self/status");
        for (std::string name; status >> name;) {
            double kilobytes = 0;
            if (name == "VmRSS:" && status >> kilobytes) resident.now = kilobytes / 1024;
            if (name == "VmHWM:" && status >> kilobytes) resident.peak = kilobytes / 1024;
        }
        return resident;
    }
    /// Returns memory that the allocator has free to the system, and resets the peak to the current value.
    static void reset_peak() {
        malloc_trim(0);
        std::ofstream("/proc/self/clear_refs") << 5;
    }
};

struct Settings {
    std::vector<std::string> scenes{"unc_cloth_ball", "cloth:1000000"};
    int rounds = 100, parts = 0;
    double budget = 20;
    bool growth = false;
    std::string json;
};

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Waits for all ranks without occupying a core, unlike MPI_Barrier.
void meet_asleep() {
    MPI_Request request;
    MPI_Ibarrier(MPI_COMM_WORLD, &request);
    for (int done = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), !done;)
        std::this_thread::sleep_for(std::chrono::microseconds(200));
}

nlohmann::json race_ranks(const std::string& scene, const Settings& settings, int rank, int ranks) {
    Sequence sequence = load_sequence(scene);
    if (sequence.frames.size() > 2) sequence.frames.erase(sequence.frames.begin(), sequence.frames.end() - 2);
    std::vector<RankBlock> frames;
    for (const io::TriangleMesh& frame : sequence.frames) frames.emplace_back(frame, rank, ranks);

    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    options.parts = settings.parts;
    mpi::Detector many(MPI_COMM_WORLD, options);
    Detector one({.backend = Backend::cpu, .threads = ranks});

    std::vector<double> of_many, of_one;
    std::array<double, phase_count> phases{};
    double first_many = 0, first_one = 0, balance = 0;
    std::int64_t bytes = 0, members = 0, total = 0;
    bool agree = true;
    int rounds = settings.rounds;
    for (int round = -2; round < rounds; ++round) {
        const auto f = static_cast<std::size_t>(round & 1);
        const auto begin_round = Clock::now();
        meet_asleep();
        double time_of_one = 0;
        std::int64_t pairs = 0;
        if (rank == 0) {
            const auto begin = Clock::now();
            pairs = static_cast<std::int64_t>(one.find(sequence.frames[f].view()).pairs.size());
            time_of_one = milliseconds_since(begin);
        }
        meet_asleep();
        MPI_Barrier(MPI_COMM_WORLD);
        const auto begin = Clock::now();
        const DistributedIntersections& found = many.find(frames[f].local_mesh());
        double time_of_many = milliseconds_since(begin);
        MPI_Allreduce(MPI_IN_PLACE, &time_of_many, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
        if (rank == 0) agree = agree && found.count == pairs;
        total = found.count;
        if (round == -2) first_many = time_of_many, first_one = time_of_one;
        if (round < 0) {
            if (round == -1) {
                double seconds = milliseconds_since(begin_round) / 1000;
                MPI_Bcast(&seconds, 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
                rounds = std::clamp(static_cast<int>(settings.budget / seconds), 3, settings.rounds);
            }
            continue;
        }
        of_many.push_back(time_of_many), of_one.push_back(time_of_one);
        const DistributedStatistics& s = found.statistics;
        for (std::size_t p = 0; p < phases.size(); ++p) phases[p] += s.phase_milliseconds[p] / rounds;
        balance += s.largest_work / s.mean_work / rounds;
        bytes += s.bytes_sent / rounds;
        members = s.members;
    }
    std::int64_t all_bytes = 0, all_members = 0;
    MPI_Allreduce(&bytes, &all_bytes, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(&members, &all_members, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    many.close();
    const Summary ours = summarise(of_many), theirs = summarise(of_one);
    nlohmann::json row{{"scene", scene},
                       {"triangles", sequence.frames[0].triangle_count()},
                       {"pairs", total},
                       {"ranks", ranks},
                       {"parts", options.parts},
                       {"rounds", rounds},
                       {"agree", agree},
                       {"ranks_milliseconds", to_json(ours)},
                       {"one_milliseconds", to_json(theirs)},
                       {"ratio", ours.median / theirs.median},
                       {"first_ranks", first_many},
                       {"first_one", first_one},
                       {"balance", balance},
                       {"members", all_members},
                       {"bytes", all_bytes}};
    for (int p = 0; p < phase_count; ++p)
        row["phases"][std::string(phase_name(static_cast<Phase>(p)))] = phases[static_cast<std::size_t>(p)];
    return row;
}

/// Returns the hash of a list of rows that ends with `pairs`, given the hash `before` of the rows in front of them (0
/// if there are none).
std::uint64_t hash_of(std::span<const Pair> pairs, std::uint64_t before) {
    for (const auto [a, b] : pairs)
        before = scenes::mix(before ^ (static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b)));
    return before;
}

/// Returns, on each rank, the hash of the rows of all ranks in the order of the ranks.
std::uint64_t hash_of_all(std::span<const Pair> pairs, int rank, int ranks) {
    std::uint64_t hash = 0;
    if (rank > 0) MPI_Recv(&hash, 1, MPI_UINT64_T, rank - 1, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    hash = hash_of(pairs, hash);
    if (rank + 1 < ranks) MPI_Send(&hash, 1, MPI_UINT64_T, rank + 1, 0, MPI_COMM_WORLD);
    MPI_Bcast(&hash, 1, MPI_UINT64_T, ranks - 1, MPI_COMM_WORLD);
    return hash;
}

/// Result and cost of one process, or of all ranks together.
struct Growth {
    std::int64_t triangles = 0, pairs = 0;
    std::uint64_t hash = 0;
    double mebibytes = 0;  // peak of the rank that needs most, without the memory in use before it had a scene
    std::array<double, 2> milliseconds{};
};

// Measures two calls on a cloth. Each rank makes only its own block of it.
Growth grow_on_ranks(const scenes::Parameters& parameters, const Settings& settings, int rank, int ranks) {
    Growth growth;
    const double empty = Resident::measure().now;
    scenes::MeshBlock block = scenes::cloth_block(parameters, rank, ranks);
    block.mesh.groups = {};
    std::vector<std::int64_t> vertex_ids(static_cast<std::size_t>(block.mesh.vertex_count()));
    std::iota(vertex_ids.begin(), vertex_ids.end(), block.first_vertex);
    growth.triangles = block.mesh.triangle_count();
    MPI_Allreduce(MPI_IN_PLACE, &growth.triangles, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    Resident::reset_peak();
    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    options.parts = settings.parts;
    mpi::Detector many(MPI_COMM_WORLD, options);
    for (double& time : growth.milliseconds) {
        MPI_Barrier(MPI_COMM_WORLD);
        const auto begin = Clock::now();
        const DistributedIntersections& found = many.find(LocalMesh{block.mesh.view(), {}, vertex_ids});
        time = milliseconds_since(begin);
        growth.pairs = found.count;
        growth.mebibytes = Resident::measure().peak - empty;
        growth.hash = hash_of_all(found.pairs, rank, ranks);
    }
    MPI_Allreduce(MPI_IN_PLACE, growth.milliseconds.data(), 2, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, &growth.mebibytes, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    many.close();
    return growth;
}

Growth grow_alone(const scenes::Parameters& parameters) {
    Growth growth;
    const double empty = Resident::measure().now;
    io::TriangleMesh mesh = scenes::cloth_block(parameters, 0, 1).mesh;
    mesh.groups = {};
    growth.triangles = mesh.triangle_count();
    Resident::reset_peak();
    Detector one({.backend = Backend::cpu, .threads = 1});
    for (double& time : growth.milliseconds) {
        const auto begin = Clock::now();
        const Intersections& found = one.find(mesh.view());
        time = milliseconds_since(begin);
        growth.pairs = static_cast<std::int64_t>(found.pairs.size());
        growth.mebibytes = Resident::measure().peak - empty;
        growth.hash = hash_of(found.pairs, 0);
    }
    return growth;
}

// Compares the peak memory of the rank that needs most, which includes its local mesh, with that of one process that
// has the whole scene. Memory that was in use before a process had a scene is subtracted. Only rank 0 makes the whole
// scene, after the ranks have been measured.
nlohmann::json measure_growth(const std::string& scene, const Settings& settings, int rank, int ranks) {
    const auto [name, parameters] = parse(scene);
    if (name != "cloth" || parameters.triangles == 0)
        throw Error(ErrorCode::invalid_argument, "--growth takes cloth:TRIANGLES, of which each rank makes its block");
    const Growth many = grow_on_ranks(parameters, settings, rank, ranks);
    Resident::reset_peak();
    Growth one;
    if (rank == 0) one = grow_alone(parameters);
    meet_asleep();
    const bool agree = many.pairs == one.pairs && many.hash == one.hash && many.triangles == one.triangles;
    if (rank == 0) {
        fmt::print("{}: {} triangles, {} pairs{}; ranks {:016x}, one process {:016x}\n", scene, many.triangles,
                   many.pairs, agree ? "" : ", WHICH DIFFER FROM ONE PROCESS", many.hash, one.hash);
        fmt::print("  largest rank of {}: {:.0f} MiB, one process {:.0f} MiB: {:.2f} times its local\n", ranks,
                   many.mebibytes, one.mebibytes, many.mebibytes * ranks / one.mebibytes);
        fmt::print("  first call {:.0f} ms, second {:.0f} ms; one process on one thread {:.0f} and {:.0f} ms\n",
                   many.milliseconds[0], many.milliseconds[1], one.milliseconds[0], one.milliseconds[1]);
    }
    const auto told = [](const Growth& growth) {
        return nlohmann::json{{"hash", fmt::format("{:016x}", growth.hash)},
                              {"mebibytes", growth.mebibytes},
                              {"milliseconds", growth.milliseconds}};
    };
    return {{"scene", scene}, {"triangles", many.triangles}, {"pairs", many.pairs}, {"ranks", ranks},
            {"agree", agree}, {"of_ranks", told(many)},      {"of_one", told(one)}};
}

void print(const nlohmann::json& row) {
    const auto time = [&](const char* name) { return row[name]["median"].get<double>(); };
    fmt::print("{}: {} triangles, {} pairs, {} ranks{}\n", row["scene"].get<std::string>(),
               row["triangles"].get<std::int64_t>(), row["pairs"].get<std::int64_t>(), row["ranks"].get<int>(),
               row["agree"].get<bool>() ? "" : ", WHICH DIFFER FROM ONE PROCESS");
    fmt::print("  ranks {:.2f} ms, one process {:.2f} ms: {:.3f} times; first call {:.1f} and {:.1f} ms\n",
               time("ranks_milliseconds"), time("one_milliseconds"), row["ratio"].get<double>(),
               row["first_ranks"].get<double>(), row["first_one"].get<double>());
    fmt::print("  largest work over mean {:.3f}, {} members, {} bytes a frame\n  ", row["balance"].get<double>(),
               row["members"].get<std::int64_t>(), row["bytes"].get<std::int64_t>());
    for (const auto& [name, milliseconds] : row["phases"].items())
        fmt::print("{} {:.2f}  ", name, milliseconds.get<double>());
    fmt::print("\n");
}

int run(int count, char** arguments) {
    int rank = 0, ranks = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    Settings settings;
    CLI::App app{"Ranks of MPI with one thread each against one process with as many threads"};
    app.add_option("scenes", settings.scenes, "sequences, as crumple_benchmark names them");
    app.add_option("--rounds", settings.rounds, "maximum number of frames")->check(CLI::Range(3, 100000));
    app.add_option("--budget", settings.budget, "seconds per scene");
    app.add_option("--parts", settings.parts, "DistributedOptions::parts");
    app.add_flag("--growth", settings.growth, "memory, and a hash of the rows, of cloth:TRIANGLES made by the ranks");
    app.add_option("--json", settings.json, "file for the figures");
    CLI11_PARSE(app, count, arguments);
    nlohmann::json rows = nlohmann::json::array();
    bool agree = true;
    for (const std::string& scene : settings.scenes) {
        rows.push_back(settings.growth ? measure_growth(scene, settings, rank, ranks)
                                       : race_ranks(scene, settings, rank, ranks));
        if (rank == 0) agree = agree && rows.back()["agree"].get<bool>();
        if (rank == 0 && !settings.growth) print(rows.back());
    }
    if (rank == 0 && !settings.json.empty()) write_json(settings.json, {{"distributed", rows}});
    return agree ? 0 : 1;
}

}  // namespace
}  // namespace crumple::benchmark

int main(int count, char** arguments) {
    int level = 0;
    MPI_Init_thread(&count, &arguments, MPI_THREAD_FUNNELED, &level);
    int failed = 1;
    try {
        failed = crumple::benchmark::run(count, arguments);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
    MPI_Finalize();
    return failed;
}
