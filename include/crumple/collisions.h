#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "crumple/array.h"

namespace crumple {

/// Two colliding triangles. One soup: a < b. Two meshes: a counts in the first, b in the second.
struct Pair {
    std::int32_t a, b;
    friend auto operator<=>(const Pair&, const Pair&) = default;
};

enum class ContactKind : std::uint8_t { point = 1, segment = 2, area = 3 };

/// Where the pairs meet: for pair i, kinds[i] and the points [offsets[i], offsets[i + 1]).
///
/// The points are the extreme points of the exact intersection, each coordinate rounded to the nearest float64. The
/// lexicographically smallest exact point comes first; areas run counter-clockwise about the first triangle's normal.
struct Contacts {
    Array<ContactKind> kinds;
    Array<std::int64_t> offsets;          ///< pairs + 1
    Array<std::array<double, 3>> points;  ///< 1, 2 or 3 to 6 a pair
};

/// The stages of the method, in order. `output` makes the sorted result.
enum class Stage : std::uint8_t { bounds, subdivide, align, sort, sweep, narrow, output };
inline constexpr int stage_count = 7;
constexpr std::string_view stage_name(Stage stage) {
    constexpr std::array<std::string_view, stage_count> names{"bounds", "subdivide", "align", "sort",
                                                              "sweep",  "narrow",    "output"};
    return names[static_cast<std::size_t>(stage)];
}

/// What a call did. Times are wall-clock for the total and summed over threads for the stages.
struct Statistics {
    double milliseconds = 0;                               ///< wall-clock time of the call
    std::array<double, stage_count> stage_milliseconds{};  ///< summed over threads
    std::int64_t triangles = 0;
    std::int64_t clusters = 0;        ///< first level
    std::int64_t leaves = 0;          ///< clusters that were swept
    std::int64_t members = 0;         ///< memberships of triangles in leaves
    std::int64_t interval_tests = 0;  ///< overlaps along the sweep direction: the prefix sum's total
    std::int64_t box_overlaps = 0;    ///< candidate pairs that left the sweep
    std::int64_t edge_tests = 0;      ///< pairs that no plane separated
    std::int64_t double_tests = 0;    ///< pairs that float32 filters left undecided
    std::int64_t exact_tests = 0;     ///< pairs that float64 filters left undecided: exact arithmetic
    std::int64_t rational_tests = 0;  ///< of these, beyond the range of expansions
    /// Contacts that took rational arithmetic, which cuda leaves to the host: of triangles in one plane, of degenerate
    /// ones, and points that double words could not round.
    std::int64_t rational_contacts = 0;
    std::int64_t pairs = 0;
    std::int64_t peak_memory_bytes = 0;  ///< most that the detector has owned
    int threads = 1;
    std::string_view backend;  ///< "reference", "cpu", "cuda"
    std::string_view simd;     ///< Highway's name of the instruction set: "scalar", "SSE4", "AVX2", "AVX3_DL", ...

    double& operator[](Stage stage) { return stage_milliseconds[static_cast<std::size_t>(stage)]; }
    double operator[](Stage stage) const { return stage_milliseconds[static_cast<std::size_t>(stage)]; }
};

/// The answer: every colliding pair, once, in lexicographic order. The same bytes from every backend, thread count and
/// cluster count. A plain value: copy it to keep it beyond the detector's next call.
struct Collisions {
    Array<Pair> pairs;
    Array<std::int64_t> offsets;     ///< pairs of triangle i as first: [offsets[i], offsets[i + 1]); size m + 1
    Array<std::uint8_t> hit;         ///< 1 for each triangle (of the first mesh) in some pair
    Array<std::uint8_t> hit_second;  ///< the same for the second mesh; empty for one soup
    Contacts contacts;               ///< empty unless asked for
    Statistics statistics;
};

/// An answer that lies in the memory of a device: pointers of the device, as Collisions has arrays. How long it is
/// valid, Detector::wait says.
struct DeviceCollisions {
    /// False if lists of fixed length were too short for it (Detector::launch_self in a capture): there are no arrays.
    bool complete = true;
    /// Pairs that there are; where the answer is not complete, those that were found, and there may be more.
    std::int64_t pairs_needed = 0;
    const Pair* pairs = nullptr;  ///< pair_count
    std::int64_t pair_count = 0;
    const std::int64_t* offsets = nullptr;     ///< hit_count + 1
    const std::uint8_t* hit = nullptr;         ///< hit_count: triangles of the first mesh
    const std::uint8_t* hit_second = nullptr;  ///< hit_second_count; null for one soup
    std::int64_t hit_count = 0, hit_second_count = 0;
    const ContactKind* contact_kinds = nullptr;             ///< pair_count; null unless asked for
    const std::int64_t* contact_offsets = nullptr;          ///< pair_count + 1
    const std::array<double, 3>* contact_points = nullptr;  ///< contact_point_count
    std::int64_t contact_point_count = 0;
    Statistics statistics;
};

}  // namespace crumple
