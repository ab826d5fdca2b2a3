#include "backends/cuda/input/world_names.h"

#include <algorithm>

namespace crumple::cuda {
namespace {

struct BodyTriangle {
    std::int32_t body, triangle;
};
__device__ BodyTriangle name_of(const WorldNames& names, std::int32_t t) {
    const std::int32_t c = names.classes_of[t];
    return {names.classes[c].body, t - names.first_of_class[c]};
}

// Fills the arrays of worlds and those of pairs, one element per thread.
__global__ void name_kernel(std::size_t firsts, OutputArrays out, WorldNames names, WorldArrays to) {
    const auto worlds = static_cast<std::size_t>(names.worlds);
    for (std::size_t w = grid_thread(); w <= worlds; w += grid_stride()) {
        const auto begin = static_cast<std::int64_t>(out.offsets[names.first_of_world[w]]);
        to.offsets[w] = begin;
        if (w == worlds) continue;
        const std::int64_t count = static_cast<std::int64_t>(out.offsets[names.first_of_world[w + 1]]) - begin;
        to.counts[w] = count;
        to.hit[w] = count > 0;
    }
    if (!names.pairs) return;
    const unsigned long long total = out.total(firsts);
    for (unsigned long long i = grid_thread(); i < total; i += grid_stride()) {
        const Pair pair = out.pairs[i];
        const BodyTriangle a = name_of(names, pair.a), b = name_of(names, pair.b);
        to.bodies[i] = {a.body, b.body};
        to.pairs[i] = {a.triangle, b.triangle};
    }
}

}  // namespace

void name_pairs(const Geometry& geometry, cudaStream_t stream, std::size_t firsts, const OutputArrays& output,
                const WorldNames& names, const WorldArrays& arrays) {
    const std::size_t elements =
        std::max<std::size_t>(names.pairs ? output.capacity : 0, static_cast<std::size_t>(names.worlds) + 1);
    Launch{stream, geometry.blocks(elements), geometry.threads}(name_kernel, firsts, output, names, arrays);
}

}  // namespace crumple::cuda
