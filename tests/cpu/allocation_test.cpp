// Warm calls on scenes of the same size allocate nothing of ours. Every operator new of the process is counted; oneTBB
// takes its tasks from an allocator of its own.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "soups.h"

namespace {

std::atomic<std::int64_t> allocations{0};

void* allocate(std::size_t size, std::size_t alignment) {
    ++allocations;
    void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size, 16); }
void* operator new[](std::size_t size) { return allocate(size, 16); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace crumple {
namespace {

TEST(Allocation, warm_calls_allocate_nothing) {
    const auto sheet = test::wavy_sheet(100);
    for (const bool contacts : {false, true}) {
        Query query;
        query.contacts = contacts;
        Detector detector({.threads = 1});
        for (int frame = 0; frame < 20; ++frame) detector.find_self(sheet.view(), query);
        const std::int64_t before = allocations;
        for (int frame = 0; frame < 5; ++frame) detector.find_self(sheet.view(), query);
        EXPECT_EQ(allocations - before, 0) << (contacts ? "with contacts" : "without contacts");
    }
}

TEST(Allocation, cold_calls_do_allocate) {
    const auto sheet = test::wavy_sheet(30);
    const std::int64_t before = allocations;
    Detector detector({.threads = 1});
    detector.find_self(sheet.view());
    EXPECT_GT(allocations - before, 10) << "or the counter counts nothing";
}

}  // namespace
}  // namespace crumple
