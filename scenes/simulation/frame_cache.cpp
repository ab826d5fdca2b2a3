#include "scenes/simulation/frame_cache.h"

#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "crumple/error.h"
#include "io/bytes/atomic_file.h"

namespace crumple::scenes {
namespace {

namespace fs = std::filesystem;

/// Version of the simulations. Raise it with every change that alters a simulation with the same parameters.
constexpr int version = 1;

struct Header {
    std::uint64_t magic;
    std::int64_t frame, bytes;
    std::uint64_t checksum;
};
constexpr std::uint64_t magic = 0x6372756d706c6500u + version;

fs::path cache_folder() {
    const char* const cache = std::getenv("XDG_CACHE_HOME");
    if (cache && fs::path(cache).is_absolute()) return fs::path(cache) / "crumple";
    const char* const home = std::getenv("HOME");
    if (home && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "crumple";
    return {};
}

fs::path frame_file(const fs::path& folder, int frame) { return folder / ("frame" + std::to_string(frame)); }
fs::path state_file(const fs::path& folder) { return folder / "state"; }

std::uint64_t checksum(const std::vector<char>& bytes) {
    std::uint64_t sum = bytes.size(), word = 0;
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(word)) {
        word = 0;
        std::memcpy(&word, &bytes[i], std::min(sizeof(word), bytes.size() - i));
        sum = mix(sum ^ word);
    }
    return sum;
}

void write(const fs::path& path, std::int64_t frame, const std::vector<char>& bytes) {
    const Header header{magic, frame, static_cast<std::int64_t>(bytes.size()), checksum(bytes)};
    io::AtomicFile file(path);
    file.stream().write(reinterpret_cast<const char*>(&header), sizeof(header));
    file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.commit();
}

struct Content {
    int frame;
    std::vector<char> bytes;
};

std::optional<Content> read(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    Header header{};
    if (!in.read(reinterpret_cast<char*>(&header), sizeof(header)) || header.magic != magic) return {};
    std::error_code error;
    const auto size = static_cast<std::int64_t>(fs::file_size(path, error)) - static_cast<std::int64_t>(sizeof(header));
    if (error || header.bytes != size) return {};
    Content content{static_cast<int>(header.frame), std::vector<char>(static_cast<std::size_t>(size))};
    if (!in.read(content.bytes.data(), size) || checksum(content.bytes) != header.checksum) return {};
    return content;
}

template <class T>
std::vector<T> items(const char* bytes, std::size_t count) {
    std::vector<T> result(count);
    if (count) std::memcpy(static_cast<void*>(result.data()), bytes, count * sizeof(T));
    return result;
}

}  // namespace

FrameCache::FrameCache(const std::string& key) {
    folder_ = cache_folder();
    if (!folder_.empty()) folder_ /= key;
}

std::optional<std::vector<float>> FrameCache::points(int frame) const {
    if (folder_.empty()) return {};
    const auto content = read(frame_file(folder_, frame));
    if (!content || content->frame != frame || content->bytes.size() % (3 * sizeof(float)) != 0) return {};
    return items<float>(content->bytes.data(), content->bytes.size() / sizeof(float));
}

std::optional<FrameCache::State> FrameCache::last_state() const {
    if (folder_.empty()) return {};
    const auto content = read(state_file(folder_));
    if (!content || content->bytes.size() % (2 * sizeof(Vec3d)) != 0) return {};
    const std::size_t half = content->bytes.size() / 2, count = half / sizeof(Vec3d);
    return State{content->frame, items<Vec3d>(content->bytes.data(), count),
                 items<Vec3d>(content->bytes.data() + half, count)};
}

void FrameCache::store(int frame, std::span<const float> points, const ClothSolver& solver) const {
    if (folder_.empty()) return;
    const auto bytes_of = [](auto data, std::size_t count) {
        const auto* const bytes = reinterpret_cast<const char*>(data);
        return std::vector<char>(bytes, bytes + count * sizeof(*data));
    };
    std::vector<char> state = bytes_of(solver.points.data(), solver.points.size());
    const std::vector<char> velocities = bytes_of(solver.velocities.data(), solver.velocities.size());
    state.insert(state.end(), velocities.begin(), velocities.end());
    std::error_code error;
    fs::create_directories(folder_, error);
    try {
        write(frame_file(folder_, frame), frame, bytes_of(points.data(), points.size()));
        write(state_file(folder_), frame, state);
    } catch (const Error&) {
        // No space or no permission: the frame is simulated again when it is requested again.
    }
}

}  // namespace crumple::scenes
