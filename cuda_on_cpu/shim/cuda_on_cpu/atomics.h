#pragma once

// Atomic functions on shared and global memory: relaxed, as on the device. They order nothing but themselves. The
// machine counts them by call site (machine/counts.h).

#include <bit>
#include <concepts>
#include <type_traits>

namespace cuda_on_cpu {

template <class T, class... Allowed>
concept AnyOf = (std::same_as<T, Allowed> || ...);
template <class T>
concept AtomicInteger = AnyOf<T, int, unsigned, unsigned long long>;
template <class T>
concept AtomicFloat = AnyOf<T, float, double>;

template <class T>
using BitsOf = std::conditional_t<sizeof(T) == 4, unsigned, unsigned long long>;

/// Counts an atomic of the running thread. Does nothing on the host.
void note_atomic(const void* address, const char* file, int line);

/// Replaces *address by f(*address) and returns what was there.
template <class T, class F>
T update(T* address, F f) {
    auto* const bits = reinterpret_cast<BitsOf<T>*>(address);
    BitsOf<T> old = __atomic_load_n(bits, __ATOMIC_RELAXED);
    while (!__atomic_compare_exchange_n(bits, &old, std::bit_cast<BitsOf<T>>(f(std::bit_cast<T>(old))), true,
                                        __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
    return std::bit_cast<T>(old);
}

}  // namespace cuda_on_cpu

// The value is converted to the type of the memory, as an overload would.
template <cuda_on_cpu::AtomicInteger T>
T atomicAdd(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
            int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return __atomic_fetch_add(address, value, __ATOMIC_RELAXED);
}
template <cuda_on_cpu::AtomicFloat T>
T atomicAdd(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
            int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return cuda_on_cpu::update(address, [=](T old) { return old + value; });
}
template <cuda_on_cpu::AnyOf<int, unsigned> T>
T atomicSub(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
            int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return __atomic_fetch_sub(address, value, __ATOMIC_RELAXED);
}
template <cuda_on_cpu::AnyOf<int, unsigned, unsigned long long, float> T>
T atomicExch(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
             int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return cuda_on_cpu::update(address, [=](T) { return value; });
}
template <cuda_on_cpu::AnyOf<int, unsigned, long long, unsigned long long> T>
T atomicMin(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
            int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return cuda_on_cpu::update(address, [=](T old) { return value < old ? value : old; });
}
template <cuda_on_cpu::AnyOf<int, unsigned, long long, unsigned long long> T>
T atomicMax(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
            int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return cuda_on_cpu::update(address, [=](T old) { return old < value ? value : old; });
}
template <cuda_on_cpu::AtomicInteger T>
T atomicAnd(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
            int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return __atomic_fetch_and(address, value, __ATOMIC_RELAXED);
}
template <cuda_on_cpu::AtomicInteger T>
T atomicOr(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
           int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return __atomic_fetch_or(address, value, __ATOMIC_RELAXED);
}
template <cuda_on_cpu::AtomicInteger T>
T atomicXor(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
            int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return __atomic_fetch_xor(address, value, __ATOMIC_RELAXED);
}
template <cuda_on_cpu::AtomicInteger T>
T atomicCAS(T* address, std::type_identity_t<T> expected, std::type_identity_t<T> value,
            const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    __atomic_compare_exchange_n(address, &expected, value, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
    return expected;
}
/// Counts up to `limit`, then from 0 again. Returns the old value.
inline unsigned atomicInc(unsigned* address, unsigned limit, const char* file = __builtin_FILE(),
                          int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return cuda_on_cpu::update(address, [=](unsigned old) { return old >= limit ? 0 : old + 1; });
}
/// Counts down to 0, then from `limit` again. Returns the old value.
inline unsigned atomicDec(unsigned* address, unsigned limit, const char* file = __builtin_FILE(),
                          int line = __builtin_LINE()) {
    cuda_on_cpu::note_atomic(address, file, line);
    return cuda_on_cpu::update(address, [=](unsigned old) { return old == 0 || old > limit ? limit : old - 1; });
}
// Atomics of block scope have device scope here.
template <class T>
T atomicAdd_block(T* address, std::type_identity_t<T> value, const char* file = __builtin_FILE(),
                  int line = __builtin_LINE()) {
    return atomicAdd(address, value, file, line);
}
