#include "studies/studies.h"

#include <array>
#include <memory>

namespace crumple::benchmark {
namespace {

constexpr std::array list{
    Study{"scenes", "every scene on every backend, instruction set, number of threads; warm, cold, peak memory",
          study_scenes},
    Study{"sequences", "scenes that move: stages frame by frame, warm and cold centres, peers", study_sequences},
    Study{"stages", "where the time goes, and how many pairs each filter leaves", study_stages},
    Study{"growth", "time and memory over the number of triangles", study_growth},
    Study{"features", "motion and nearness: where the time goes, what each filter leaves, threads, instruction sets",
          study_features},
    Study{"feature_growth", "motion and nearness: time and memory over the number of triangles", study_feature_growth},
    Study{"near_filters", "nearness: radii of vertices, neighbours and rest shapes, compared with one radius",
          study_near_filters},
    Study{"first_call", "first call of a new process and of a new detector, compared with a warm call",
          study_first_call},
    Study{"reading", "binary STL from the page cache, without and with welding", study_reading},
    Study{"cost_per_box_overlap", "triangles of unequal size: time per overlapping pair of boxes",
          study_cost_per_box_overlap},
    Study{"ground", "two huge triangles under the cloth", study_ground},
    Study{"virtual_subdivision", "large triangles cut into pieces: what [MZ] 5.1 proposes", study_virtual_subdivision},
    Study{"membership", "[MZ]'s rules of membership and local ones: members added, time, pairs lost", study_membership},
    Study{"method", "Options::method: sweep directions and rules of membership in whole searches", study_method},
    Study{"axes", "principal components against fixed axes, three axes of a box against two", study_axes},
    Study{"parts", "2 to 64 parts searched separately: how work grows, and the largest part", study_parts},
    Study{"ranks", "2 to 64 simulated ranks: balance, work relative to one process, bytes sent", study_ranks},
    Study{"scaling", "1 to 1,024 simulated ranks: what each computes and sends in a frame that moves", study_scaling},
    Study{"streaming", "results in blocks against results at once", study_streaming},
    Study{"two_clusters", "[MZ]'s two clusters, swept whole, against leaves", study_two_clusters},
    Study{"threads", "one thread to all", study_threads},
    Study{"simd", "instruction sets", study_simd},
    Study{"clusters", "Options::clusters", study_clusters},
    Study{"leaf_size", "Options::leaf_size", study_leaf_size},
    Study{"fuzziness", "FuzzyCMeans::fuzziness", study_fuzziness},
    Study{"iterations", "FuzzyCMeans::max_iterations, on moving scenes", study_iterations},
    Study{"first_iterations", "FuzzyCMeans::first_iterations, a new detector at each call", study_first_iterations},
};

}  // namespace

std::span<const Study> studies() { return list; }

std::vector<std::string> choose_scenes(const StudySettings& settings, std::vector<std::string> real,
                                       std::vector<std::string> procedural) {
    if (!settings.scenes.empty()) return settings.scenes;
    std::vector<std::string> scenes = real_scenes().empty() ? std::move(procedural) : std::move(real);
    if (settings.quick && scenes.size() > 2) scenes.resize(2);
    return scenes;
}

Contestant crumple_with(const Options& options, const Workload& workload, std::string name) {
    const auto detector = std::make_shared<Detector>(options);
    const MeshView a = workload.a.view(), b = workload.b.view();
    const Query query = workload.query;
    Contestant contestant{std::move(name), "", "", {}, {}};
    contestant.call = [=] {
        if (query == Query::self) detector->find(a);
        if (query == Query::between) detector->find({a, b});
        if (query == Query::any) detector->any(a);
    };
    return contestant;
}

}  // namespace crumple::benchmark
