#pragma once

// Queues of a warp, in its shared memory. What few lanes have at a time waits there until there is one a lane, so that
// lanes are busy; or until there is much, so that one atomic is little for its places in a list of the device. There is
// no barrier beyond the warp's.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/layout.h"

namespace crumple::cuda {

/// All lanes of the warp call its functions together. No more than 31 elements may wait when some are added.
template <class T>
class WarpQueue {
   public:
    using Places = T[64];

    __device__ explicit WarpQueue(T* places) : places_(places), lane_(threadIdx.x % 32) {}

    __device__ unsigned size() const { return size_; }

    /// Adds the elements of those lanes that want it.
    __device__ void add(bool wants, const T& element) { add(wants, element, __ballot_sync(whole_warp, wants)); }
    /// The same where the lanes that want it are known.
    __device__ void add(bool wants, const T& element, unsigned wanting) {
        if (wants) places_[size_ + static_cast<unsigned>(__popc(wanting & ((1u << lane_) - 1)))] = element;
        size_ += static_cast<unsigned>(__popc(wanting));
        __syncwarp();
    }

    /// Takes the last elements, up to 32, for as many first lanes; the other lanes see one that is another's. Returns
    /// how many there are, of which there must be one.
    __device__ unsigned take(T& element) {
        const unsigned taken = min(size_, 32u);
        size_ -= taken;
        element = places_[size_ + min(lane_, taken - 1)];
        __syncwarp();
        return taken;
    }

   private:
    T* places_;
    unsigned lane_, size_ = 0;  // the size is the same in all lanes
};

/// Elements on their way to a list, so many at once. A device does the atomics on one address one after the other,
/// about one a nanosecond. All lanes of the warp call its functions together.
template <class T, unsigned at_once>
class ListQueue {
   public:
    using Places = T[at_once + 32];

    __device__ ListQueue(T* places, const List<T>& list) : places_(places), list_(list), lane_(threadIdx.x % 32) {}

    __device__ unsigned size() const { return size_; }
    __device__ const List<T>& list() const { return list_; }

    /// Adds the elements of those lanes that want it.
    __device__ void add(bool wants, const T& element) {
        const unsigned wanting = __ballot_sync(whole_warp, wants);
        if (wants) places_[size_ + static_cast<unsigned>(__popc(wanting & ((1u << lane_) - 1)))] = element;
        size_ += static_cast<unsigned>(__popc(wanting));
        __syncwarp();
        if (size_ >= at_once) move();
    }
    /// Moves all that wait.
    __device__ void move() {
        unsigned long long place = 0;
        if (lane_ == 0 && size_) place = atomicAdd(list_.count, static_cast<unsigned long long>(size_));
        write(__shfl_sync(whole_warp, place, 0));
    }
    /// Writes them to places of the list that have been counted as theirs.
    __device__ void write(unsigned long long place) {
        for (unsigned i = lane_; i < size_ && place + i < list_.capacity; i += 32) list_.data[place + i] = places_[i];
        size_ = 0;
        __syncwarp();
    }

   private:
    T* places_;
    const List<T>& list_;
    unsigned lane_, size_ = 0;
};

}  // namespace crumple::cuda
