#pragma once

// Records that the lanes of a warp need from memory, each another one. If each lane read its own, every access would
// touch 32 lines; here neighbouring lanes copy the pieces of one record side by side, so an access touches a few. The
// copies go to shared memory without a register, and a lane waits once for all of them.

#include <cuda_pipeline.h>

#include <cstring>

#include "backends/cuda/device/runtime.h"

namespace crumple::cuda {

/// Room in shared memory for a record a lane. All lanes of the warp call its functions together.
template <class Record>
class GatherRoom {
   public:
    /// Starts to copy record[index]. Lanes that need none name one that is there.
    __device__ void start(const Record* record, std::uint32_t index) {
        const unsigned lane = threadIdx.x % 32;
        for (unsigned k = 0; k < pieces; ++k) {
            const unsigned of = (32 * k + lane) / pieces, piece = (32 * k + lane) % pieces;
            const std::uint32_t i = __shfl_sync(whole_warp, index, static_cast<int>(of));
            const auto* from = reinterpret_cast<const Piece*>(record) + (std::size_t{i} * pieces + piece);
            __pipeline_memcpy_async(&piece_[of * pieces + place(of, piece)], from, sizeof(Piece));
        }
    }
    /// The lane's record, once all copies are done.
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

    // Eight lanes that read the same piece at once find it in other banks: where a record's pieces are odd in number of
    // themselves, else since they lie in another order in each.
    __device__ static unsigned place(unsigned of, unsigned piece) {
        if constexpr (pieces % 2 == 1) return piece;
        return piece ^ (of / (8 / pieces) % pieces);
    }

    Piece piece_[32 * pieces];
};

/// Two records of each lane, one after the other through the same room.
template <class Record>
struct RecordPair {
    Record a, b;
};
template <class Record>
__device__ RecordPair<Record> gathered_pair(const Record* record, std::uint32_t a, std::uint32_t b,
                                            GatherRoom<Record>& room) {
    RecordPair<Record> pair;
    for (Record* of : {&pair.a, &pair.b}) {
        room.start(record, of == &pair.a ? a : b);
        __pipeline_commit();
        __pipeline_wait_prior(0);
        __syncwarp();
        *of = room.own();
        __syncwarp();
    }
    return pair;
}

}  // namespace crumple::cuda
