// The decision as device code. On a device, and on the CPU, it must say what the host says.

#include "cuda_on_cpu/portable/portable.h"
#include "geometry/decide.h"
#include "geometry/decision.h"
#include "geometry/random_pairs.h"

namespace crumple {
namespace {

class Device : public portable::DeviceTest {};

template <class Signs>
__global__ void decide_all(const TrianglePair* pairs, int count, Neighbours neighbours, Intersections intersections,
                           Verdict* verdicts) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i >= count) return;
    Signs signs;
    verdicts[i] = decide(pairs[i].a, pairs[i].b, neighbours, intersections, signs);
}

template <class Signs>
std::vector<Verdict> decide_on_device(const std::vector<TrianglePair>& pairs, Intersections intersections) {
    const portable::Array<TrianglePair> input(pairs);
    const portable::Array<Verdict> output(pairs.size());
    const auto blocks = static_cast<unsigned>((pairs.size() + 127) / 128);
    portable::launch(&decide_all<Signs>, blocks, 128, 0, input.data(), static_cast<int>(pairs.size()),
                     Neighbours::geometric, intersections, output.data());
    return output.values();
}

TEST_F(Device, decides_as_the_host_does) {
    for (const Kind kind : all_kinds) {
        RandomPairs random(kind, 47);
        std::vector<TrianglePair> pairs;
        for (int i = 0; i < 4'000; ++i) pairs.push_back(random());
        for (const Intersections intersections : {Intersections::all, Intersections::proper}) {
            const auto filtered = decide_on_device<FilteredSigns>(pairs, intersections);
            const auto exact = decide_on_device<ExactSigns>(pairs, intersections);
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                DecisionCounts counts;
                const bool collides = collide(pairs[i].a, pairs[i].b, Neighbours::geometric, intersections, counts);
                const Verdict expected = collides ? Verdict::collides : Verdict::apart;
                ASSERT_EQ(exact[i], counts.rational ? Verdict::undecided : expected) << pairs[i];
                if (filtered[i] != Verdict::undecided) {
                    ASSERT_EQ(filtered[i], expected) << pairs[i];
                }
            }
        }
    }
}

}  // namespace
}  // namespace crumple
