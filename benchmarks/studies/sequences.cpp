// Study of scenes that move, frame by frame: time of each stage (as in figs. 7 and 8 of [MZ], the paper that the
// library follows: ARCHITECTURE.md), gain from warm-started centres of clusters ([MZ] sec. 4, end), the 99th percentile
// of times, which would be too low if a single frame were repeated, counts that explain slow frames, and the detector's
// peak memory.
//
// Several passes run over all frames; a frame's time is its median over the passes. The first pass is a warm-up. The
// first frame of a pass follows the last frame of the pass before, so the scene jumps there. Kinds of measurements:
//   warm     one detector; centres are warm-started from the frame before
//   cold     one detector, which searches two other scenes, one of them larger, before each timed frame. They have
//            other numbers of clusters, so centres start anew, while buffers stay allocated
//   fixed    one detector without iterations of the clustering: the centres of the first frame for all frames
//   new      a new detector for each frame; the time includes making and destroying it

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "contest.h"
#include "report.h"
#include "sequence.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

/// Measurements of each frame.
struct Run {
    std::vector<std::vector<double>> total;                           ///< milliseconds of a whole call, [frame][pass]
    std::array<std::vector<std::vector<double>>, stage_count> stage;  ///< milliseconds of a stage, [stage][frame][pass]
    std::vector<Statistics> last;

    explicit Run(std::size_t frames) : total(frames), last(frames) {
        for (auto& s : stage) s.resize(frames);
    }
    void add(std::size_t frame, const Statistics& s) {
        total[frame].push_back(s.milliseconds);
        for (std::size_t i = 0; i < stage.size(); ++i) stage[i][frame].push_back(s.stage_milliseconds[i]);
        last[frame] = s;
    }
};

std::vector<double> medians(const std::vector<std::vector<double>>& values) {
    std::vector<double> result;
    for (const auto& v : values) result.push_back(summarise(v).median);
    return result;
}

Summary over_all(const std::vector<std::vector<double>>& values) {
    std::vector<double> all;
    for (const auto& v : values) all.insert(all.end(), v.begin(), v.end());
    return summarise(std::move(all));
}

nlohmann::json counts(const Run& run, std::int64_t Statistics::*member) {
    nlohmann::json list = nlohmann::json::array();
    for (const Statistics& s : run.last) list.push_back(s.*member);
    return list;
}

/// Counts that explain why one frame is slower than another.
constexpr std::pair<const char*, std::int64_t Statistics::*> explaining[]{
    {"interval_tests", &Statistics::interval_tests}, {"box_overlaps", &Statistics::box_overlaps},
    {"edge_tests", &Statistics::edge_tests},         {"double_tests", &Statistics::double_tests},
    {"exact_tests", &Statistics::exact_tests},
};

std::int64_t most_triangles(const Sequence& sequence) {
    std::int64_t most = 0;
    for (const io::TriangleMesh& frame : sequence.frames) most = std::max(most, frame.triangle_count());
    return most;
}

/// Returns a mesh of `count` triangles that do not touch each other, in rows of 512.
io::TriangleMesh scattered(std::int64_t count) {
    io::TriangleMesh mesh;
    auto& xyz = mesh.vertices.emplace<std::vector<float>>();
    for (std::int64_t t = 0; t < count; ++t) {
        const auto x = static_cast<float>(t % 512), y = static_cast<float>(t / 512);
        const auto first = static_cast<std::int32_t>(3 * t);
        for (const float value : {x, y, 0.0f, x + 0.5f, y, 0.0f, x, y + 0.5f, 0.0f}) xyz.push_back(value);
        for (const std::int32_t k : {0, 1, 2}) mesh.triangles.push_back(first + k);
    }
    return mesh;
}

/// True if two runs had the same number of members in each frame, which implies the same centres.
bool same_clusters(const Run& a, const Run& b) {
    return std::ranges::equal(a.last, b.last, {}, &Statistics::members, &Statistics::members);
}

/// Runs all kinds of measurements (see the top of this file) in one pass that only warms up, and then measures them in
/// up to `most` passes: fewer if they would take longer than `budget` seconds, without the warm-up, but at least one.
nlohmann::json follow(const Sequence& sequence, int most, double budget) {
    const std::size_t frames = sequence.frames.size();
    struct Kind {
        const char* name;
        Options options;
        bool forgets, anew;
    };
    const std::array kinds{Kind{"warm", {.threads = 1}, false, false}, Kind{"warm, all threads", {}, false, false},
                           Kind{"cold", {.threads = 1}, true, false},
                           Kind{"fixed", {.threads = 1, .fuzzy_c_means = {.max_iterations = 0}}, false, false},
                           Kind{"new, all threads", {}, false, true}};
    const io::TriangleMesh one = scattered(1),
                           many = scattered(std::max<std::int64_t>(270'000, 4 * most_triangles(sequence)));
    std::vector<Detector> detectors;
    std::vector<Run> runs;
    for (const Kind& kind : kinds) {
        detectors.emplace_back(kind.options);
        runs.emplace_back(frames);
    }
    int passes = most;
    for (int pass = 0; pass <= passes; ++pass) {
        const auto begin = std::chrono::steady_clock::now();
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            for (std::size_t f = 0; f < frames; ++f) {
                const MeshView mesh = sequence.frames[f].view();
                if (kinds[k].forgets) detectors[k].find(one.view()), detectors[k].find(many.view());
                if (kinds[k].anew) {
                    Statistics s;
                    const Contestant call{
                        "", "", "", [&] { s = Detector(kinds[k].options).find(mesh).statistics; }, {}};
                    s.milliseconds = time_slice(call, 0).front();  // includes construction and destruction
                    if (pass > 0) runs[k].add(f, s);
                } else {
                    const Statistics& s = detectors[k].find(mesh).statistics;
                    if (pass > 0) runs[k].add(f, s);
                }
            }
        }
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (pass == 0) passes = std::clamp(static_cast<int>(budget / seconds), 1, most);
    }

    Table table(fmt::format("sequence {}: {} frames, {} passes", sequence.name, frames, passes),
                {"centres", "median, ms", "quartiles", "99th percentile", "subdivide, ms", "members", "candidates",
                 "peak, MiB"});
    nlohmann::json row{{"sequence", sequence.name}, {"frames", sequence.numbers}, {"passes", passes}};
    row["triangles"] = counts(runs.front(), &Statistics::triangles);
    row["pairs"] = counts(runs.front(), &Statistics::pairs);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        const Run& run = runs[k];
        if (kinds[k].forgets && !same_clusters(run, runs.back())) {
            fmt::print("cold centres are left out: the detector still had some of them cached\n");
            continue;
        }
        const Summary all = over_all(run.total);
        nlohmann::json& kind = row["kinds"][kinds[k].name];
        kind["milliseconds"] = medians(run.total);
        kind["summary"] = with_percentile_99(all);
        double members = 0, candidates = 0;
        for (const Statistics& s : run.last) {
            members += static_cast<double>(s.members) / static_cast<double>(frames);
            candidates += static_cast<double>(s.box_overlaps) / static_cast<double>(frames);
        }
        std::int64_t peak = 0;
        for (const Statistics& s : run.last) peak = std::max(peak, s.peak_memory_bytes);
        if (!kinds[k].forgets) kind["peak_bytes"] = peak;  // cold: the peak is that of the larger scenes
        const auto subdivide = static_cast<std::size_t>(Stage::subdivide);
        table.row({kinds[k].name, number(all.median), range(all), number(all.percentile_99),
                   number(over_all(run.stage[subdivide]).median), number(members), number(candidates),
                   kinds[k].forgets ? "" : number(static_cast<double>(peak) / 1048576)});
        kind["members"] = members;
        kind["candidates"] = candidates;
        if (kinds[k].options.threads != 1) continue;  // stage times are summed over threads, so exceed the total
        for (std::size_t s = 0; s < run.stage.size(); ++s)
            kind["stages"][stage_name(static_cast<Stage>(s))] = medians(run.stage[s]);
        if (k > 0) continue;
        for (const auto& [name, member] : explaining) kind["counts"][name] = counts(run, member);
    }
    table.print();
    return row;
}

/// Measures peers on some frames of the sequence; calls each way of a peer on each frame until twice the slice of time
/// is spent. Prints and returns the way of each peer that is the fastest over all these frames, if it supports all of
/// them.
nlohmann::json peers_on(const Sequence& sequence, const std::vector<std::size_t>& frames, const Effort& effort) {
    struct Way {
        std::string name, way, computes;
        std::vector<double> milliseconds, all;
    };
    std::vector<Way> ways;
    for (const std::size_t f : frames) {
        const Workload workload{sequence.name, Query::self, sequence.frames[f], {}};
        for (const Contestant& contestant : peer_contestants(workload, built_peers())) {
            const auto same = [&](const Way& w) { return w.name == contestant.name && w.way == contestant.way; };
            auto way = std::ranges::find_if(ways, same);
            if (way == ways.end())
                way = ways.insert(ways.end(), {contestant.name, contestant.way, contestant.computes, {}, {}});
            const std::vector<double> times = time_slice(contestant, 2 * effort.slice);
            way->milliseconds.push_back(summarise(times).median);
            way->all.insert(way->all.end(), times.begin(), times.end());
        }
    }
    Table table("the same, every few frames",
                {"peer", "way", "computes", "median, ms", "quartiles", "99th percentile"});
    nlohmann::json rows = nlohmann::json::array();
    for (const Way& way : ways) {
        const auto beaten_by = [&](const Way& other) {
            return other.name == way.name && other.milliseconds.size() == frames.size() &&
                   summarise(other.all).median < summarise(way.all).median;
        };
        if (way.milliseconds.size() < frames.size() || std::ranges::any_of(ways, beaten_by)) continue;
        const Summary all = summarise(way.all);
        table.row({way.name, way.way, way.computes, number(all.median), range(all), number(all.percentile_99)});
        rows.push_back({{"name", way.name},
                        {"way", way.way},
                        {"computes", way.computes},
                        {"milliseconds", way.milliseconds},
                        {"summary", with_percentile_99(all)}});
    }
    table.print();
    return rows;
}

}  // namespace

nlohmann::json study_sequences(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::vector<std::string> names = settings.scenes.empty() ? sequences() : settings.scenes;
    if (settings.quick && settings.scenes.empty()) names = {"cloth:20000"};
    for (const std::string& name : names) {
        const Sequence sequence = load_sequence(name, settings.quick ? 8 : 1);
        nlohmann::json row = settings.quick ? follow(sequence, 2, 4) : follow(sequence, 5, 60);
        std::vector<std::size_t> some;
        const std::size_t step = std::max<std::size_t>(1, sequence.frames.size() / (settings.quick ? 3 : 12));
        for (std::size_t f = step / 2; f < sequence.frames.size(); f += step) some.push_back(f);
        nlohmann::json numbers = nlohmann::json::array();
        for (const std::size_t f : some) numbers.push_back(sequence.numbers[f]);
        row["peer_frames"] = numbers;
        row["peers"] = peers_on(sequence, some, settings.effort);
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace crumple::benchmark
