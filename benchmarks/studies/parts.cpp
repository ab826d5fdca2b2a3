// Study of the gain if several machines search one scene: Detector::partition splits it into parts, and each is
// searched alone. The time of the slowest part is a lower bound for that of all machines. The total work grows, because
// triangles at borders belong to several parts. Parts are searched in two ways. "owning" is find(part), which finds
// only the pairs that the part owns. "alone" searches a mesh of the part's triangles, which finds pairs of triangles in
// several parts once in each of them; the difference is the cost of ownership. Searches use one thread; the whole scene
// and the parts alternate.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "report.h"
#include "studies/primitives.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

double median_of(std::vector<double> values) { return summarise(std::move(values)).median; }

nlohmann::json distribute_parts(const Workload& workload, int count, const Effort& effort) {
    const Options options{.threads = 1};
    const MeshView mesh = workload.a.view();
    Detector whole(options);
    const std::vector<Part> parts = whole.partition(mesh, {}, count);
    const auto n = static_cast<std::size_t>(count);
    std::vector<io::TriangleMesh> meshes;
    std::vector<Detector> alone, owning;
    std::int64_t members = 0, most_members = 0;
    for (const Part& part : parts) {
        meshes.push_back(extract(workload.a, part.mesh.ids));
        alone.emplace_back(options);
        owning.emplace_back(options);
        members += meshes.back().triangle_count();
        most_members = std::max(most_members, meshes.back().triangle_count());
    }

    std::vector<double> whole_times, partition_times;
    std::vector<std::vector<double>> alone_times(n), owning_times(n);
    int rounds = effort.rounds;
    for (int round = 0; round <= rounds; ++round) {
        const auto begin = std::chrono::steady_clock::now();
        const double whole_time = whole.find(mesh).statistics.milliseconds;
        const Contestant cutting{"", "", "", [&] { whole.partition(mesh, {}, count); }, {}};
        const double partition_time = time_slice(cutting, 0).front();
        for (std::size_t k = 0; k < n; ++k) {
            const double own = alone[k].find(meshes[k].view()).statistics.milliseconds;
            const double owned = owning[k].find(parts[k]).statistics.milliseconds;
            if (round > 0) alone_times[k].push_back(own), owning_times[k].push_back(owned);
        }
        if (round > 0) whole_times.push_back(whole_time), partition_times.push_back(partition_time);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (round == 0) rounds = std::clamp(static_cast<int>(effort.budget / seconds), 2, effort.rounds);
    }
    const Summary all = summarise(whole_times);
    nlohmann::json row{{"parts", count},
                       {"whole", to_json(all)},
                       {"partition", median_of(partition_times)},
                       {"members", members},
                       {"most_members", most_members}};
    for (const auto& [name, part_times] : {std::pair{"alone", &alone_times}, std::pair{"owning", &owning_times}}) {
        std::vector<double> times;
        for (const auto& t : *part_times) times.push_back(median_of(t));
        const double largest = std::ranges::max(times), sum = std::accumulate(times.begin(), times.end(), 0.0);
        row[name] = {{"milliseconds", times},
                     {"inflation", sum / all.median},
                     {"largest", largest},
                     {"most_speed_up", all.median / largest}};
    }
    return row;
}

}  // namespace

nlohmann::json study_parts(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::vector<std::string> scenes =
        choose_scenes(settings, {"cloth_ball92", "balls16_18", "cloth:1000000"}, {"cloth", "bodies", "cloth:1000000"});
    if (settings.quick && settings.scenes.empty()) scenes = {"cloth:20000"};
    for (const std::string& name : scenes) {
        const Workload workload = load(name);
        Table table(
            fmt::format("parts: {}, {} triangles, one thread each", name, workload.triangle_count()),
            {"parts", "whole, ms", "partition, ms", "members / triangles", "largest share x parts",
             "alone: sum / whole", "largest, ms", "speed-up", "owning: sum / whole", "largest, ms", "speed-up"});
        nlohmann::json sizes = nlohmann::json::array();
        for (const int count : {2, 4, 8, 16, 32, 64, 256}) {
            const nlohmann::json& row = sizes.emplace_back(distribute_parts(workload, count, settings.effort));
            const double members = row["members"], most = row["most_members"];
            std::vector<std::string> cells{
                std::to_string(count), number(row["whole"]["median"]), number(row["partition"]),
                number(members / static_cast<double>(workload.triangle_count())), number(most * count / members)};
            for (const char* kind : {"alone", "owning"})
                for (const char* value : {"inflation", "largest", "most_speed_up"})
                    cells.push_back(number(row[kind][value]));
            table.row(cells);
        }
        table.print();
        rows.push_back({{"workload", name}, {"triangles", workload.triangle_count()}, {"counts", std::move(sizes)}});
    }
    return rows;
}

}  // namespace crumple::benchmark
