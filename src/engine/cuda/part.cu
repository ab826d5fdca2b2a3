#include "engine/cuda/part.h"

#include "engine/cuda/gather.h"
#include "model/part.h"

namespace crumple::cuda {

std::vector<Part> make_parts(const Geometry& geometry, cudaStream_t stream, Input& input, MemoryMeter& meter,
                             int count) {
    const Scene& scene = input.scene();
    PartSample sample(scene.triangle_count());
    // Two samples a pair, since it is pairs that are gathered.
    std::vector<Pair> pairs((sample.size() + 1) / 2);
    const auto triangle = [&](std::size_t i) {
        return static_cast<std::int32_t>(sample.triangle(std::min(i, sample.size() - 1)));
    };
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = {triangle(2 * i), triangle(2 * i + 1)};

    Block block(meter);
    Counters* counters = nullptr;
    Pair* sampled = nullptr;
    lay_out(block, [&](Cutter& c) {
        counters = c.take<Counters>(1);
        sampled = c.take<Pair>(pairs.size());
    });
    const auto look = [&] {
        Clearing clearing;
        clear(clearing, counters);
        input.clear(clearing);
        clearing.launch(geometry, stream);
        input.enqueue(geometry, stream, counters);
        check_triangles(geometry, stream, scene, counters);
        Counters found;
        copy_now(stream, &found, counters, 1, cudaMemcpyDeviceToHost);
        input.throw_error(found);
    };
    input.want({}, nullptr);
    look();
    SceneBox box;
    copy_now(stream, &box, input.box(), 1, cudaMemcpyDeviceToHost);
    const Normaliser normalise = normaliser_of(box);
    copy_now(stream, sampled, pairs.data(), pairs.size(), cudaMemcpyHostToDevice);
    Gathered(geometry, stream, scene, meter)
        .each(sampled, pairs.size(), 0, [&](std::size_t i, const Triangle& a, const Triangle& b) {
            sample.set(2 * i, a, normalise);
            if (2 * i + 1 < sample.size()) sample.set(2 * i + 1, b, normalise);
        });

    const Part centres = sample.centres(count, normalise);
    input.want({}, &centres);
    look();
    std::vector<std::uint64_t> masks(static_cast<std::size_t>(scene.triangle_count()));
    copy_now(stream, masks.data(), input.part_mask(), masks.size(), cudaMemcpyDeviceToHost);
    return list_members(centres, masks, scene.triangles[0]);
}

}  // namespace crumple::cuda
