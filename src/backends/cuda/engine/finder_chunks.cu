// A search in chunks: cluster by cluster, each in as many slices as the lists require.

#include "backends/cuda/engine/finder.h"

namespace crumple::cuda {

void Finder::refuse_worlds() const {
    if (scene().worlds > 1 || input().posed()) throw MemoryMeter::Exceeded{};
}

void Finder::in_chunks(FunctionRef<void()> work) {
    const auto with_shortest = [&](bool shortest) {
        drop_lists();
        statistics_ = {};
        planned_for_ = {};
        choose_chunks(stages_.plan, shortest ? 0 : bytes_for_lists(meter_));
        work();
    };
    if (slot().low_memory || !fits([&] { with_shortest(false); })) with_shortest(true);
}

// Places the lists and finds the scene's clusters, whose members are then listed one cluster at a time.
void Finder::place_chunks() {
    place_arrays(warm_starts_, [&](ArenaLayout& c) { stages_.warm_starts.cut(c, stages_.plan); });
    place_arrays(work_, [&](ArenaLayout& c) { stages_.cut(c); });
    BatchedClear batch;
    stages_.clear(batch);
    input().clear(batch);
    batch.launch(geometry_, stream_);
    input().enqueue(geometry_, stream_, stages_.counters);
    make_ready();
    stages_.bounds();
    input().throw_error(read_counters());
    stages_.subdivide_scene();
}

void Finder::over_chunks(FunctionRef<bool()> slice) {
    bool laid_out = false;
    for (int k = 0; k < stages_.plan.fan_out[0];) {
        if (!laid_out) place_chunks();
        BatchedClear batch;
        stages_.clear(batch);
        batch.launch(geometry_, stream_);
        stages_.subdivide_clusters(std::uint64_t{1} << k);
        laid_out = stages_.plan.accepts_chunk(read_counters());
        if (!laid_out) continue;
        stages_.align();
        stages_.sort();
        const Counters sorted = read_counters();
        laid_out = stages_.plan.accepts_units(sorted);
        if (!laid_out) continue;
        count(sorted, stages_.plan);
        if (!over_slices(slice)) return;
        ++k;
    }
}

// Sweeps a cluster in slices. Halves a slice until its pairs of triangles fit their list; then all other lists suffice,
// too.
bool Finder::over_slices(FunctionRef<bool()> narrow_slice) {
    for (Slice slice{}; slice.turn < slice.turns;) {
        cancellation_.check();
        stages_.clear_counters();
        stages_.sweep(slice);
        if (read_counters().survivors > stages_.plan.survivors) {
            slice = {2 * slice.turn, 2 * slice.turns};
            continue;
        }
        if (!narrow_slice()) return false;
        ++slice.turn;
    }
    return true;
}

}  // namespace crumple::cuda
