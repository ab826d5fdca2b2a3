// A search in chunks: cluster by cluster, each in as many slices as the lists demand, all of it twice.

#include "backends/cuda/intersections/intersection_search.h"

#include <algorithm>

namespace crumple::cuda {

void Search::plan_chunks(Lists lists) {
    planned_for_ = {};
    laid_out_.reset();
    lists_of_ = nobody;
    pass_.plan.choose_chunks(pass_.scene.triangle_count(), pass_.scene.between, options_,
                             lists == Lists::roomy ? bytes_for_lists(meter_) : 0);
}

void Search::find_in_chunks(Lists lists) {
    drop_lists();
    answer().total = count_in_chunks(lists);
    // The offsets wait with the host while their block grows.
    const std::size_t n = static_cast<std::size_t>(pass_.scene.triangles[0]) + 1;
    Array<unsigned long long> offsets(&meter_);
    copy(offsets.resize_discard(n), answer().output.offsets, n, cudaMemcpyDeviceToHost);
    drop_lists();
    answer().make_room(pass_.scene, static_cast<std::size_t>(answer().total));
    const OutputArrays& output = answer().output;
    copy(output.offsets, offsets.data(), n, cudaMemcpyHostToDevice);
    copy(output.next, offsets.data(), n, cudaMemcpyHostToDevice);
    offsets.release();
    statistics_ = {};
    pass_over_chunks({Hits::Mode::fill, {}, output.next, nullptr, output.second});
    Clearing clearing;
    clear_flags(clearing, pass_.scene, output);
    cuda::clear(clearing, pass_.counters);
    clearing.launch(geometry_, stream_);
    list_parts(geometry_, stream_, n - 1, output, pass_.counters);
    order_buckets(geometry_, stream_, n - 1, output, pass_.counters, nullptr);
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
    planned_for_ = {};
}

unsigned long long Search::count_in_chunks(Lists lists) {
    plan_chunks(lists);
    answer().make_room(pass_.scene, 0);
    Clearing clearing;
    answer().clear(clearing, pass_.scene);
    clearing.launch(geometry_, stream_);
    const OutputArrays& output = answer().output;
    pass_over_chunks({Hits::Mode::count, {}, output.offsets, output.by_tile, nullptr});
    make_offsets(geometry_, stream_, static_cast<std::size_t>(pass_.scene.triangles[0]), output, pass_.counters);
    unsigned long long total = 0;
    copy(&total, output.offsets + pass_.scene.triangles[0], 1, cudaMemcpyDeviceToHost);
    return total;
}

// The scene's clusters, for which members of one at a time are listed.
void Search::lay_out_chunks() {
    lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
    lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
    Clearing clearing;
    pass_.clear(clearing);
    input().clear(clearing);
    clearing.launch(geometry_, stream_);
    input().enqueue(geometry_, stream_, pass_.counters);
    pass_.bounds();
    input().throw_error(read_counters());
    pass_.subdivide_scene();
}

bool Search::any_in_chunks(Lists lists) {
    drop_lists();
    plan_chunks(lists);
    return pass_over_chunks({Hits::Mode::any, {}, nullptr, nullptr, nullptr}) > 0;
}

// Returns how many pairs there were; one is enough if any will do.
std::size_t Search::pass_over_chunks(Hits hits) {
    bool laid_out = false;
    std::size_t counted = 0;
    for (int k = 0; k < pass_.plan.fan_out[0];) {
        if (!laid_out) lay_out_chunks();
        Clearing clearing;
        pass_.clear(clearing);
        clearing.launch(geometry_, stream_);
        pass_.subdivide_clusters(std::uint64_t{1} << k);
        laid_out = pass_.plan.accepts_chunk(read_counters());
        if (!laid_out) continue;
        pass_.align();
        pass_.sort();
        const Counters sorted = read_counters();
        laid_out = pass_.plan.accepts_units(sorted);
        if (!laid_out) continue;
        count(sorted, pass_.plan);
        hits.list.count = &pass_.counters->hits;
        pass_over_slices(hits, counted);
        if (hits.mode == Hits::Mode::any && counted > 0) break;
        ++k;
    }
    return counted;
}

void Search::pass_over_slices(Hits hits, std::size_t& counted) {
    for (Slice slice{}; slice.turn < slice.turns;) {
        cancellation_.check();
        pass_.clear_counters();
        pass_.sweep(slice);
        if (read_counters().survivors > pass_.plan.survivors) {
            slice = {2 * slice.turn, 2 * slice.turns};
            continue;
        }
        pass_.narrow(hits);
        const Counters counters = read_counters();
        count(counters, pass_.plan);
        counted += counters.hits;
        if (counters.beyond > 0) {
            const std::size_t found = decide_beyond(static_cast<std::size_t>(counters.beyond));
            if (hits.mode != Hits::Mode::any) add_hits(geometry_, stream_, pass_.scene, pass_.beyond(), found, hits);
            counted += found;
        }
        if (hits.mode == Hits::Mode::count) require_room(counted);
        if (hits.mode == Hits::Mode::any && counted > 0) return;
        ++slice.turn;
    }
}

// Throws if an answer with so many pairs alone exceeds the limit.
void Search::require_room(std::size_t pairs) const {
    const auto bytes = static_cast<std::int64_t>(Answer::bytes(pass_.scene, pairs, query().contacts()));
    if (meter_.limit > 0 && bytes > meter_.limit) throw MemoryMeter::Exceeded{bytes};
}

}  // namespace crumple::cuda
