#include "cuda_on_cpu/machine/memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <iterator>
#include <map>

#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/sanitizers.h"
#include "cuda_on_cpu/machine/settings.h"

namespace cuda_on_cpu::memory {
namespace {

constexpr std::size_t page = 4096;
constexpr unsigned char canary = 0xC5;
// Number of freed allocations whose pages stay inaccessible. A process may have some 65,000 mappings.
constexpr std::size_t quarantine_length = 4096;

std::size_t round_up(std::size_t n, std::size_t to) { return (n + to - 1) / to * to; }

struct Mapping {
    std::byte* begin;
    std::size_t bytes;
};

/// Returns the pages of an allocation, whose end is rounded up to `alignment`, and its guard page.
Mapping mapping_of(const Allocation& a) {
    const std::size_t body = round_up(a.bytes, page);
    return {a.begin + round_up(a.bytes, alignment) - body, body + page};
}

struct State {
    std::map<std::uintptr_t, Allocation> live;
    std::deque<Allocation> quarantine;
    std::size_t used = 0;
};

State& state() {
    static State instance;
    return instance;
}

bool counts(Kind kind) { return kind == Kind::device || kind == Kind::managed; }
std::uintptr_t key(const void* p) { return reinterpret_cast<std::uintptr_t>(p); }

std::byte* map(std::size_t bytes) {
    if (address_sanitizer) {
        void* result = nullptr;
        return posix_memalign(&result, alignment, bytes) == 0 ? static_cast<std::byte*>(result) : nullptr;
    }
    const std::size_t body = round_up(bytes, page);
    void* pages = mmap(nullptr, body + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) return nullptr;
    auto* const first = static_cast<std::byte*>(pages);
    mprotect(first + body, page, PROT_NONE);
    return first + body - round_up(bytes, alignment);
}

void unmap(const Allocation& a) {
    if (address_sanitizer) {
        allow(a.begin, a.bytes);
        std::free(a.begin);
        return;
    }
    // A fresh inaccessible mapping in its place frees the pages and keeps the addresses reserved.
    const Mapping m = mapping_of(a);
    mmap(m.begin, m.bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
    auto& quarantine = state().quarantine;
    quarantine.push_back(a);
    if (quarantine.size() <= quarantine_length) return;
    const Mapping oldest = mapping_of(quarantine.front());
    munmap(oldest.begin, oldest.bytes);
    quarantine.pop_front();
}

void set_access(const Allocation& a, bool on) {
    if (address_sanitizer) return on ? allow(a.begin, a.bytes) : forbid(a.begin, a.bytes);
    const Mapping m = mapping_of(a);
    mprotect(m.begin, m.bytes - page, on ? PROT_READ | PROT_WRITE : PROT_NONE);
}

void fill(const Allocation& a) {
    host_random().fill(a.begin, a.bytes);
    if (address_sanitizer) return;
    const Mapping m = mapping_of(a);
    auto* const begin = reinterpret_cast<unsigned char*>(a.begin);
    for (unsigned char* p = reinterpret_cast<unsigned char*>(m.begin); p < begin; ++p) *p = canary;
    for (unsigned char* p = begin + a.bytes; p < begin + round_up(a.bytes, alignment); ++p) *p = canary;
}

void check(const Allocation& a) {
    if (address_sanitizer || a.kind == Kind::registered || !a.open) return;
    const Mapping m = mapping_of(a);
    const auto* const begin = reinterpret_cast<const unsigned char*>(a.begin);
    for (const auto* p = reinterpret_cast<const unsigned char*>(m.begin); p < begin; ++p)
        if (*p != canary) fail("memory %zd bytes before an allocation of %zu bytes was written", begin - p, a.bytes);
    for (std::size_t i = a.bytes; i < round_up(a.bytes, alignment); ++i)
        if (begin[i] != canary)
            fail("memory %zu bytes past the end of an allocation of %zu bytes was written", i - a.bytes, a.bytes);
}

}  // namespace

void* allocate(std::size_t bytes, Kind kind, int device, bool open) {
    State& s = state();
    int& countdown = settings().allocations_before_failure;
    if (countdown >= 0 && countdown-- == 0) return nullptr;
    if (counts(kind) && bytes > settings().device_bytes - std::min(s.used, settings().device_bytes)) return nullptr;
    Allocation a{map(bytes), bytes, kind, device, open};
    if (!a.begin) return nullptr;
    if (open)
        fill(a);
    else
        set_access(a, false);
    if (counts(kind)) s.used += bytes;
    s.live.emplace(key(a.begin), a);
    return a.begin;
}

void open(void* memory) {
    Allocation& a = state().live.at(key(memory));
    set_access(a, true);
    a.open = true;
    fill(a);
}

bool release(void* memory, Kind kind) {
    State& s = state();
    const auto found = s.live.find(key(memory));
    if (found == s.live.end()) return false;
    const Allocation a = found->second;
    if (a.kind != kind && !(counts(a.kind) && counts(kind))) return false;
    check(a);
    s.live.erase(found);
    if (counts(a.kind)) s.used -= a.bytes;
    unmap(a);
    return true;
}

bool register_host(void* memory, std::size_t bytes) {
    if (find(memory)) return false;
    state().live.emplace(key(memory), Allocation{static_cast<std::byte*>(memory), bytes, Kind::registered, 0, true});
    return true;
}

bool unregister_host(void* memory) {
    const auto found = state().live.find(key(memory));
    if (found == state().live.end() || found->second.kind != Kind::registered) return false;
    state().live.erase(found);
    return true;
}

const Allocation* find(const void* address) {
    const auto& live = state().live;
    auto after = live.upper_bound(key(address));
    if (after == live.begin()) return nullptr;
    const Allocation& a = std::prev(after)->second;
    return key(address) < key(a.begin) + a.bytes ? &a : nullptr;
}

bool covers(const void* address, std::size_t bytes) {
    const Allocation* a = find(address);
    return a && key(address) + bytes <= key(a->begin) + a->bytes;
}

std::size_t used() { return state().used; }
std::size_t live() { return state().live.size(); }

void describe(const void* address, char* text, std::size_t size) {
    const State& s = state();
    const auto near = [&](const Allocation& a, const char* state_of) {
        const Mapping m = mapping_of(a);
        if (address < m.begin || address >= m.begin + m.bytes) return false;
        const auto offset = static_cast<const std::byte*>(address) - a.begin;
        const auto bytes = static_cast<std::ptrdiff_t>(a.bytes);
        if (offset >= bytes)
            std::snprintf(text, size, "memory %td bytes past the end of %s of %zu bytes", offset - bytes, state_of,
                          a.bytes);
        else
            std::snprintf(text, size, "byte %td of %s of %zu bytes", offset, state_of, a.bytes);
        return true;
    };
    auto after = s.live.upper_bound(key(address));
    if (after != s.live.begin()) {
        const Allocation& a = std::prev(after)->second;
        if (near(a, a.open ? "an allocation" : "a pending stream-ordered allocation")) return;
    }
    for (const Allocation& a : s.quarantine)
        if (near(a, "a freed allocation")) return;
    std::snprintf(text, size, "memory outside of all allocations");
}

}  // namespace cuda_on_cpu::memory
