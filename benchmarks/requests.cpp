#include "requests.h"

#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "crumple/detector.h"
#include "peers/peers.h"

namespace crumple::benchmark {
namespace {

template <class T>
void write(const std::string& path, const std::vector<T>& values) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
    if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

nlohmann::json dump(const Workload& workload, const Contestant& contestant, const std::string& folder) {
    std::visit([&](const auto& values) { write(folder + "/vertices", values); }, workload.a.vertices);
    write(folder + "/triangles", workload.a.triangles);
    if (workload.query == Query::between) {
        std::visit([&](const auto& values) { write(folder + "/vertices_b", values); }, workload.b.vertices);
        write(folder + "/triangles_b", workload.b.triangles);
    }
    nlohmann::json description{{"workload", workload.name},
                               {"question", name_of(workload.query)},
                               {"scalar", workload.scalar()},
                               {"scalar_b", workload.b.precision() == ScalarType::float32 ? "float32" : "float64"},
                               {"triangles", workload.triangle_count()}};
    contestant.call();
    if (contestant.pairs) {
        const std::vector<Pair> pairs = contestant.pairs();
        write(folder + "/pairs", pairs);
        description["pairs"] = pairs.size();
    }
    return description;
}

}  // namespace

void serve(const Workload& workload) {
    const std::vector<Contestant> contestants = crumple_contestants(workload);
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string request, folder;
        words >> request;
        if (request == "dump" && words >> folder) {
            std::cout << dump(workload, contestants.back(), folder).dump() << std::endl;
            continue;
        }
        if (int count = 0; request == "parts" && words >> count >> folder) {
            std::vector<std::uint64_t> masks(static_cast<std::size_t>(workload.a.triangle_count()));
            for (const Part& part : Detector().partition(workload.a.view(), {}, count))
                for (const std::int32_t t : part.mesh.ids)
                    masks[static_cast<std::size_t>(t)] |= std::uint64_t{1} << part.index;
            write(folder + "/parts", masks);
            std::cout << count << std::endl;
            continue;
        }
        if (request == "processors") {
            std::cout << processors_at_hand() << std::endl;
            continue;
        }
        int threads = 0;
        double seconds = 0;
        if (request != "run" || !(words >> threads >> seconds)) throw std::runtime_error("no such request: " + line);
        const std::vector<double> times = time_slice(threads == 1 ? contestants[0] : contestants[1], seconds);
        std::cout << nlohmann::json(times).dump() << std::endl;
    }
}

}  // namespace crumple::benchmark
