#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "crumple/array.h"
#include "crumple/query.h"

namespace crumple {

struct Intersections;
struct DeviceIntersections;
struct DistributedIntersections;

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

/// Counts and times of a call. Times are wall-clock for the total and summed over threads for the stages.
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

/// Pairs of triangles that share a vertex.
enum class Neighbours : std::uint8_t {
    geometric,  ///< intersect only if they meet outside the hull of what they share: a fold counts, a hinge does not
    skip,       ///< never reported
};

enum class IntersectionKind : std::uint8_t {
    all,     ///< closed sets: touching counts
    proper,  ///< only if an edge of one strictly crosses the relative interior of the other
};

/// Query for the triangles that intersect (docs/contract.md); where things move, at the start. A value: it owns what
/// it names.
struct IntersectionQuery {
    using Result = Intersections;
    using DeviceResult = DeviceIntersections;
    using DistributedResult = DistributedIntersections;

    /// Any but `first`; of meshes in device memory `any`, `pairs` or `contacts`; in blocks and of parts `pairs` or
    /// `contacts`.
    Output output = Output::pairs;
    Neighbours neighbours = Neighbours::geometric;
    IntersectionKind kind = IntersectionKind::all;
    /// Vertices at equal positions (-0 equals +0) count as one, also those of different meshes and bodies.
    bool weld = false;
    /// A body inside another one counts in the outputs any, any_by_world and body_pairs, never as pairs of triangles,
    /// and `inside` is set for that body pair. Two bodies count if their surfaces meet, or else if a component of one
    /// has a vertex at which the winding number of the other's surface is not 0. A cavity is outside: its winding
    /// number is 0.
    ///
    /// For worlds and two meshes, with `kind` all and without filters of groups if shapes have groups. With `weld`,
    /// which also closes the seams of each body, `neighbours` has to be geometric, and vertices that are one with
    /// vertices of the other body do not count. Additional cost: a ray for each component that lies in the other's box,
    /// of bodies whose boxes overlap and whose surfaces do not meet.
    bool containment = false;
    /// Treatment of bodies that are not closed, in pairs whose boxes overlap and whose surfaces do not meet. Such a
    /// body can still be reported as lying inside another one.
    OpenSurfaces open = OpenSurfaces::error;
    PairFilter filter = {};
    bool index =
        false;  ///< of worlds: also make offsets and hit flags, where pairs are listed; meshes always have them

    bool contacts() const { return output == Output::contacts; }
};

/// Result of an IntersectionQuery: every pair once. Of a mesh in lexicographic order, a < b; of two meshes a counts in
/// the first, b in the second. Of worlds in the order of first body, its triangle, second body, its triangle: so worlds
/// follow each other, and pairs among bodies that are in all worlds, which come once, are last. The same bytes from
/// every backend, thread count and cluster count. A plain value: copy it to keep it beyond the detector's next call.
struct Intersections {
    bool any = false;        ///< whether anything intersects
    std::int64_t count = 0;  ///< pairs of triangles, where they are counted or listed; else 0

    Array<std::uint8_t> world_hit;     ///< one a world: something intersects (not for Output::any); of worlds only
    Array<std::int64_t> world_counts;  ///< one a world: pairs of triangles (from Output::count on); of worlds only

    /// Bodies of each pair, in worlds; for Output::body_pairs those that intersect, each once. Else empty.
    Array<BodyPair> bodies;
    /// For IntersectionQuery::containment and Output::body_pairs: one entry per pair of bodies, 1 if their surfaces do
    /// not meet, and one body has a component inside the other. Else empty.
    Array<std::uint8_t> inside;
    /// For IntersectionQuery::containment and OpenSurfaces::skip: bodies that are not closed, ascending, among selected
    /// pairs whose boxes overlap and whose surfaces do not meet. Empty for Output::any if surfaces meet; for
    /// Output::any_by_world, worlds in which surfaces meet add none.
    Array<std::int32_t> skipped;
    Array<Pair> pairs;  ///< triangles, as they count within their bodies or meshes
    Contacts contacts;  ///< for Output::contacts

    // For a mesh, two meshes, and parts:
    Array<std::int64_t> offsets;     ///< pairs of triangle i as first: [offsets[i], offsets[i + 1]); size m + 1
    Array<std::uint8_t> hit_second;  ///< 1 for each triangle of the second mesh in some pair; empty for one mesh

    /// 1 for each triangle (of the first mesh; of all bodies, one after another, see first_triangle) in some pair.
    Array<std::uint8_t> hit;

    // For worlds, where IntersectionQuery::index asks for them:
    Array<std::int64_t>
        world_offsets;                 ///< pairs of world w: [world_offsets[w], world_offsets[w + 1]); the rest follows
    Array<std::int64_t> body_offsets;  ///< pairs whose first body is b: [body_offsets[b], body_offsets[b + 1])
    Array<std::int64_t> first_triangle;  ///< of each body, in `hit`; the number of bodies + 1

    Statistics statistics;
};

/// The same in the memory of a device: pointers of the device, in the same order.
struct DeviceIntersections {
    /// False if lists of fixed length were too short for it (Detector::launch in a capture): there are no arrays.
    bool complete = true;
    bool of_worlds = false;  ///< the launch was one of worlds, else of meshes
    /// Pairs that there are; where the result is not complete, those that were found, and there may be more.
    std::int64_t pairs_needed = 0;
    bool any = false;        ///< whether anything intersects
    std::int64_t count = 0;  ///< pairs of triangles

    const BodyPair* bodies = nullptr;  ///< count: of worlds for each pair its bodies; null below Output::pairs
    const Pair* pairs = nullptr;       ///< count; null below Output::pairs
    const ContactKind* contact_kinds = nullptr;             ///< count; null unless asked for
    const std::int64_t* contact_offsets = nullptr;          ///< count + 1
    const std::array<double, 3>* contact_points = nullptr;  ///< contact_point_count
    std::int64_t contact_point_count = 0;

    // For a mesh, and two meshes:
    const std::int64_t* offsets = nullptr;     ///< hit_count + 1
    const std::uint8_t* hit = nullptr;         ///< hit_count: triangles of the first mesh
    const std::uint8_t* hit_second = nullptr;  ///< hit_second_count; null for one mesh
    std::int64_t hit_count = 0, hit_second_count = 0;

    // For worlds:
    std::int64_t worlds = 0;
    const std::uint8_t* world_hit = nullptr;      ///< worlds: something intersects
    const std::int64_t* world_counts = nullptr;   ///< worlds: pairs of triangles
    const std::int64_t* world_offsets = nullptr;  ///< worlds + 1: pairs of world w begin here; the rest follows
    Statistics statistics;
};

}  // namespace crumple
