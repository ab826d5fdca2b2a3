#pragma once

#include <cuda_runtime.h>

#include "cuda_on_cpu/shim/cuda_on_cpu/cub_storage.h"

namespace cub {

template <class T, int Lanes = 32>
class WarpScan {
    using Mine = cuda_on_cpu::Scan<T>;
    using Plus = cuda_on_cpu::Plus;

   public:
    using TempStorage = cuda_on_cpu::CubStorage<Lanes, Lanes * sizeof(T) + 16>;

    explicit WarpScan(TempStorage& storage, const char* file = __builtin_FILE(), int line = __builtin_LINE())
        : storage_(storage), site_{"WarpScan", file, line} {}

    void ExclusiveSum(T in, T& out) { ExclusiveScan(in, out, T{}, Plus()); }
    void ExclusiveSum(T in, T& out, T& aggregate) { ExclusiveScan(in, out, T{}, Plus(), aggregate); }
    void InclusiveSum(T in, T& out) { InclusiveScan(in, out, Plus()); }
    void InclusiveSum(T in, T& out, T& aggregate) { InclusiveScan(in, out, Plus(), aggregate); }

    template <class Operation>
    void ExclusiveScan(T in, T& out, T initial, Operation operation) {
        T aggregate;
        ExclusiveScan(in, out, initial, operation, aggregate);
    }
    template <class Operation>
    void ExclusiveScan(T in, T& out, T initial, Operation operation, T& aggregate) {
        aggregate =
            scan(in, out, [&](Mine* const* all) { cuda_on_cpu::exclusive_scan(all, Lanes, &initial, operation); });
    }
    template <class Operation>
    void InclusiveScan(T in, T& out, Operation operation) {
        T aggregate;
        InclusiveScan(in, out, operation, aggregate);
    }
    template <class Operation>
    void InclusiveScan(T in, T& out, Operation operation, T& aggregate) {
        aggregate = scan(in, out, [&](Mine* const* all) { cuda_on_cpu::inclusive_scan(all, Lanes, operation); });
    }
    /// Returns the value of lane `source` to all lanes.
    T Broadcast(T in, unsigned source) {
        cuda_on_cpu::warp_primitive<Lanes>(site_, storage_, in, [&](T* const* all) {
            const T value = *all[source];
            for (int i = 0; i < Lanes; ++i) *all[i] = value;
        });
        return in;
    }

   private:
    template <class F>
    T scan(const T& in, T& out, F combine) {
        Mine mine{&in, &out, 1, T{}};
        cuda_on_cpu::warp_primitive<Lanes>(site_, storage_, mine, combine);
        return mine.aggregate;
    }

    TempStorage& storage_;
    cuda_on_cpu::Site site_;
};

}  // namespace cub
