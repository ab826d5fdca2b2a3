// Tests that warm calls, those of a detector that has searched scenes of the same size before, allocate nothing. Every
// operator new of the process is counted, except for oneTBB's tasks, which have an allocator of their own.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <new>
#include <string_view>
#include <vector>

#include "halves.h"
#include "rounds.h"
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

struct Call {
    const char* name;
    std::function<void(Detector&)> find;
};

std::vector<Call> calls() {
    static const test::Soup<float> sheet = [] {
        test::Soup<float> soup = test::wavy_sheet(100);
        for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(static_cast<std::int32_t>(t % 5));
        return soup;
    }();
    static const MeshView mesh = sheet.view();
    static const std::vector<GroupPair> excluded{{0, 1}, {2, 2}};
    static const IntersectionQuery without{.filter = {.excluded_groups = excluded}};
    static const IntersectionQuery within{.filter = {.groups = PairScope::within, .excluded_groups = excluded}};
    static const test::Halves half(mesh);
    // Two segments through the sheet, a thousand copies of each.
    static const test::Soup<float> padded = [] {
        test::Soup<float> soup = test::wavy_sheet(60);
        for (int i = 0; i < 1000; ++i) {
            soup.triangles.push_back({5, 5, 1700});
            soup.triangles.push_back({2, 3000, 3000});
        }
        return soup;
    }();
    static const std::vector<Part> parts = Detector().partition({half.a, half.b}, {}, 70);
    return {{"self", [](Detector& d) { d.find(mesh); }},
            {"contacts", [](Detector& d) { d.find(mesh, {.output = Output::contacts}); }},
            {"welded", [](Detector& d) { d.find(mesh, {.weld = true}); }},
            {"groups", [](Detector& d) { d.find(mesh, without); }},
            {"copies", [](Detector& d) { d.find(padded.view()); }},
            {"between",
             [](Detector& d) {
                 d.find({half.a, half.b});
             }},
            {"part", [](Detector& d) { d.find(parts[35]); }},
            {"any", [](Detector& d) { d.any(mesh, within); }}};
}

TEST(Allocation, warm_find_of_intersections_allocates_nothing) {
    if (sanitized) GTEST_SKIP() << "it counts, and other tests make the same calls";
    for (const int threads : {1, 2}) {
        for (const auto& [name, find] : calls()) {
            // With several threads, the lists that are filled before the first pair ends the call differ from call to
            // call.
            if (threads > 1 && std::string_view(name) == "any") continue;
            Detector detector({.threads = threads});
            for (int frame = 0; frame < 20; ++frame) find(detector);
            const std::int64_t before = allocations;
            for (int frame = 0; frame < 5; ++frame) find(detector);
            EXPECT_EQ(allocations - before, 0) << name << ", " << threads << " threads";
        }
    }
}

TEST(Allocation, counter_counts_allocations_of_cold_calls) {
    const auto sheet = test::wavy_sheet(30);
    const std::int64_t before = allocations;
    Detector detector({.threads = 1});
    detector.find(sheet.view());
    EXPECT_GT(allocations - before, 10) << "or the counter counts nothing";
}

}  // namespace
}  // namespace crumple
