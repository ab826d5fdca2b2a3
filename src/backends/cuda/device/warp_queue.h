#pragma once

// Queues of a warp, in shared memory. Elements that only few lanes produce at a time wait until there is one per lane,
// so that all lanes are busy (WarpQueue), or until there are enough to reserve places in a device list with one atomic
// (ListQueue). Only the lanes of the warp synchronize.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/layout.h"

namespace crumple::cuda {

/// Queue of elements for the lanes of a warp, which call its functions together. At most 31 elements may wait when some
/// are added.
template <class T>
class WarpQueue {
   public:
    using Places = T[64];

    __device__ explicit WarpQueue(T* places) : places_(places), lane_(threadIdx.x % 32) {}

    __device__ unsigned size() const { return size_; }

    /// Adds the elements of the lanes that pass true.
    __device__ void add(bool wants, const T& element) { add(wants, element, __ballot_sync(whole_warp, wants)); }
    /// Adds the same elements. `wanting`: the ballot of the first argument, for callers that have it already.
    __device__ void add(bool wants, const T& element, unsigned wanting) {
        if (wants) places_[size_ + static_cast<unsigned>(__popc(wanting & ((1u << lane_) - 1)))] = element;
        size_ += static_cast<unsigned>(__popc(wanting));
        __syncwarp();
    }

    /// Removes the last elements, up to 32, and returns their number. The first lanes get one each, the other lanes a
    /// copy of another lane's. The queue must not be empty.
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

/// Distributes the elements that still wait in the queues of a block's warps to its threads, so that full warps process
/// them: thread i gets the i-th of all. Returns false in threads that get none. All threads of the block call it
/// together, as the last user of the queues; each queue has at most 31 elements. `sizes`: shared memory, one element
/// per warp. `places(w)`: the places of warp w.
template <class T, class Places>
__device__ bool distribute_rest(const WarpQueue<T>& queue, unsigned* sizes, Places places, T& element) {
    const unsigned warps = blockDim.x / 32;
    if (threadIdx.x % 32 == 0) sizes[threadIdx.x / 32] = queue.size();
    __syncthreads();
    unsigned i = threadIdx.x, warp = 0;
    while (warp < warps && i >= sizes[warp]) i -= sizes[warp++];
    if (warp == warps) return false;
    element = places(warp)[i];
    return true;
}

/// Queue of elements for a list, which are appended `at_once` or more at a time, because a device serialises atomics on
/// one address, at about one per nanosecond. All lanes of the warp call its functions together.
template <class T, unsigned at_once>
class ListQueue {
   public:
    using Places = T[at_once + 32];

    __device__ ListQueue(T* places, const List<T>& list) : places_(places), list_(list), lane_(threadIdx.x % 32) {}

    __device__ unsigned size() const { return size_; }

    /// Adds the elements of the lanes that pass true.
    __device__ void add(bool wants, const T& element) {
        const unsigned wanting = __ballot_sync(whole_warp, wants);
        if (wants) places_[size_ + static_cast<unsigned>(__popc(wanting & ((1u << lane_) - 1)))] = element;
        size_ += static_cast<unsigned>(__popc(wanting));
        __syncwarp();
        if (size_ >= at_once) move();
    }
    /// Appends all waiting elements to the list.
    __device__ void move() {
        unsigned long long place = 0;
        if (lane_ == 0 && size_) place = atomicAdd(list_.count, static_cast<unsigned long long>(size_));
        write(__shfl_sync(whole_warp, place, 0));
    }
    /// Writes all waiting elements to the list from `place` on. The list's count must include them already.
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
