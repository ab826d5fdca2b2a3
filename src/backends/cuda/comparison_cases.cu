#include "backends/cuda/comparison_cases.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "backends/cuda/comparison_case_data.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/features/feature_decisions.h"
#include "backends/cuda/features/feature_narrow.h"
#include "backends/cuda/intersections/device_contacts.h"
#include "backends/cuda/intersections/intersection_narrow.h"
#include "backends/cuda/overlaps/crossing_terms.h"
#include "base/float_environment.h"
#include "crumple/error.h"
#include "exact/intersection/contact_on_line.h"
#include "exact/intersection/intersection_decision.h"
#include "exact/overlap/filtered_crossing.h"

namespace crumple::cuda {
namespace {

constexpr std::size_t case_count = 96;  // three warps, so that each kernel runs as one block
constexpr std::size_t kinds = 2;        // kinds of feature pairs: vertex_face and edge_edge
constexpr std::size_t queries = 3;      // near, impacts, impacts with a minimum distance
using Count = unsigned long long;

/// Decisions about all cases for one IntersectionKind.
struct Decisions {
    Count* collides;  ///< by triangle: 1 for the first triangle of a colliding case, else 0
    Count* found;
    Pair* beyond;
    Count* unresolved_count;

    void cut(ArenaLayout& c) {
        collides = c.take<Count>(2 * case_count);
        found = c.take<Count>(1);
        beyond = c.take<Pair>(case_count);
        unresolved_count = c.take<Count>(1);
    }
};

/// Results of one feature query.
struct FeatureResults {
    FeatureHits hits;
    FeatureTest* open[kinds];
    Count* open_count;
    UnresolvedTest* beyond;
    Count* unresolved_count;

    void cut(ArenaLayout& c) {
        for (std::size_t k = 0; k <= feature_kinds; ++k)
            hits.firsts.base[k] = static_cast<std::uint32_t>(std::min(k, kinds) * case_count);
        hits.list = {c.take<RankedHit>(kinds * case_count), c.take<Count>(1), kinds * case_count};
        hits.by_first = c.take<Count>(kinds * case_count);
        for (FeatureTest*& list : open) list = c.take<FeatureTest>(case_count);
        open_count = c.take<Count>(feature_kinds);
        beyond = c.take<UnresolvedTest>(kinds * case_count);
        unresolved_count = c.take<Count>(1);
    }
};

/// All arrays that the kernels read and write, in one block of memory. The block has the same layout on the host and on
/// the device, so that one copy transfers all arrays.
struct Arrays {
    Vec3d *start, *end;
    std::int32_t* corners;
    SortedRow* rows;  ///< row i holds triangle i
    Candidate* candidates;
    Pair* pairs;
    FeatureTest* tests[kinds];
    Count* test_count;  ///< length of each list of tests, and of the candidates
    Decisions all, proper;
    ContactArrays contacts;
    FeatureResults features[queries];
    RowArrays* overlap;    ///< one row, in which all triangles belong to both surfaces
    Count* overlap_begin;  ///< 0
    PackedCrossings* crossings;

    void cut(ArenaLayout& c) {
        start = c.take<Vec3d>(6 * case_count);
        end = c.take<Vec3d>(6 * case_count);
        corners = c.take<std::int32_t>(6 * case_count);
        rows = c.take<SortedRow>(2 * case_count);
        candidates = c.take<Candidate>(case_count);
        pairs = c.take<Pair>(case_count);
        for (FeatureTest*& list : tests) list = c.take<FeatureTest>(case_count);
        test_count = c.take<Count>(feature_kinds);
        all.cut(c);
        proper.cut(c);
        contacts.cut(c, case_count);
        for (FeatureResults& results : features) results.cut(c);
        overlap = c.take<RowArrays>(1);
        overlap_begin = c.take<Count>(1);
        crossings = c.take<PackedCrossings>(case_count);
    }

    PreparedScene scene(bool moving) const {
        const auto reader = [](const Vec3d* points) {
            return VertexReader{reinterpret_cast<const std::byte*>(points), sizeof(Vec3d), sizeof(double), false};
        };
        PreparedScene scene;
        scene.float32 = false;
        scene.reader[0] = scene.reader[1] = reader(start);
        scene.vertices[0] = 6 * case_count;
        scene.triangles[0] = 2 * case_count;
        scene.corners = corners;
        scene.moving = moving;
        scene.end = reader(end);
        return scene;
    }
};

FeatureConditions query_of(std::size_t query) {
    FeatureConditions asked;
    asked.motion = query > 0;
    asked.distance = query == 0 ? 1 : query == 1 ? 0 : 0.25;
    return asked;
}

Pair pair_of(std::size_t i) { return {static_cast<std::int32_t>(2 * i), static_cast<std::int32_t>(2 * i + 1)}; }

void write_cases(const Arrays& a) {
    const ComparisonCases cases = make_comparison_cases(case_count);
    std::ranges::copy(cases.start, a.start);
    std::ranges::copy(cases.end, a.end);
    std::ranges::copy(cases.corners, a.corners);
    for (std::size_t i = 0; i < case_count; ++i) {
        const auto n = static_cast<std::int32_t>(i), first = 6 * n;
        a.rows[2 * i].triangle = 2 * n, a.rows[2 * i + 1].triangle = 2 * n + 1;
        a.candidates[i] = {static_cast<std::uint32_t>(2 * i), static_cast<std::uint32_t>(2 * i + 1)};
        a.pairs[i] = pair_of(i);
        a.tests[0][i] = {{n, n}, {first + 3, first, first + 1, first + 2}};
        a.tests[1][i] = {{n, n}, {first, first + 1, first + 3, first + 4}};
    }
    std::fill_n(a.test_count, feature_kinds, case_count);
}

/// Makes the triangles on the device the faces of both surfaces.
void write_overlap(const Arrays& on_host, const Arrays& on_device) {
    const SurfaceArrays surface{on_device.start, on_device.corners};
    *on_host.overlap = {{surface, surface}, {}, 0};
}

// Launches all kernels. Computes contacts for every pair: most pairs collide, and for the others the kernel must find
// no contact.
void decide_on_device(const Geometry& geometry, cudaStream_t stream, const Arrays& a) {
    const PreparedScene scene = a.scene(false), moving = a.scene(true);
    Sorted sorted{};
    sorted.row = a.rows;
    const List<Candidate> candidates{a.candidates, a.test_count, case_count};
    const auto decide = [&](IntersectionKind intersections, const Decisions& decisions) {
        const Hits hits{Hits::Mode::count, {nullptr, decisions.found, 0}, decisions.collides, nullptr};
        decide_exactly(geometry, stream, scene, sorted, Neighbours::geometric, intersections, candidates,
                       {decisions.beyond, decisions.unresolved_count, case_count}, hits);
    };
    decide(IntersectionKind::all, a.all);
    decide(IntersectionKind::proper, a.proper);
    find_contacts(geometry, stream, scene, a.pairs, case_count, 0, a.contacts);
    CrossingArrays crossings{};
    crossings.rows = a.overlap;
    crossings.first_pairs = a.overlap_begin;
    crossings.row_count = 1;
    crossings.pairs = a.pairs;
    crossings.pair_count = case_count;
    crossings.crossings = a.crossings;
    decide_crossings(geometry, stream, crossings);
    for (std::size_t q = 0; q < queries; ++q) {
        const FeatureResults& results = a.features[q];
        TestLists tests{}, open{};
        for (std::size_t k = 0; k < kinds; ++k) {
            tests.of[k] = {a.tests[k], a.test_count + k, case_count};
            open.of[k] = {results.open[k], results.open_count + k, case_count};
        }
        decide_tests(geometry, stream, q > 0 ? moving : scene, query_of(q), false, tests, open,
                     {results.beyond, results.unresolved_count, kinds * case_count}, results.hits);
    }
}

std::string describe(const char* what, std::size_t i) {
    return std::string(what) + " of case " + std::to_string(i) + " of " + std::to_string(case_count);
}

std::string difference(const Arrays& a, const Decisions& found, IntersectionKind intersections) {
    const PreparedScene scene = a.scene(false);
    std::vector<Pair> beyond;
    for (std::size_t i = 0; i < case_count; ++i) {
        const Pair pair = pair_of(i);
        ExactSigns signs;
        const Verdict verdict =
            decide(scene.triangle(pair.a), scene.triangle(pair.b), Neighbours::geometric, intersections, signs);
        if (verdict == Verdict::undecided) beyond.push_back(pair);
        if (found.collides[2 * i] != (verdict == Verdict::collides)) return describe("the intersection", i);
    }
    // First triangles of pairs are unique, so comparing them is enough. (With nvcc 13.0, comparisons of Pair in host
    // code do not link.)
    const std::span listed(found.beyond, std::min<Count>(*found.unresolved_count, case_count));
    std::ranges::sort(listed, {}, &Pair::a);
    if (*found.unresolved_count != beyond.size() || !std::ranges::equal(listed, beyond, {}, &Pair::a, &Pair::a))
        return "the list of unresolved intersections";
    return {};
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

std::string difference(const Arrays& a, const ContactArrays& found) {
    const PreparedScene scene = a.scene(false);
    Count open = 0;
    for (std::size_t i = 0; i < case_count; ++i) {
        Contact contact;
        if (!contact_on_line(scene.triangle(pair_of(i).a), scene.triangle(pair_of(i).b), NothingExact{}, contact)) {
            contact.count = 0;
            ++open;
        }
        bool same = found.offsets[i] == static_cast<Count>(contact.count) && found.kinds[i] == contact.kind();
        for (std::size_t k = 0; same && k < static_cast<std::size_t>(contact.count); ++k)
            for (std::size_t axis = 0; axis < 3; ++axis)
                same = same && same_bits(found.loose[6 * i + k][axis], contact.points[k][static_cast<int>(axis)]);
        if (!same) return describe("the contact", i);
    }
    return *found.open_count == open ? std::string() : "the list of unresolved contacts";
}

std::string crossing_difference(const Arrays& a) {
    const SurfaceArrays surface{a.start, a.corners};
    for (std::size_t i = 0; i < case_count; ++i) {
        const FaceCorners p = surface.face(pair_of(i).a), q = surface.face(pair_of(i).b);
        if (!std::ranges::all_of(p, [](const Vec3d& corner) { return in_expansion_range(corner); })) continue;
        const CrossedFace first(p), second(q);
        FilteredCrossingSigns signs(first, second);
        if (a.crossings[i] != PackedCrossings::pack(crumple::decide_crossings(signs)))
            return describe("the crossing", i);
    }
    return {};
}

template <class Query>
std::string feature_difference(const Arrays& a, std::size_t which) {
    const PreparedScene scene = a.scene(which > 0);
    const Query query({scene, is_aligned(scene)}, query_of(which), false);
    const FeatureResults& found = a.features[which];
    const RankedHit* of[kinds * case_count] = {};
    for (std::size_t i = 0; i < std::min<Count>(*found.hits.list.count, kinds * case_count); ++i)
        if (found.hits.list.data[i].first < std::size(of)) of[found.hits.list.data[i].first] = &found.hits.list.data[i];
    Count beyond = 0;
    std::string wrong;
    const auto compare = [&]<FeatureKind kind>() {
        for (std::size_t i = 0; i < case_count && wrong.empty(); ++i) {
            const FeatureTest& test = a.tests[static_cast<std::size_t>(kind)][i];
            Decided expected = query.template quick<kind>(test);
            if (Query::closely && expected.outcome == Outcome::open) expected = query.template close<kind>(test);
            const RankedHit* hit = of[static_cast<std::size_t>(kind) * case_count + i];
            beyond += expected.outcome == Outcome::open;
            const bool is_hit = expected.outcome == Outcome::hit;
            if ((hit != nullptr) != is_hit ||
                (is_hit && (!same_bits(hit->value, expected.value) || (hit->flag != 0) != expected.flag)))
                wrong = describe(which == 0 ? "the distance" : "the impact", i);
        }
    };
    compare.template operator()<FeatureKind::vertex_face>();
    compare.template operator()<FeatureKind::edge_edge>();
    if (wrong.empty() && *found.unresolved_count != beyond) return "the list of unresolved pairs of features";
    return wrong;
}

}  // namespace

std::string find_difference_from_host(const Device& device, cudaStream_t stream) {
    const FloatEnvironment environment;  // rounding to nearest for the results that the host computes
    Geometry geometry = device.geometry();
    geometry.threads = case_count;
    MemoryMeter unlimited;
    Block block(unlimited);
    Arrays on_device;
    place_arrays(block, [&](ArenaLayout& c) { on_device.cut(c); });
    std::vector<std::uint64_t> memory(block.capacity() / sizeof(std::uint64_t));
    auto* const image = reinterpret_cast<std::byte*>(memory.data());
    Arrays on_host;
    ArenaLayout cutter(image);
    on_host.cut(cutter);
    write_cases(on_host);
    write_overlap(on_host, on_device);
    auto* const copy = reinterpret_cast<std::byte*>(on_device.start);  // the first array, so the start of the block
    CRUMPLE_CUDA(cudaMemcpyAsync(copy, image, block.capacity(), cudaMemcpyHostToDevice, stream));
    decide_on_device(geometry, stream, on_device);
    CRUMPLE_CUDA(cudaMemcpyAsync(image, copy, block.capacity(), cudaMemcpyDeviceToHost, stream));
    CRUMPLE_CUDA(cudaStreamSynchronize(stream));

    std::string found = difference(on_host, on_host.all, IntersectionKind::all);
    if (found.empty()) found = difference(on_host, on_host.proper, IntersectionKind::proper);
    if (found.empty()) found = difference(on_host, on_host.contacts);
    if (found.empty()) found = crossing_difference(on_host);
    if (found.empty()) found = feature_difference<ProximityDecision>(on_host, 0);
    if (found.empty()) found = feature_difference<ImpactDecision>(on_host, 1);
    if (found.empty()) found = feature_difference<MinDistanceDecision>(on_host, 2);
    return found;
}

namespace {

/// Result of find_difference_from_host() by index of the device; empty if no result differs.
std::mutex differences_mutex;
std::map<int, std::string> differences;

}  // namespace

void check_comparison_cases(const Device& device, cudaStream_t stream) {
    const Device::Current current(device);
    const std::lock_guard lock(differences_mutex);
    auto known = differences.find(device.index());
    if (known == differences.end())
        known = differences.emplace(device.index(), find_difference_from_host(device, stream)).first;
    if (!known->second.empty())
        throw Error(ErrorCode::backend_unavailable,
                    "the cuda backend is not available: device " + std::to_string(device.index()) +
                        ", its driver or the compiler of its code computes wrong results (" + known->second + ")",
                    Element::option);
}

void reset_comparison_cases() {
    const std::lock_guard lock(differences_mutex);
    differences.clear();
}

}  // namespace crumple::cuda
