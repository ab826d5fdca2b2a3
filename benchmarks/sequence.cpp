#include "sequence.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "crumple/error.h"
#include "scenes/scenes.h"
#include "workload.h"

namespace crumple::benchmark {
namespace {

namespace fs = std::filesystem;

struct Files {
    const char* name;
    std::vector<int> numbers;
    std::string (*path)(int number);
};

/// Sequences with one file per frame. They are animations of UNC, of which two frames each are available.
const std::vector<Files> files{
    {"unc_cloth_ball",
     {92, 93},
     [](int i) { return "scalable-ccd/cloth-ball/frames/cloth_ball" + std::to_string(i) + ".ply"; }},
    {"unc_funnel", {227, 228}, [](int i) { return "scalable-ccd/cloth-funnel/frames/" + std::to_string(i) + ".ply"; }},
    {"unc_n_body",
     {18, 19},
     [](int i) { return "scalable-ccd/n-body-simulation/frames/balls16_" + std::to_string(i) + ".ply"; }},
};

template <class T>
std::vector<T> read_array(const fs::path& path, std::size_t count) {
    std::vector<T> values(count);
    std::ifstream file(path, std::ios::binary);
    const auto bytes = static_cast<std::streamsize>(count * sizeof(T));
    if (!file.read(reinterpret_cast<char*>(values.data()), bytes))
        throw Error(ErrorCode::file, "cannot read " + path.string());
    return values;
}

/// Reads the sequence `kick`, whose frames are one array, described by a meta.json.
Sequence read_kick(int step) {
    const fs::path folder = data_folder() / "codim-ipc" / "Kick";
    std::ifstream description(folder / "meta.json");
    if (!description) throw Error(ErrorCode::file, "cannot read " + (folder / "meta.json").string());
    const auto meta = nlohmann::json::parse(description);
    const std::size_t frames = meta.at("frames"), values = 3 * meta.at("verts").get<std::size_t>();
    const auto xyz = read_array<float>(folder / "verts.f32", frames * values);
    const auto triangles = read_array<std::int32_t>(folder / "faces.i32", 3 * meta.at("tris").get<std::size_t>());
    Sequence sequence{"kick", {}, {}};
    for (std::size_t f = 0; f < frames; f += static_cast<std::size_t>(step)) {
        const auto first = xyz.begin() + static_cast<std::ptrdiff_t>(f * values);
        sequence.numbers.push_back(static_cast<int>(f));
        sequence.frames.push_back(
            {std::vector<float>(first, first + static_cast<std::ptrdiff_t>(values)), triangles, {}});
    }
    return sequence;
}

}  // namespace

Sequence load_sequence(const std::string& name, int step) {
    if (name == "kick") return read_kick(step);
    Sequence sequence{name, {}, {}};
    for (const Files& entry : files) {
        if (name != entry.name) continue;
        for (const int number : entry.numbers) {
            sequence.numbers.push_back(number);
            sequence.frames.push_back(io::read_mesh(data_folder() / entry.path(number)));
        }
        return sequence;
    }
    const auto [scene, parameters] = parse(name);
    for (const auto& description : scenes::descriptions()) {
        if (description.name != scene) continue;
        if (description.simulated) fmt::print("{}: simulating, which takes minutes unless it is cached\n", name);
        scenes::Animation animation(scene, parameters);
        for (int frame = 0; frame < description.frames; frame += step) {
            sequence.numbers.push_back(frame);
            sequence.frames.push_back(animation.frame(frame));
            sequence.frames.back().groups.clear();
        }
    }
    if (sequence.frames.empty()) throw Error(ErrorCode::invalid_argument, "there is no sequence " + name);
    return sequence;
}

std::vector<std::string> sequences() {
    std::vector<std::string> names;
    for (const Files& entry : files)
        if (fs::exists(data_folder() / entry.path(entry.numbers.front()))) names.emplace_back(entry.name);
    if (fs::exists(data_folder() / "codim-ipc" / "Kick" / "meta.json")) names.emplace_back("kick");
    for (const auto& description : scenes::descriptions())
        if (description.frames > 1 && description.name != "ground") names.emplace_back(description.name);
    return names;
}

}  // namespace crumple::benchmark
