#include "backends/cpu/stages/output.h"

namespace crumple::cpu {
namespace {

void mark_hits(std::span<const std::span<const Pair>> pieces, bool between, std::int32_t second,
               Intersections& result) {
    std::uint8_t* first_hit = result.hit.data();
    std::uint8_t* second_hit = between ? result.hit_second.data() : first_hit;
    for (const auto& piece : pieces)
        for (const Pair& pair : piece) first_hit[pair.a] = second_hit[pair.b - second] = 1;
}

}  // namespace

void write_output(const PreparedScene& scene, Workers& workers, std::span<const Array<Pair>* const> found,
                  OutputScratch& scratch, Intersections& result) {
    const auto n = static_cast<std::int32_t>(scene.triangles[0]);
    const auto second = static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
    const auto seconds = static_cast<std::int32_t>(scene.between ? scene.triangles[1] : scene.triangles[0]);
    result.hit.assign(static_cast<std::size_t>(n), 0);
    result.hit_second.assign(static_cast<std::size_t>(scene.triangles[1]), 0);
    // Flags are a task of their own: one thread writes them all, while the others sort.
    const auto mark = [&](std::span<const std::span<const Pair>> pieces) {
        mark_hits(pieces, scene.between, second, result);
    };
    sort_pairs(workers, found, {n, seconds, second}, scratch, result.pairs, result.offsets, mark);
}

}  // namespace crumple::cpu
