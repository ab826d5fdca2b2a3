#include "backends/cuda/overlaps/device_overlaps.h"

#include <algorithm>

namespace crumple::cuda {

std::size_t least_crossed_pairs = 1024, surface_bytes_per_pair = 512, least_summed_faces = 16384;

namespace {

template <class T>
void upload(cudaStream_t stream, T* to, std::span<const T> from) {
    if (from.empty()) return;
    CRUMPLE_CUDA(cudaMemcpyAsync(to, from.data(), from.size_bytes(), cudaMemcpyHostToDevice, stream));
}

/// Input of the kernels on the host.
struct BatchLists {
    std::vector<RowArrays> rows;
    std::vector<unsigned long long> first_pairs;
    std::vector<PairChunk> chunks;

    /// Divides the pairs of each row into chunks. `offsets` gets the range of chunks of each row.
    BatchLists(std::span<const CrossedRow> of_batch, std::vector<std::size_t>& offsets) {
        offsets.assign(1, 0);
        for (const CrossedRow& row : of_batch) {
            const auto index = static_cast<unsigned>(first_pairs.size());
            first_pairs.push_back(row.begin);
            for (std::size_t begin = row.begin; begin < row.end; begin += pairs_per_sum)
                chunks.push_back({begin, std::min(row.end, begin + pairs_per_sum), index});
            offsets.push_back(chunks.size());
        }
    }
    void set_rows(std::span<const CrossedRow> of_batch, std::span<const SurfaceArrays> surfaces) {
        for (const CrossedRow& row : of_batch)
            rows.push_back({{surfaces[static_cast<std::size_t>(row.surface[0])],
                             surfaces[static_cast<std::size_t>(row.surface[1])]},
                            row.origin,
                            row.curves});
    }

    /// Uploads everything into arrays of the block.
    CrossingArrays upload(cudaStream_t stream, std::span<const Pair> pairs, Block& block) const {
        RowArrays* to_rows = nullptr;
        unsigned long long* to_first_pairs = nullptr;
        PairChunk* to_chunks = nullptr;
        Pair* to_pairs = nullptr;
        PackedCrossings* crossings = nullptr;
        SegmentTerms* sums = nullptr;
        place_arrays(block, [&](ArenaLayout& c) {
            to_rows = c.take<RowArrays>(rows.size());
            to_first_pairs = c.take<unsigned long long>(rows.size());
            to_chunks = c.take<PairChunk>(chunks.size());
            to_pairs = c.take<Pair>(pairs.size());
            crossings = c.take<PackedCrossings>(pairs.size());
            sums = c.take<SegmentTerms>(chunks.size());
        });
        cuda::upload(stream, to_rows, std::span(rows));
        cuda::upload(stream, to_first_pairs, std::span(first_pairs));
        cuda::upload(stream, to_chunks, std::span(chunks));
        cuda::upload(stream, to_pairs, pairs);
        return {to_rows,   to_first_pairs, rows.size(),   to_pairs, pairs.size(),
                crossings, to_chunks,      chunks.size(), sums};
    }
};

}  // namespace

void DeviceOverlaps::upload(std::span<const DeviceSurface> surfaces) {
    struct Places {
        Vec3d* points;
        std::int32_t* corners;
    };
    std::vector<Places> places(surfaces.size());
    place_arrays(surfaces_, [&](ArenaLayout& c) {
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            places[i] = {c.take<Vec3d>(surfaces[i].points.size()), c.take<std::int32_t>(surfaces[i].corners.size())};
    });
    uploaded_.clear();
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        cuda::upload(state_.stream.get(), places[i].points, surfaces[i].points);
        cuda::upload(state_.stream.get(), places[i].corners, surfaces[i].corners);
        uploaded_.push_back({places[i].points, places[i].corners});
    }
}

bool DeviceOverlaps::cross(std::span<const DeviceSurface> surfaces, std::span<const CrossedRow> rows,
                           std::span<const Pair> pairs, bool numbers, BatchCrossings& crossings) {
    const std::scoped_lock lock(mutex_);
    const Device::Current current(state_.device);
    const cudaStream_t stream = state_.stream.get();
    return fits([&] {
        BatchLists lists(rows, crossings.offsets);
        upload(surfaces);
        lists.set_rows(rows, uploaded_);
        const CrossingArrays arrays = lists.upload(stream, pairs, lists_);
        decide_crossings(state_.geometry, stream, arrays);
        sum_segments(state_.geometry, stream, arrays, numbers);
        crossings.pairs.resize(arrays.pair_count);
        crossings.sums.resize(arrays.chunk_count);
        copy_now(stream, crossings.pairs.data(), arrays.crossings, arrays.pair_count, cudaMemcpyDeviceToHost);
        copy_now(stream, crossings.sums.data(), arrays.sums, arrays.chunk_count, cudaMemcpyDeviceToHost);
    });
}

bool DeviceOverlaps::add_faces(std::int32_t surface, std::span<const CountedFace> faces, const Vec3d& origin,
                               std::vector<VolumeTerms<Enclosed>>& sums) {
    const std::scoped_lock lock(mutex_);
    const Device::Current current(state_.device);
    const cudaStream_t stream = state_.stream.get();
    return fits([&] {
        sums.resize((faces.size() + faces_per_sum - 1) / faces_per_sum);
        CountedFace* counted = nullptr;
        VolumeTerms<Enclosed>* found = nullptr;
        place_arrays(lists_, [&](ArenaLayout& c) {
            counted = c.take<CountedFace>(faces.size());
            found = c.take<VolumeTerms<Enclosed>>(sums.size());
        });
        cuda::upload(stream, counted, faces);
        sum_faces(state_.geometry, stream, uploaded_[static_cast<std::size_t>(surface)], counted, faces.size(), origin,
                  found);
        copy_now(stream, sums.data(), found, sums.size(), cudaMemcpyDeviceToHost);
    });
}

void DeviceOverlaps::end_batch() {
    if (state_.meter.limit > 0) release();
}

void DeviceOverlaps::release() {
    surfaces_.release();
    lists_.release();
    uploaded_.clear();
}

}  // namespace crumple::cuda
