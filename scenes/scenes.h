#pragma once

// Scenes for tests, benchmarks, examples and the command line, made by formula or simulated.
//
// A scene is the same, bit for bit, on every machine: it is computed from its parameters by integer hashes and by the
// four operations and the square root of IEEE arithmetic only (scenes/arithmetic.h), without contraction.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "crumple/io.h"

namespace crumple::scenes {

struct Parameters {
    std::int64_t triangles = 0;  ///< approximate number; 0: the scene's default
    int frame = 0;               ///< 0 to Description::frames - 1
    std::uint64_t seed = 1;      ///< other numbers give other scenes of the same kind
};

struct Description {
    std::string_view name;
    std::string_view summary;  ///< one line
    std::int64_t triangles;    ///< default number
    int frames;                ///< 1: the scene does not move
    bool simulated = false;    ///< a frame needs all frames before it: seconds to minutes, unless they are cached
};

/// Returns the descriptions of all scenes, in the order in which to list them.
std::span<const Description> descriptions();

/// Called while a scene is simulated, with the frame that has been reached and the requested one.
using Progress = std::function<void(int reached, int wanted)>;

/// Frames of one scene. Simulated frames continue from the frame before. They are cached on disk, 12 bytes per vertex,
/// under $XDG_CACHE_HOME/crumple or ~/.cache/crumple, unless they have fewer than 5,000 triangles.
class Animation {
   public:
    /// Ignores `parameters.frame`. Throws Error (invalid_argument) for an unknown name, with a list of all names, and
    /// for a number of triangles that is negative or above 500 million.
    explicit Animation(std::string_view name, const Parameters& parameters = {}, Progress progress = {});
    ~Animation();
    Animation(Animation&&) noexcept;
    Animation& operator=(Animation&&) noexcept;

    const Description& description() const;

    /// Returns a frame. If at least ten thousand triangles are requested, the number of triangles is within a tenth of
    /// that. A scene may need more triangles than a smaller requested number. Throws Error (invalid_argument) for a
    /// frame that does not exist.
    io::TriangleMesh frame(int index);

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Returns one frame of a scene. Throws like Animation.
io::TriangleMesh make(std::string_view name, const Parameters& parameters = {}, const Progress& progress = {});

}  // namespace crumple::scenes
