#include "scenes/scenes.h"

#include <array>
#include <string>
#include <utility>

#include "crumple/error.h"
#include "scenes/cloth.h"
#include "scenes/list.h"
#include "scenes/simulation/simulated_frames.h"

namespace crumple::scenes {
namespace {

struct Entry {
    Description description;
    io::TriangleMesh (*make)(const Parameters&);                           // null for simulated scenes
    std::unique_ptr<Simulation> (*simulate)(const Parameters&) = nullptr;  // null for all others
};

constexpr std::array entries{
    Entry{{"cloth", "sheet that sinks over a ball and crumples through itself", 92'230, cloth_frames}, make_cloth},
    Entry{{"ground", "the cloth on a ground of two huge triangles", 92'230, cloth_frames}, make_ground},
    Entry{{"soup", "random triangles of equal size", 100'000, 1}, make_soup},
    Entry{{"needles", "random needles, a hundred times as long as wide", 100'000, 1}, make_needles},
    Entry{{"five_decades", "random triangles whose sizes spread over five decades", 100'000, 1}, make_five_decades},
    Entry{{"bodies", "tumbling balls, boxes and rings that pass through each other", 100'000, 60}, make_bodies},
    Entry{
        {"knots", "tumbling bodies that pass through each other; the knots also pass through themselves", 146'400, 60},
        make_knots},
    Entry{{"model", "one large closed body, wrinkled, that passes through itself", 200'000, 1}, make_model},
    Entry{{"shells", "concentric spheres without any collision", 100'000, 1}, make_shells},
    Entry{{"fans", "crossing coins, each two fans of needles around one vertex", 12'000, 1}, make_fans},
    Entry{{"lattice", "exactly touching, coplanar, duplicated, folded, degenerate triangles; float64", 20'000, 1},
          make_lattice},
    Entry{{"cloth_on_ball", "cloth that falls on a ball and is wound up as it turns; simulated", 92'230, 94, true},
          nullptr,
          simulate_cloth_on_ball},
    Entry{{"funnel", "cloth that a growing ball pushes through a funnel; simulated", 18'470, 501, true},
          nullptr,
          simulate_funnel},
    Entry{{"cutting", "sheet torn into a ribbon, with more triangles every frame; simulated", 20'000, 120, true},
          nullptr,
          simulate_cutting},
};

constexpr std::int64_t most_triangles = 500'000'000;     // up to three vertices each, whose indices must fit int32
constexpr std::int64_t fewest_cached_triangles = 5'000;  // with fewer, simulating is as fast as reading

[[noreturn]] void fail(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

const Entry& find(std::string_view name) {
    std::string known;
    for (const Entry& entry : entries) {
        if (entry.description.name == name) return entry;
        known += (known.empty() ? "" : ", ") + std::string(entry.description.name);
    }
    fail("there is no scene " + std::string(name) + "; the scenes are " + known);
}

}  // namespace

std::span<const Description> descriptions() {
    static const auto list = [] {
        std::array<Description, entries.size()> result;
        for (std::size_t i = 0; i < entries.size(); ++i) result[i] = entries[i].description;
        return result;
    }();
    return list;
}

struct Animation::Implementation {
    const Entry& entry;
    Parameters parameters;
    Progress progress;
    std::unique_ptr<SimulatedFrames> simulated;
};

Animation::Animation(std::string_view name, const Parameters& parameters, Progress progress)
    : implementation_(new Implementation{find(name), parameters, std::move(progress), {}}) {
    Parameters& p = implementation_->parameters;
    if (p.triangles < 0 || p.triangles > most_triangles) {
        fail("triangles must be 0 (the default of the scene) to " + std::to_string(most_triangles) + ", not " +
             std::to_string(p.triangles));
    }
    const Entry& entry = implementation_->entry;
    if (p.triangles == 0) p.triangles = entry.description.triangles;
    if (!entry.simulate) return;
    const bool kept = p.triangles >= fewest_cached_triangles;
    const std::string key = std::string(name) + "-" + std::to_string(p.triangles) + "-" + std::to_string(p.seed);
    implementation_->simulated = std::make_unique<SimulatedFrames>(entry.simulate(p), kept ? key : "");
}

Animation::~Animation() = default;
Animation::Animation(Animation&&) noexcept = default;
Animation& Animation::operator=(Animation&&) noexcept = default;

const Description& Animation::description() const { return implementation_->entry.description; }

io::TriangleMesh Animation::frame(int index) {
    const Description& scene = description();
    if (index < 0 || index >= scene.frames) {
        fail("scene " + std::string(scene.name) + " has no frame " + std::to_string(index) + "; its frames are 0 to " +
             std::to_string(scene.frames - 1));
    }
    if (implementation_->simulated) {
        return implementation_->simulated->frame(index, [&](int reached) {
            if (implementation_->progress) implementation_->progress(reached, index);
        });
    }
    implementation_->parameters.frame = index;
    return implementation_->entry.make(implementation_->parameters);
}

io::TriangleMesh make(std::string_view name, const Parameters& parameters, const Progress& progress) {
    return Animation(name, parameters, progress).frame(parameters.frame);
}

}  // namespace crumple::scenes
