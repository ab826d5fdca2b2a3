#include "results/intersection_output.h"

#include <algorithm>
#include <type_traits>

namespace crumple {

Intersections metered(MemoryMeter* meter) {
    Intersections result;
    std::apply([&](auto&... array) { ((array = std::remove_reference_t<decltype(array)>(meter)), ...); },
               arrays(result));
    return result;
}

void clear(Intersections& result) {
    std::apply([](auto&... array) { (array.clear(), ...); }, arrays(result));
    result.any = false;
    result.count = 0;
    result.statistics = {};
}

void release(Intersections& result) {
    std::apply([](auto&... array) { (array.release(), ...); }, arrays(result));
}

void swap_out(Intersections& result, Intersections& other) {
    const auto swap_all = [&](auto&... mine) {
        // swap_elements() can throw only under a memory limit, and under a limit `other` owns no memory that would have
        // to be counted.
        std::apply([&](auto&... theirs) { (mine.swap_elements(theirs), ...); }, arrays(other));
    };
    std::apply(swap_all, arrays(result));
    other.any = result.any;
    other.count = result.count;
    other.statistics = result.statistics;
    clear(result);
}

void add(const Statistics& some, Statistics& sum) {
    for (std::size_t s = 0; s < stage_count; ++s) sum.stage_milliseconds[s] += some.stage_milliseconds[s];
    sum.clusters += some.clusters;
    sum.leaves += some.leaves;
    sum.members += some.members;
    sum.interval_tests += some.interval_tests;
    sum.box_overlaps += some.box_overlaps;
    sum.edge_tests += some.edge_tests;
    sum.double_tests += some.double_tests;
    sum.exact_tests += some.exact_tests;
    sum.rational_tests += some.rational_tests;
    sum.rational_contacts += some.rational_contacts;
}

void add_pass(const Statistics& pass, Statistics& sum) {
    add(pass, sum);
    sum.threads = pass.threads;
    sum.backend = pass.backend;
    sum.simd = pass.simd;
}

void index_pairs(const PreparedScene& scene, Intersections& result) {
    const auto first = static_cast<std::size_t>(scene.triangles[0]);
    result.offsets.assign(first + 1, 0);
    result.hit.assign(first, 0);
    result.hit_second.assign(static_cast<std::size_t>(scene.triangles[1]), 0);
    Array<std::uint8_t>& other = scene.between ? result.hit_second : result.hit;
    for (const Pair& pair : result.pairs) {
        ++result.offsets[static_cast<std::size_t>(pair.a) + 1];
        result.hit[static_cast<std::size_t>(pair.a)] = 1;
        other[static_cast<std::size_t>(pair.b)] = 1;
    }
    for (std::size_t i = 0; i < first; ++i) result.offsets[i + 1] += result.offsets[i];
}

void keep_owned(const PreparedScene& scene, const Levels& levels, Intersections& result) {
    const std::int64_t second = scene.between ? scene.triangles[0] : 0;
    const auto foreign = [&](Pair pair) { return !levels.own(pair.a, second + pair.b); };
    const auto end = std::remove_if(result.pairs.begin(), result.pairs.end(), foreign);
    result.pairs.resize(static_cast<std::size_t>(end - result.pairs.begin()));
    index_pairs(scene, result);
}

}  // namespace crumple
