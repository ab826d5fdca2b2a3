#include "cuda_on_cpu/machine/settings.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/sanitizers.h"

namespace cuda_on_cpu {
namespace {

template <class Enum>
struct Name {
    std::string_view name;
    Enum value;
};

template <class Enum, std::size_t N>
void read(const char* variable, const Name<Enum> (&names)[N], Enum& value) {
    const char* text = std::getenv(variable);
    if (!text) return;
    const auto* found = std::find_if(names, names + N, [&](const Name<Enum>& n) { return n.name == text; });
    if (found == names + N) fail("%s=%s is not supported", variable, text);
    value = found->value;
}

template <class Integer>
void read(const char* variable, Integer& value) {
    const char* text = std::getenv(variable);
    if (!text) return;
    const std::string_view view = text;
    const auto [end, error] = std::from_chars(view.data(), view.data() + view.size(), value);
    if (error != std::errc() || end != view.data() + view.size()) fail("%s=%s is not a valid number", variable, text);
}

Settings from_environment() {
    constexpr Name<Order> orders[] = {
        {"forward", Order::forward}, {"reverse", Order::reverse}, {"random", Order::random}};
    constexpr Name<Progress> ways[] = {
        {"lazy", Progress::lazy}, {"eager", Progress::eager}, {"random", Progress::random}};
    constexpr Name<bool> switches[] = {{"0", false}, {"1", true}};
    Settings result;
    read("CUDA_ON_CPU_ORDER", orders, result.order);
    read("CUDA_ON_CPU_PROGRESS", ways, result.progress);
    read("CUDA_ON_CPU_SEED", result.seed);
    read("CUDA_ON_CPU_WORKERS", result.workers);
    read("CUDA_ON_CPU_DEVICES", result.devices);
    read("CUDA_ON_CPU_MULTIPROCESSORS", result.multiprocessors);
    if (result.multiprocessors < 1) fail("CUDA_ON_CPU_MULTIPROCESSORS must be at least 1");
    read("CUDA_ON_CPU_REGISTERS", result.registers);
    if (result.registers < 1 || result.registers > 255) fail("CUDA_ON_CPU_REGISTERS must be from 1 to 255");
    read("CUDA_ON_CPU_COUNTS", switches, result.counts);
    return result;
}

}  // namespace

Settings& settings() {
    static Settings instance = from_environment();
    return instance;
}

unsigned worker_count() {
    const unsigned chosen = settings().workers;
    if (chosen) return chosen;
    return thread_sanitizer ? 2 : std::clamp(std::thread::hardware_concurrency(), 2u, 16u);
}

Random& host_random() {
    static std::uint32_t seed = settings().seed;
    static Random random(seed);
    if (seed != settings().seed) random = Random(seed = settings().seed);
    return random;
}

}  // namespace cuda_on_cpu
