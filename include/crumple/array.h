#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include "crumple/export.h"

namespace crumple {

namespace detail {
/// Allocates storage of an Array, aligned to 64 bytes. On Linux, blocks of 32 MiB or more are mapped pages, which grow
/// without a copy.
CRUMPLE_API void* allocate_storage(std::size_t bytes);
/// Frees a block; `bytes`: its current size.
CRUMPLE_API void free_storage(void* storage, std::size_t bytes) noexcept;
/// True if grow_storage() can grow a block of `bytes` bytes.
CRUMPLE_API bool can_grow_storage(std::size_t bytes) noexcept;
/// Grows a block from `bytes` to `new_bytes` and returns its new address. Requires can_grow_storage(bytes). If it
/// throws std::bad_alloc, the block is unchanged.
CRUMPLE_API void* grow_storage(void* storage, std::size_t bytes, std::size_t new_bytes);
}  // namespace detail

/// Counts the bytes that a detector's arrays own, and enforces a limit.
struct MemoryMeter {
    /// Thrown by a growing Array. The detector then works in smaller chunks, or reports an Error.
    struct Exceeded {
        std::int64_t bytes = 0;  ///< total bytes that would have been owned: above the limit
    };

    std::int64_t limit = 0;                      ///< bytes; 0: no limit
    std::atomic<std::int64_t> used{0}, peak{0};  ///< bytes owned now, and the most so far

    /// Adds `bytes`, which may be negative, to `used`. Throws Exceeded, without a change, if that exceeds the limit.
    /// Thread-safe.
    // Never counts refused bytes, not even temporarily: another thread could record them as the peak.
    void add(std::int64_t bytes) {
        std::int64_t before = used.load(std::memory_order_relaxed), now = 0;
        do {
            now = before + bytes;
            if (limit > 0 && bytes > 0 && now > limit) throw Exceeded{now};
        } while (!used.compare_exchange_weak(before, now, std::memory_order_relaxed));
        std::int64_t seen = peak.load(std::memory_order_relaxed);
        while (now > seen && !peak.compare_exchange_weak(seen, now, std::memory_order_relaxed)) {
        }
    }
};

/// Owning, contiguous array of plain values on a 64-byte boundary. Growth does not initialise elements, clear() keeps
/// the capacity, copies are deep. A meter, if there is one, counts every byte; arrays made by copying have none.
/// Functions that grow an array throw MemoryMeter::Exceeded above the limit of its meter, and std::bad_alloc.
template <class T>
class Array {
    static_assert(std::is_trivially_copyable_v<T>);

   public:
    /// Makes an empty array without a meter.
    Array() = default;
    /// Makes an empty array. `meter` counts its storage, and must outlive it.
    explicit Array(MemoryMeter* meter) : meter_(meter) {}
    /// Copies the elements, but not the meter: the copy has none.
    Array(const Array& other) { assign(other); }
    /// Takes over the storage and the meter of `other`, which is then empty and has none.
    Array(Array&& other) noexcept { swap(other); }
    /// Copies the elements. This array keeps its own meter.
    Array& operator=(const Array& other) {
        if (this != &other) assign(other);
        return *this;
    }
    /// Swaps elements, storage and meters with `other`.
    Array& operator=(Array&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Array() { release(); }

    /// Returns a pointer to the first element, on a 64-byte boundary; null if there is no storage.
    /// @{
    T* data() { return data_; }
    const T* data() const { return data_; }
    /// @}
    /// Returns the number of elements.
    std::size_t size() const { return size_; }
    /// Returns the number of elements that fit without allocation.
    std::size_t capacity() const { return capacity_; }
    /// True if there are no elements.
    bool empty() const { return size_ == 0; }
    /// Returns element i, unchecked.
    /// @{
    T& operator[](std::integral auto i) { return data_[i]; }
    const T& operator[](std::integral auto i) const { return data_[i]; }
    /// @}
    /// Returns a pointer to the first element, or past the last one; valid, like views, until the array grows or is
    /// released.
    /// @{
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }
    /// @}
    /// Returns the first or the last element; the array must not be empty.
    /// @{
    const T& front() const { return data_[0]; }
    const T& back() const { return data_[size_ - 1]; }
    /// @}
    /// Returns a view of the elements.
    /// @{
    std::span<T> span() { return {data_, size_}; }
    std::span<const T> span() const { return {data_, size_}; }
    /// @}

    /// Removes all elements and keeps the capacity.
    void clear() { size_ = 0; }

    /// Changes the number of elements. Keeps existing elements; new elements are not initialised.
    void resize(std::size_t size) {
        if (size > capacity_) grow(size);
        size_ = size;
    }
    /// Changes the number of elements and returns a pointer to the first. No element keeps its value: cheaper than
    /// resize() if all are overwritten.
    T* resize_discard(std::size_t size) {
        if (size > capacity_) {
            size_ = 0;
            grow(size);
        }
        size_ = size;
        return data_;
    }
    /// Allocates storage for at least `capacity` elements in total, and keeps existing elements.
    void reserve(std::size_t capacity) {
        if (capacity > capacity_) grow(capacity);
    }
    /// Reserves capacity for `more` further elements. Repeated calls cost amortised O(1) per element, also under a
    /// limit.
    void grow_by(std::size_t more) {
        if (size_ + more > capacity_) grow(std::max(size_ + more, capacity_ + capacity_ / 8));
    }
    /// Appends a copy of `value`, which may be an element of this array. Amortised O(1).
    void push_back(const T& value) {
        const T copy = value;
        grow_by(1);
        data_[size_++] = copy;
    }
    /// Sets all elements to `value`.
    void fill(const T& value) { std::fill(begin(), end(), value); }
    /// Replaces all elements by `size` copies of `value`, which must not be an element of this array.
    void assign(std::size_t size, const T& value) {
        resize_discard(size);
        fill(value);
    }

    /// Removes all elements and frees the storage. The meter stays.
    void release() {
        if (!data_) return;
        detail::free_storage(data_, capacity_ * sizeof(T));
        if (meter_) meter_->add(-static_cast<std::int64_t>(capacity_ * sizeof(T)));
        data_ = nullptr;
        size_ = capacity_ = 0;
    }

    /// Swaps elements and storage with `other`. Each array keeps its meter, which then counts the new storage. Throws
    /// MemoryMeter::Exceeded, without any change, if that exceeds a limit.
    void swap_elements(Array& other) {
        const auto bytes = [](const Array& array) { return static_cast<std::int64_t>(array.capacity_ * sizeof(T)); };
        const std::int64_t growth = bytes(other) - bytes(*this);
        if (meter_ && growth > 0) meter_->add(growth);
        if (other.meter_) other.meter_->add(-growth);
        if (meter_ && growth < 0) meter_->add(growth);
        swap(other);
        std::swap(meter_, other.meter_);
    }

   private:
    void assign(const Array& other) {
        resize_discard(other.size_);
        if (size_) std::memcpy(static_cast<void*>(data_), other.data_, size_ * sizeof(T));
    }
    void swap(Array& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
        std::swap(meter_, other.meter_);
    }
    void grow(std::size_t wanted) {
        // Grows by at least half, so that frames of slowly increasing size do not allocate each time; under a memory
        // limit, only to the requested capacity.
        const bool tight = meter_ && meter_->limit > 0;
        const std::size_t capacity = tight ? wanted : std::max(wanted + wanted / 8, capacity_ + capacity_ / 2);
        if (capacity > static_cast<std::size_t>(PTRDIFF_MAX) / sizeof(T)) throw std::bad_alloc();
        if (size_ == 0) release();
        const std::size_t bytes = capacity * sizeof(T), before = capacity_ * sizeof(T);
        const bool copies = !detail::can_grow_storage(before);
        const auto added = static_cast<std::int64_t>(copies ? bytes : bytes - before);
        if (meter_) meter_->add(added);
        T* fresh;
        try {
            fresh =
                static_cast<T*>(copies ? detail::allocate_storage(bytes) : detail::grow_storage(data_, before, bytes));
        } catch (...) {
            if (meter_) meter_->add(-added);
            throw;
        }
        const std::size_t size = size_;
        if (copies) {
            if (size) std::memcpy(static_cast<void*>(fresh), data_, size * sizeof(T));
            release();
        }
        data_ = fresh;
        size_ = size;
        capacity_ = capacity;
    }

    T* data_ = nullptr;
    std::size_t size_ = 0, capacity_ = 0;
    MemoryMeter* meter_ = nullptr;
};

}  // namespace crumple
