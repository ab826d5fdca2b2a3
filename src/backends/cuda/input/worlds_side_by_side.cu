#include "backends/cuda/input/worlds_side_by_side.h"

#include <vector>

namespace crumple::cuda {

void Worlds::bring(cudaStream_t stream, const PreparedScene& host) {
    forget();
    if (host.worlds == 1) return;
    const auto n = static_cast<std::size_t>(host.worlds);
    place_arrays(block_, [&](ArenaLayout& c) {
        triangles_ = {c.take<unsigned long long>(n + 1), c.take<unsigned long long>(n)};
        found_ = c.take<unsigned long long>(n);
    });
    std::vector<unsigned long long> first(host.first_of_world, host.first_of_world + n + 1), count(n);
    for (std::size_t w = 0; w < n; ++w) count[w] = first[w + 1] - first[w];
    copy_now(stream, triangles_.first, first.data(), n + 1, cudaMemcpyHostToDevice);
    copy_now(stream, triangles_.count, count.data(), n, cudaMemcpyHostToDevice);
    fill(stream, found_, 0, n * sizeof *found_);
}

void Worlds::read(cudaStream_t stream, std::span<std::uint8_t> flags) const {
    std::vector<unsigned long long> found(flags.size());
    copy_now(stream, found.data(), found_, found.size(), cudaMemcpyDeviceToHost);
    for (std::size_t w = 0; w < flags.size(); ++w)
        if (found[w] > 0) flags[w] = 1;
}

void Worlds::release() {
    forget();
    block_.release();
}

}  // namespace crumple::cuda
