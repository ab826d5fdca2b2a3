#include "distributed/part_search.h"

#include <utility>

#include "scene/prepared_scene.h"

namespace crumple::distribute {

template <class Work>
void PartSearch::guarded(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
                         std::stop_token stop, Work work) {
    const MeshView mesh = part.mesh.view();
    backend->swap_memory(memory);
    const auto attempt = [&] { work(prepare_scene(mesh, nullptr, query.weld, *backend, buffers)); };
    run(std::move(stop), attempt, [](std::int64_t) { return true; });
    backend->swap_memory(memory);
}

const Intersections& PartSearch::find(const Part& part, const IntersectionQuery& query,
                                      std::unique_ptr<SceneMemory>& memory, std::stop_token stop) {
    result.statistics = {};
    guarded(part, query, memory, std::move(stop),
            [&](const PreparedScene& scene) { backend->find(scene, query, &part, result); });
    result.statistics.peak_memory_bytes = meter.peak;
    return result;
}

bool PartSearch::any(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
                     std::stop_token stop) {
    bool found = false;
    guarded(part, query, memory, std::move(stop),
            [&](const PreparedScene& scene) { found = backend->any(scene, query); });
    return found;
}

template <class Query, class Result>
const Result& PartSearch::find_features(const Part& part, const Query& query, std::unique_ptr<SceneMemory>& memory,
                                        std::stop_token stop, Result& result) {
    bool low_memory = false;
    const auto attempt = [&] { features.find(*backend, part, query, low_memory, result); };
    backend->swap_memory(memory);
    run(std::move(stop), attempt, [&](std::int64_t) { return low_memory = true; });
    backend->swap_memory(memory);
    result.statistics.peak_memory_bytes = meter.peak;
    return result;
}

const Impacts& PartSearch::find(const Part& part, const ImpactQuery& query, std::unique_ptr<SceneMemory>& memory,
                                std::stop_token stop) {
    return find_features(part, query, memory, std::move(stop), impacts);
}
const Proximities& PartSearch::find(const Part& part, const ProximityQuery& query, std::unique_ptr<SceneMemory>& memory,
                                    std::stop_token stop) {
    return find_features(part, query, memory, std::move(stop), nearby);
}

void PartSearch::find(const MeshView& mesh, const OverlapQuery& query, Array<Pair>& pairs, std::stop_token stop,
                      Overlaps& rows) {
    const Shape shapes[] = {Shape(mesh)};
    const Body bodies[] = {{.self = true}};
    Overlaps part = metered_overlaps(&meter);
    part.part = {0, 1, true};
    part.part_pairs = std::move(pairs);
    part.part_bodies.assign(part.part_pairs.size(), {0, 0});
    WorldCalls::combine(World{shapes, bodies, {}}, query, {&part, 1}, std::move(stop));
    swap_out(overlaps, rows);
}

void PartSearch::read_surfaces(const World& world, bool weld, std::stop_token stop,
                               FunctionRef<void(const ClosedBodies&)> use) {
    const auto attempt = [&] {
        closed_bodies.read(host_backend(), world, {}, weld);
        use(closed_bodies);
    };
    run(std::move(stop), attempt, [](std::int64_t) { return true; });
}

}  // namespace crumple::distribute
