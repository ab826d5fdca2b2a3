#include "backends/cuda/stages/batched_clear.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace crumple::cuda {
namespace {

__global__ void clear_kernel(BatchedClear::Ranges ranges) {
    for (int r = 0; r < ranges.count; ++r) {
        const BatchedClear::Range range = ranges.range[r];
        for (std::size_t i = grid_thread(); i < range.words; i += grid_stride())
            range.begin[i] = range.from ? range.from[i] : range.word;
    }
}

}  // namespace

void BatchedClear::add(void* memory, std::size_t bytes, unsigned word) {
    add({static_cast<unsigned*>(memory), bytes / sizeof(unsigned), word, nullptr});
}

void BatchedClear::copy(void* memory, const void* from, std::size_t bytes) {
    add({static_cast<unsigned*>(memory), bytes / sizeof(unsigned), 0, static_cast<const unsigned*>(from)});
}

void BatchedClear::add(const Range& range) {
    if (range.words == 0) return;
    if (ranges_.count == static_cast<int>(std::size(ranges_.range))) throw std::logic_error("too many arrays to clear");
    ranges_.range[ranges_.count++] = range;
}

void BatchedClear::launch(const Geometry& geometry, cudaStream_t stream) const {
    std::size_t most = 0;
    for (int r = 0; r < ranges_.count; ++r) most = std::max(most, ranges_.range[r].words);
    if (most > 0) Launch{stream, geometry.blocks(most), geometry.threads}(clear_kernel, ranges_);
}

}  // namespace crumple::cuda
