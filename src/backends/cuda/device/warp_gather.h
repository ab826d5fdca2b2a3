#pragma once

// Gather of one record per lane of a warp from device memory. If each lane read its own record, every access would
// touch 32 cache lines; instead, neighbouring lanes copy neighbouring pieces of one record, so that an access touches a
// few. The copies go to shared memory without using registers, and a lane waits once for all of them.

#include <cuda_pipeline.h>

#include <cstring>

#include "backends/cuda/device/runtime.h"

namespace crumple::cuda {

/// Shared memory for one record per lane. All lanes of the warp call its functions together.
template <class Record>
class GatherBuffer {
   public:
    /// Starts to copy record[index]. Lanes that need none pass any valid index.
    __device__ void start(const Record* record, std::uint32_t index) {
        const unsigned lane = threadIdx.x % 32;
        for (unsigned k = 0; k < pieces; ++k) {
            const unsigned of = (32 * k + lane) / pieces, piece = (32 * k + lane) % pieces;
            const std::uint32_t i = __shfl_sync(whole_warp, index, static_cast<int>(of));
            const auto* from = reinterpret_cast<const Piece*>(record) + (std::size_t{i} * pieces + piece);
            __pipeline_memcpy_async(&piece_[of * pieces + place(of, piece)], from, sizeof(Piece));
        }
    }
    /// Returns the lane's record. All copies must be complete.
    __device__ Record own() const {
        const unsigned lane = threadIdx.x % 32;
        Piece read[pieces];
        for (unsigned piece = 0; piece < pieces; ++piece) read[piece] = piece_[lane * pieces + place(lane, piece)];
        Record record;
        std::memcpy(&record, read, sizeof record);
        return record;
    }

   private:
    struct alignas(16) Piece {
        std::uint32_t word[4];
    };
    static constexpr unsigned pieces = sizeof(Record) / sizeof(Piece);
    static_assert(sizeof(Record) % sizeof(Piece) == 0 && alignof(Record) % alignof(Piece) == 0);
    static_assert(pieces % 2 == 1 || pieces == 4 || pieces == 8);

    // Returns the place at which a piece of the record of lane `of` is stored among the pieces of that record. It is
    // such that eight lanes that read the same piece of their records hit different banks. An odd number of pieces
    // ensures that by itself; otherwise the order of pieces differs from record to record.
    __device__ static unsigned place(unsigned of, unsigned piece) {
        if constexpr (pieces % 2 == 1) return piece;
        return piece ^ (of / (8 / pieces) % pieces);
    }

    Piece piece_[32 * pieces];
};

/// Two records of each lane. gathered_pair() gathers them one after the other through the same GatherBuffer.
template <class Record>
struct RecordPair {
    Record a, b;
};
template <class Record>
__device__ RecordPair<Record> gathered_pair(const Record* record, std::uint32_t a, std::uint32_t b,
                                            GatherBuffer<Record>& buffer) {
    RecordPair<Record> pair;
    for (Record* of : {&pair.a, &pair.b}) {
        buffer.start(record, of == &pair.a ? a : b);
        __pipeline_commit();
        __pipeline_wait_prior(0);
        __syncwarp();
        *of = buffer.own();
        __syncwarp();
    }
    return pair;
}

}  // namespace crumple::cuda
