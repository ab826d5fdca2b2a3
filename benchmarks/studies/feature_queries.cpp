#include "studies/feature_queries.h"

#include "crumple/error.h"

namespace crumple::benchmark {
namespace {

const Impacts& impacts(Detector& detector, const Step& step) {
    return detector.find(step.start.view().moving_to(step.end_view()), ImpactQuery());
}

const Proximities& nearby(Detector& detector, const Step& step) {
    return detector.find(step.start.view(), ProximityQuery{.radius = step.radius});
}

template <class T>
std::int64_t bytes(const Array<T>& array) {
    return static_cast<std::int64_t>(array.capacity() * sizeof(T));
}
std::int64_t bytes(const ImpactList& l) { return bytes(l.pairs) + bytes(l.toi) + bytes(l.start); }
std::int64_t bytes(const ProximityList& l) { return bytes(l.pairs) + bytes(l.squared_distance) + bytes(l.touching); }

template <class Answer>
FeatureMemory memory_of(const Answer& answer) {
    FeatureMemory memory{answer.statistics.peak_memory_bytes, bytes(answer.edges)};
    for (const auto& list : answer.lists) memory.answer += bytes(list);
    return memory;
}

}  // namespace

const Statistics& ask(Detector& detector, const Step& step, FeatureQueryKind query) {
    return query == FeatureQueryKind::motion ? impacts(detector, step).statistics : nearby(detector, step).statistics;
}

Contestant asks(const Options& options, const Step& step, FeatureQueryKind query, std::string name) {
    const auto detector = std::make_shared<Detector>(options);
    return {std::move(name), "", "", [=, &step] { ask(*detector, step, query); }, {}};
}

FeatureMemory memory_of(const Step& step, FeatureQueryKind query) {
    Detector detector;
    return query == FeatureQueryKind::motion ? memory_of(impacts(detector, step)) : memory_of(nearby(detector, step));
}

std::vector<FeatureWay> feature_ways() {
    std::vector<FeatureWay> ways{{"1 thread", {.threads = 1}}, {"all threads", {}}};
    for (const auto& [simd, name] :
         {std::pair{Simd::avx2, "1 thread, AVX2"}, std::pair{Simd::sse4, "1 thread, SSE4"}}) {
        try {
            const Options options{.backend = Backend::cpu, .threads = 1, .simd = simd};
            Detector{options};
            ways.push_back({name, options});
        } catch (const Error&) {
            continue;  // this machine lacks the instruction set
        }
    }
    return ways;
}

}  // namespace crumple::benchmark
