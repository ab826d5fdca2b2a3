#include "scenes/scenes.h"

#include <array>
#include <string>

#include "crumple/error.h"
#include "scenes/cloth.h"
#include "scenes/list.h"

namespace crumple::scenes {
namespace {

struct Entry {
    Description description;
    io::TriangleMesh (*make)(const Parameters&);
};

constexpr std::array entries{
    Entry{{"cloth", "sheet that sinks over a ball and crumples through itself", 92'230, cloth_frames}, make_cloth},
    Entry{{"ground", "the cloth on a ground of two huge triangles", 92'230, cloth_frames}, make_ground},
    Entry{{"soup", "random triangles of equal size", 100'000, 1}, make_soup},
    Entry{{"needles", "random needles, a hundred times as long as wide", 100'000, 1}, make_needles},
    Entry{{"five_decades", "random triangles whose sizes spread over five decades", 100'000, 1}, make_five_decades},
    Entry{{"bodies", "tumbling balls, boxes and rings that pass through each other", 100'000, 60}, make_bodies},
    Entry{{"shells", "concentric spheres: no collision at all", 100'000, 1}, make_shells},
    Entry{{"fans", "crossing coins, each two fans of needles around one vertex", 12'000, 1}, make_fans},
    Entry{{"lattice", "exactly touching, coplanar, duplicated, folded, degenerate triangles; float64", 20'000, 1},
          make_lattice},
};

constexpr std::int64_t most_triangles = 500'000'000;  // three vertices each, counted in int32

}  // namespace

std::span<const Description> descriptions() {
    static const auto list = [] {
        std::array<Description, entries.size()> result;
        for (std::size_t i = 0; i < entries.size(); ++i) result[i] = entries[i].description;
        return result;
    }();
    return list;
}

io::TriangleMesh make(std::string_view name, const Parameters& parameters) {
    const auto fail = [&](const std::string& message) { throw Error(ErrorCode::invalid_argument, message); };
    std::string known;
    for (const Entry& entry : entries) {
        const Description& description = entry.description;
        known += (known.empty() ? "" : ", ") + std::string(description.name);
        if (description.name != name) continue;
        if (parameters.frame < 0 || parameters.frame >= description.frames) {
            fail("scene " + std::string(name) + " has no frame " + std::to_string(parameters.frame) +
                 "; its frames are 0 to " + std::to_string(description.frames - 1));
        }
        if (parameters.triangles < 0 || parameters.triangles > most_triangles) {
            fail("cannot make " + std::to_string(parameters.triangles) + " triangles, only up to " +
                 std::to_string(most_triangles));
        }
        Parameters used = parameters;
        if (used.triangles == 0) used.triangles = description.triangles;
        return entry.make(used);
    }
    fail("there is no scene " + std::string(name) + "; there are " + known);
    return {};
}

}  // namespace crumple::scenes
