// Runs two detectors on two threads.

#include <array>
#include <cstdio>
#include <random>
#include <thread>
#include <vector>

#include <crumple/crumple.h>

int main() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> number;
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<int, 3>> triangles;
    for (int t = 0; t < 20'000; ++t) {
        const std::array corner{number(random), number(random), number(random)};
        for (int k = 0; k < 3; ++k) {
            auto& vertex = vertices.emplace_back(corner);
            for (float& x : vertex) x += 0.03f * number(random);
        }
        triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    std::array<std::size_t, 2> counts{};
    const auto search = [&](std::size_t i) {
        crumple::Detector detector;
        for (int call = 0; call < 3; ++call)
            counts[i] = detector.find({vertices, triangles}, {.output = crumple::Output::contacts}).pairs.size();
    };
    std::thread first(search, 0), second(search, 1);
    first.join();
    second.join();
    std::printf("%zu pairs\n", counts[0]);
    return counts[0] == counts[1] && counts[0] > 0 ? 0 : 1;
}
