#pragma once

// Scenes for tests, benchmarks, examples and the command line, made by formula or simulated.
//
// A scene is the same, bit for bit, on every machine: it comes from its parameters through integer hashes and the four
// operations and square root of IEEE arithmetic alone (scenes/arithmetic.h), without contraction.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "crumple/io.h"

namespace crumple::scenes {

struct Parameters {
    std::int64_t triangles = 0;  ///< about as many; 0: the scene's default
    int frame = 0;               ///< 0 to Description::frames - 1
    std::uint64_t seed = 1;      ///< other numbers give other scenes of the same kind
};

struct Description {
    std::string_view name;
    std::string_view summary;  ///< one line
    std::int64_t triangles;    ///< default
    int frames;                ///< 1: it does not move
    bool simulated = false;    ///< a frame takes all frames before it: seconds to minutes, unless they are in the cache
};

/// Every scene, in the order to list them in.
std::span<const Description> descriptions();

/// Told, while a scene is simulated, which frame has been reached and which one is wanted.
using Progress = std::function<void(int reached, int wanted)>;

/// The frames of one scene. Simulated ones go on from the frame before and are kept on disk, under
/// $XDG_CACHE_HOME/crumple or ~/.cache/crumple, unless they have fewer than 5,000 triangles; 12 bytes a vertex.
class Animation {
   public:
    /// `parameters.frame` means nothing here. Throws Error (invalid_argument) for a name that is unknown, naming the
    /// known ones, or a number of triangles that is negative or above 500 million.
    explicit Animation(std::string_view name, const Parameters& parameters = {}, Progress progress = {});
    ~Animation();
    Animation(Animation&&) noexcept;
    Animation& operator=(Animation&&) noexcept;

    const Description& description() const;

    /// The number of triangles is within a tenth of what was asked for, from ten thousand on; few triangles may be too
    /// few for a scene to be what it is, and then it has more. Throws Error (invalid_argument) for a frame that does
    /// not exist.
    io::TriangleMesh frame(int index);

   private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// One frame of an animation. Throws as it does.
io::TriangleMesh make(std::string_view name, const Parameters& parameters = {}, const Progress& progress = {});

}  // namespace crumple::scenes
