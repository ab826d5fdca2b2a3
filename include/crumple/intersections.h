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

/// Pair of triangles, or of features (FeatureKind, CandidateKind), by index. Triangles: for a single mesh, a < b; for
/// two meshes, a is an index into the first and b into the second.
struct Pair {
    std::int32_t a, b;
    friend auto operator<=>(const Pair&, const Pair&) = default;
};

/// Dimension of a contact.
enum class ContactKind : std::uint8_t { point = 1, segment = 2, area = 3 };

/// Contacts of the pairs: pair i has kinds[i] and the points [offsets[i], offsets[i + 1]).
///
/// The points are the extreme points of the exact intersection, each coordinate rounded to the nearest float64. The
/// lexicographically smallest exact point comes first; areas run counter-clockwise about the first triangle's normal.
struct Contacts {
    Array<ContactKind> kinds;
    Array<std::int64_t> offsets;          ///< pairs + 1
    Array<std::array<double, 3>> points;  ///< 1 (point), 2 (segment) or 3 to 6 (area) per pair
};

/// Stages of the method, in order. `output` makes the sorted result.
enum class Stage : std::uint8_t { bounds, subdivide, align, sort, sweep, narrow, output };
inline constexpr int stage_count = 7;
/// Returns the name of the enumerator, such as "bounds".
constexpr std::string_view stage_name(Stage stage) {
    constexpr std::array<std::string_view, stage_count> names{"bounds", "subdivide", "align", "sort",
                                                              "sweep",  "narrow",    "output"};
    return names[static_cast<std::size_t>(stage)];
}

/// Counts and times of a call. Stage times are sums over threads.
struct Statistics {
    double milliseconds = 0;                               ///< wall-clock time of the call
    std::array<double, stage_count> stage_milliseconds{};  ///< summed over threads
    std::int64_t triangles = 0;
    std::int64_t clusters = 0;        ///< clusters of the first level of subdivision
    std::int64_t leaves = 0;          ///< leaves: the final clusters, whose members are swept together
    std::int64_t members = 0;         ///< triangles of all leaves, counted once per leaf
    std::int64_t interval_tests = 0;  ///< box tests of the sweep: pairs whose intervals along the sweep direction
                                      ///< overlap, or nearly, because their ends are rounded to bins
    std::int64_t box_overlaps = 0;    ///< candidates: pairs of triangles that the sweep passes to `narrow`
    // Tests of pairs of triangles or, in queries about features, of pairs of features:
    std::int64_t edge_tests = 0;      ///< tests of candidate pairs that no plane or direction separates
    std::int64_t double_tests = 0;    ///< tests left undecided by float32 filters
    std::int64_t exact_tests = 0;     ///< tests decided exactly; for intersections, those that float64 filters leave
    std::int64_t rational_tests = 0;  ///< exact tests that took rational arithmetic
    /// Contacts computed in rational arithmetic, by the host even with cuda: of coplanar or degenerate triangles, and
    /// points that double-double arithmetic could not round.
    std::int64_t rational_contacts = 0;
    std::int64_t pairs = 0;
    std::int64_t peak_memory_bytes = 0;  ///< most bytes that the detector has owned
    /// False if rows may be missing, because a triangle is not in all clusters in which it could meet others
    /// (Method::membership). Always true with the default membership rule.
    bool complete = true;
    int threads = 1;
    std::string_view backend;  ///< "reference", "cpu", "cuda"
    std::string_view simd;     ///< Highway's name of the instruction set: "scalar", "SSE4", "AVX2", "AVX3_DL", ...

    double& operator[](Stage stage) { return stage_milliseconds[static_cast<std::size_t>(stage)]; }
    double operator[](Stage stage) const { return stage_milliseconds[static_cast<std::size_t>(stage)]; }
};

/// Treatment of pairs of adjacent triangles, that is, of triangles that share a vertex.
enum class Neighbours : std::uint8_t {
    /// Intersect if they also meet outside the convex hull of the vertices that they share. Two triangles that are
    /// folded onto each other at a common edge do; a hinge, whose triangles meet only in their common edge, does not.
    geometric,
    skip,  ///< never reported
};

/// Pairs of triangles that count as intersecting.
enum class IntersectionKind : std::uint8_t {
    all,     ///< closed sets: touching counts
    proper,  ///< an edge of one strictly crosses the relative interior of the other
};

/// Query for all pairs of triangles that intersect (docs/contract.md). If the triangles move, their positions at the
/// start count. A value: it owns its data.
struct IntersectionQuery {
    using Result = Intersections;
    using DeviceResult = DeviceIntersections;
    using DistributedResult = DistributedIntersections;

    /// All values but `first` and `nearest`. Meshes in device memory: `any`, `pairs` or `contacts`. Blocks and parts:
    /// `pairs` or `contacts`.
    Output output = Output::pairs;
    Neighbours neighbours = Neighbours::geometric;
    IntersectionKind kind = IntersectionKind::all;
    /// Vertices at equal positions (-0 equals +0) count as one, including those of different meshes and bodies.
    bool weld = false;
    /// Also counts a body inside another one, for the outputs any, any_by_world and body_pairs; other outputs are an
    /// error. `inside` is set for that pair of bodies. Two bodies count if their surfaces meet, or else if a component
    /// of one has a vertex at which the winding number of the other's surface is not 0. A cavity is outside: its
    /// winding number is 0.
    ///
    /// For worlds and two meshes, with `kind` all, without PairScope::within of bodies, and without filters of groups
    /// if shapes have groups. With `weld`, which also closes the seams of each body, `neighbours` has to be geometric,
    /// and vertices that are merged with a vertex of the other body are not tested for being inside. Meshes must be in
    /// host memory. Additional cost: for bodies whose boxes overlap and whose surfaces do not meet, one ray for each
    /// component that lies in the other's box.
    bool containment = false;
    /// For `containment`: treatment of bodies whose surfaces are not closed, in pairs whose boxes overlap and whose
    /// surfaces do not meet. Such a body can still be reported as lying inside another one.
    OpenSurfaces open = OpenSurfaces::error;
    PairFilter filter = {};
    /// For worlds: also makes offsets and hit flags if pairs are listed; meshes always have them.
    bool index = false;

    /// True if contacts are requested.
    bool contacts() const { return output == Output::contacts; }
};

/// Result of an IntersectionQuery: every pair once. For a single mesh a < b, in lexicographic order; for two meshes, a
/// is an index into the first and b into the second. For worlds sorted by first body, its triangle, second body, its
/// triangle: so worlds follow each other, and pairs among bodies that are in all worlds are listed once, at the end.
/// Results are the same bytes from every backend, thread count and cluster count. A plain value: copy it to keep it
/// beyond the detector's next call.
struct Intersections {
    bool any = false;        ///< true if anything intersects, or counts by IntersectionQuery::containment
    std::int64_t count = 0;  ///< number of pairs of triangles if they are counted or listed, else 0

    Array<std::uint8_t> world_hit;  ///< for worlds, per world: 1 if something intersects (not for Output::any)
    /// For worlds, per world: number of pairs of triangles; for Output::count, pairs and contacts.
    Array<std::int64_t> world_counts;

    /// For worlds, the bodies of each pair; for Output::body_pairs each intersecting pair of bodies once. Else empty.
    Array<BodyPair> bodies;
    /// For IntersectionQuery::containment and Output::body_pairs: one entry per pair of bodies, which is 1 if their
    /// surfaces do not meet and one body has a component inside the other. Else empty.
    Array<std::uint8_t> inside;
    /// For IntersectionQuery::containment and OpenSurfaces::skip: bodies whose surfaces are not closed, ascending, in
    /// pairs of bodies that the filter selects, whose boxes overlap and whose surfaces do not meet. For Output::any,
    /// empty if any surfaces meet; for Output::any_by_world, without the bodies of worlds in which surfaces meet.
    Array<std::int32_t> skipped;
    Array<Pair> pairs;  ///< triangles, by index within their bodies or meshes
    Contacts contacts;  ///< for Output::contacts

    // For a mesh, two meshes, and parts:
    Array<std::int64_t> offsets;  ///< pairs with first triangle i: [offsets[i], offsets[i + 1]); m + 1 for m triangles
                                  ///< of the first mesh
    Array<std::uint8_t> hit_second;  ///< 1 for each triangle of the second mesh in some pair; empty for one mesh

    /// 1 for each triangle that is in some pair: triangles of the first mesh, or of all bodies, one after another (see
    /// first_triangle).
    Array<std::uint8_t> hit;

    // For worlds, with IntersectionQuery::index:
    /// Pairs of world w: [world_offsets[w], world_offsets[w + 1]). Pairs among bodies that are in all worlds follow
    /// after the last.
    Array<std::int64_t> world_offsets;
    Array<std::int64_t> body_offsets;    ///< pairs whose first body is b: [body_offsets[b], body_offsets[b + 1])
    Array<std::int64_t> first_triangle;  ///< start of each body's triangles in `hit`, then the length of `hit`

    Statistics statistics;
};

/// Result of an IntersectionQuery in device memory. Arrays have the contents and the order of those of Intersections.
/// The comment at a pointer begins with the length of the array.
struct DeviceIntersections {
    /// False if a list of fixed length overflowed (Detector::launch in a capture): then there are no arrays.
    bool complete = true;
    bool of_worlds = false;  ///< true for worlds, false for meshes
    /// Number of pairs; if the result is incomplete, the number found so far, a lower bound.
    std::int64_t pairs_needed = 0;
    bool any = false;        ///< true if anything intersects
    std::int64_t count = 0;  ///< number of pairs of triangles

    const BodyPair* bodies = nullptr;  ///< count: the bodies of each pair, for worlds; null if pairs are not listed
    const Pair* pairs = nullptr;       ///< count; null if pairs are not listed
    const ContactKind* contact_kinds = nullptr;             ///< count; null unless contacts are requested
    const std::int64_t* contact_offsets = nullptr;          ///< count + 1: see Contacts
    const std::array<double, 3>* contact_points = nullptr;  ///< contact_point_count
    std::int64_t contact_point_count = 0;

    // For a mesh, and two meshes:
    const std::int64_t* offsets = nullptr;     ///< hit_count + 1: see Intersections::offsets
    const std::uint8_t* hit = nullptr;         ///< hit_count: triangles of the first mesh
    const std::uint8_t* hit_second = nullptr;  ///< hit_second_count; null for one mesh
    std::int64_t hit_count = 0, hit_second_count = 0;

    // For worlds:
    std::int64_t worlds = 0;
    const std::uint8_t* world_hit = nullptr;     ///< worlds: 1 if something intersects
    const std::int64_t* world_counts = nullptr;  ///< worlds: number of pairs of triangles
    /// worlds + 1: start of the pairs of each world, then their end, after which pairs among bodies that are in all
    /// worlds follow.
    const std::int64_t* world_offsets = nullptr;
    Statistics statistics;
};

}  // namespace crumple
