// Search in chunks for pairs of triangles. Each pair is found twice: counted, then written to its place.

#include "backends/cuda/intersections/intersection_finder.h"

namespace crumple::cuda {

void IntersectionFinder::find_in_chunks() {
    answer().total = count_in_chunks();
    // The offsets are saved on the host while their block grows.
    const std::size_t n = static_cast<std::size_t>(scene().triangles[0]) + 1;
    Array<unsigned long long> offsets(&meter_);
    copy_now(stream_, offsets.resize_discard(n), answer().output.offsets, n, cudaMemcpyDeviceToHost);
    drop_lists();
    place_arrays(slot().rows, [&](ArenaLayout& c) { cut_rows(c, static_cast<std::size_t>(answer().total)); });
    const OutputArrays& output = answer().output;
    copy_now(stream_, output.offsets, offsets.data(), n, cudaMemcpyHostToDevice);
    copy_now(stream_, output.next, offsets.data(), n, cudaMemcpyHostToDevice);
    offsets.release();
    statistics_ = {};
    pass_over_chunks({Hits::Mode::fill, {}, output.next, output.bucketed});
    BatchedClear batch;
    clear_flags(batch, scene(), output);
    cuda::clear(batch, pass_.counters);
    batch.launch(geometry_, stream_);
    list_parts(geometry_, stream_, n - 1, output, pass_.counters);
    order_buckets(geometry_, stream_, n - 1, output, pass_.counters, nullptr);
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
}

unsigned long long IntersectionFinder::count_in_chunks() {
    place_arrays(slot().rows, [&](ArenaLayout& c) { cut_rows(c, 0); });
    BatchedClear batch;
    clear_rows(batch);
    batch.launch(geometry_, stream_);
    const OutputArrays& output = answer().output;
    pass_over_chunks({Hits::Mode::count, {}, output.offsets, nullptr});
    make_offsets(geometry_, stream_, static_cast<std::size_t>(scene().triangles[0]), output, pass_.counters);
    unsigned long long total = 0;
    copy_now(stream_, &total, output.offsets + scene().triangles[0], 1, cudaMemcpyDeviceToHost);
    return total;
}

bool IntersectionFinder::any_in_chunks() { return pass_over_chunks({Hits::Mode::any, {}, nullptr, nullptr}) > 0; }

// Searches all chunks, and records the pairs as `hits` demands. Returns their number. For Mode::any, stops after the
// first slice with a hit.
std::size_t IntersectionFinder::pass_over_chunks(Hits hits) {
    std::size_t found = 0;
    over_chunks([&] {
        hits.list.count = &pass_.counters->hits;
        pass_.narrow(hits);
        const Counters counters = read_counters();
        count(counters, pass_.plan);
        found += counters.hits;
        if (counters.beyond > 0) {
            const std::size_t decided = decide_unresolved(static_cast<std::size_t>(counters.beyond));
            if (hits.mode != Hits::Mode::any) add_hits(geometry_, stream_, scene(), pass_.beyond(), decided, hits);
            found += decided;
        }
        if (hits.mode == Hits::Mode::count) require_capacity(found);
        return hits.mode != Hits::Mode::any || found == 0;
    });
    return found;
}

// Throws MemoryMeter::Exceeded if a result with so many pairs alone exceeds the limit.
void IntersectionFinder::require_capacity(std::size_t pairs) const {
    const auto bytes = static_cast<std::int64_t>(ResultOnDevice::bytes(scene(), pairs, query().contacts()));
    if (meter_.limit > 0 && bytes > meter_.limit) throw MemoryMeter::Exceeded{bytes};
}

}  // namespace crumple::cuda
