// Fuzz target: features that touch in motion or are near, in one mesh and between two bodies that have this mesh as
// their shape. Broken promises besides what the sanitizers find: a result of the cpu backend that differs in a byte
// from brute force in rational arithmetic, an error that the other backend does not report, a free step that is not
// free.

#include <sanitizer/asan_interface.h>

#include <cmath>
#include <string>
#include <vector>

#include "crumple/crumple.h"
#include "fuzz/decode.h"
#include "fuzz/fail.h"
#include "fuzz/instruction_sets.h"
#include "fuzz/print.h"
#include "fuzz/same.h"

namespace crumple::fuzz {
namespace {

/// A moving mesh, poses of two bodies with this mesh as their shape, and queries.
struct Motion {
    Options options;
    ImpactQuery impacts;
    ProximityQuery proximities;
    Held held = Held::worlds;
    Mesh mesh;
    Mesh end;
    std::vector<Pose> poses, end_poses;
    bool shared = false;  ///< true: the second body is in all worlds

    explicit Motion(Bytes bytes) {
        options = fuzz::options(bytes);
        constexpr double distances[] = {0, 0, 0, 0.5, 1, 1e-3, 0x1p-52, 3};
        constexpr double shares[] = {0, 0, 0, 0.2, 0.5, 0.99};
        constexpr Output impact_outputs[] = {Output::pairs, Output::pairs, Output::first, Output::any};
        constexpr Output near_outputs[] = {Output::pairs, Output::pairs, Output::any};
        const int how = bytes.next(), more = bytes.next();
        impacts.output = impact_outputs[how & 3];
        impacts.approaching_only = how & 4;
        impacts.triangle_pairs = how & 8;
        impacts.weld = proximities.weld = how & 16;
        impacts.index = proximities.index = how & 32;
        impacts.min_distance = bytes.one_of(distances);
        impacts.min_distance_share = bytes.one_of(shares);
        held = static_cast<Held>((how >> 6) % 3);
        proximities.output = bytes.one_of(near_outputs);
        proximities.radius = bytes.one_of(distances);
        proximities.strict = more & 1;
        proximities.closest = more & 2;
        proximities.least = more & 4;
        proximities.rings = more >> 3 & 3;
        shared = more & 32;
        Kind kind;
        kind.most = 3;
        kind.single[0] = more & 64;
        kind.wild = bytes.next() % 8 == 7;
        kind.groups[0] = more & 128 ? 2 : 0;
        if (more & 128) impacts.filter.groups = proximities.filter.groups = static_cast<PairScope>(bytes.below(3));
        mesh = fuzz::mesh(bytes, kind, 0);
        end = mesh;
        move(bytes, kind.wild);
        for (std::vector<Pose>* some : {&poses, &end_poses})
            for (int b = 0; b < 2; ++b) {
                Pose& pose = some->emplace_back();
                for (std::size_t i = 3; i < 12; i += 4) pose.rows[i] = bytes.below(5) - 2;
            }
    }

   private:
    /// Moves vertices by a common step or each by its own, or leaves them where they are.
    void move(Bytes& bytes, bool wild) {
        std::array<double, 3> step{};
        for (double& x : step) x = bytes.below(5) - 2;
        for (auto& vertex : end.vertices) {
            const auto start = vertex;
            const int kind = bytes.below(6);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (kind == 1 || kind == 2) vertex[axis] += step[axis];
                if (kind == 3) vertex[axis] += bytes.below(7) - 3;
                if (kind == 4) vertex[axis] = hostile_number(bytes, wild);
            }
            if (kind == 2) vertex[static_cast<std::size_t>(bytes.below(3))] -= 1;
            if (kind == 5) vertex = mesh.vertices[static_cast<std::size_t>(bytes.next()) % mesh.vertices.size()];
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (!std::isfinite(mesh.single ? static_cast<float>(vertex[axis]) : vertex[axis])) vertex = start;
        }
    }
};

template <class List>
void require_same_list(const List& found, const List& expected, const std::string& what) {
    require_same_bytes(found.pairs, expected.pairs, what + " pairs");
    require_same_bytes(found.bodies, expected.bodies, what + " bodies");
    require_same_bytes(found.offsets, expected.offsets, what + " offsets");
    require_same_bytes(found.second_offsets, expected.second_offsets, what + " second offsets");
    require_same_bytes(found.by_second, expected.by_second, what + " positions by second feature");
    if constexpr (requires { found.toi; }) {
        require_same_bytes(found.toi, expected.toi, what + " times");
        require_same_bytes(found.start, expected.start, what + " flags of the start");
    } else {
        require_same_bytes(found.squared_distance, expected.squared_distance, what + " squared distances");
        require_same_bytes(found.touching, expected.touching, what + " flags of touching");
        require_same_bytes(found.type, expected.type, what + " types");
        require_same_bytes(found.at, expected.at, what + " parameters");
    }
}

template <class Result>
void require_same(const Result& found, const Result& expected, const std::string& what) {
    for (std::size_t kind = 0; kind < feature_kinds; ++kind)
        require_same_list(found.lists[kind], expected.lists[kind],
                          what + ' ' + std::string(feature_kind_name(static_cast<FeatureKind>(kind))));
    require_same_bytes(found.edges, expected.edges, what + " edges");
    require_same_bytes(found.world_hit, expected.world_hit, what + " flags of worlds");
    if (found.any != expected.any || found.count != expected.count) fail(what + ": any or count differ");
    if constexpr (
        requires { found.toi; } || requires { found.first; }) {
        require_same_list(found.triangle_pairs, expected.triangle_pairs, what + " triangle pairs");
        if (!(found.first == expected.first)) fail(what + ": first impacts differ");
        require(found.world_first.size() == expected.world_first.size(), "first impacts of worlds");
        for (std::size_t w = 0; w < found.world_first.size(); ++w)
            if (!(found.world_first[w] == expected.world_first[w])) fail(what + ": first impacts of worlds differ");
    } else {
        require_same_bytes(found.vertex_distance, expected.vertex_distance, what + " least distances of vertices");
        require_same_bytes(found.face_distance, expected.face_distance, what + " least distances of faces");
        require_same_bytes(found.edge_distance, expected.edge_distance, what + " least distances of edges");
    }
}

void require_same(const FirstImpact& found, const FirstImpact& expected, const std::string& what) {
    if (!(found == expected)) fail(what + " differ");
}

void require_same(const FreeStep& found, const FreeStep& expected, const std::string& what) {
    if (std::memcmp(&found.share, &expected.share, sizeof found.share) != 0) fail(what + ": shares differ");
    require_same_bytes(found.positions, expected.positions, what + " positions");
    require_same_bytes(found.vertex_shares, expected.vertex_shares, what + " shares of vertices");
    require_same_bytes(found.body_shares, expected.body_shares, what + " shares of bodies");
    require_same(found.first, expected.first, what + ": first impacts");
    if (found.intersects != expected.intersects || !(found.intersecting == expected.intersecting))
        fail(what + ": triangles that intersect at the start differ");
}

void require_same(const Distances& found, const Distances& expected, const std::string& what) {
    require_same_bytes(found.bodies, expected.bodies, what + " bodies");
    require_same_bytes(found.squared_distance, expected.squared_distance, what + " squared distances");
    require_same_bytes(found.touching, expected.touching, what + " flags of touching");
    require_same_bytes(found.triangles, expected.triangles, what + " triangles");
    require_same_bytes(found.points, expected.points, what + " points");
    require_same_bytes(found.world_rows, expected.world_rows, what + " rows of worlds");
}

/// Runs a query on both backends. Returns the result of the reference, or nothing if it is an error.
template <class Query>
std::optional<typename Query::Result> judge(const Scene& scene, const Query& query, Detector& detector,
                                            Detector& reference, const char* what) {
    using Result = typename Query::Result;
    const auto run = [&](Detector& by) {
        return outcome_of<Result>([&]() -> Result { return by.find(scene, query); });
    };
    const Outcome<Result> found = run(detector), expected = run(reference);
    compare(found, expected, what,
            [](const Result& f, const Result& e, const std::string& w) { require_same(f, e, w); });
    if (std::holds_alternative<Error>(expected)) return std::nullopt;
    if constexpr (std::same_as<Query, ImpactQuery> || std::same_as<Query, ProximityQuery>)
        if (detector.any(scene, query) != std::get<Result>(expected).any) fail(std::string(what) + ": any differs");
    return std::get<Result>(expected);
}

/// Requires that nothing touches during the motion from the start to the positions that the free step has found.
void require_free(const Motion& motion, const MeshView& view, const FreeStep& step, Detector& reference) {
    Mesh reached = motion.mesh;
    for (std::size_t v = 0; v < reached.vertices.size(); ++v)
        for (std::size_t axis = 0; axis < 3; ++axis) reached.vertices[v][axis] = step.positions[3 * v + axis];
    const Arrays arrays(reached);
    MeshView moving = view;
    moving.end = arrays.view().vertices;
    ImpactQuery query = motion.impacts;
    query.output = Output::any;
    query.index = query.triangle_pairs = false;  // triangles that intersect at the start do not end a step
    if (reference.any(moving, query)) fail("a free step is not free");
}

void judge(const Motion& motion, Detector& reference) {
    const Arrays start(motion.mesh), end(motion.end);
    MeshView moving = start.view();
    moving.end = end.view().vertices;
    Detector detector(motion.options);
    judge(moving, motion.impacts, detector, reference, "impacts");
    judge(moving, FirstImpactQuery{motion.impacts}, detector, reference, "first impact");
    const FreeStepQuery free{motion.impacts, motion.held};
    if (const auto step = judge(moving, free, detector, reference, "free step"); step && step->share > 0)
        require_free(motion, moving, *step, reference);
    judge(start.view(), motion.proximities, detector, reference, "proximities");

    const std::vector<Shape> shapes{Shape(start.view(), 1)};
    const std::vector<Body> bodies{{.world = 0}, {.world = motion.shared ? -1 : 0}};
    const World world{shapes, bodies, motion.poses, motion.end_poses};
    ImpactQuery impacts = motion.impacts;
    ProximityQuery proximities = motion.proximities;
    impacts.index = proximities.index = proximities.least = false;
    judge(world, impacts, detector, reference, "impacts of bodies");
    const World posed{shapes, bodies, motion.poses};
    judge(posed, proximities, detector, reference, "proximities of bodies");
    for (const Output output : {Output::pairs, Output::nearest})
        judge(posed, DistanceQuery{.output = output}, detector, reference, "distances of bodies");
    impacts.output = proximities.output = Output::any_by_world;
    judge(world, impacts, detector, reference, "impacts by world");
    judge(posed, proximities, detector, reference, "proximities by world");
}

/// Input under test. print_running() prints it when a sanitizer report or a broken promise ends the process.
const Motion* running = nullptr;

void print_running() {
    if (!running) return;
    const ImpactQuery& impacts = running->impacts;
    const ProximityQuery& near = running->proximities;
    std::string code = as_code(running->options);
    const auto add = [&](const char* name, double value) {
        code += std::string(name) + ' ' + std::to_string(value) + ", ";
    };
    add("output", static_cast<int>(impacts.output));
    add("min_distance", impacts.min_distance);
    add("min_distance_share", impacts.min_distance_share);
    add("approaching_only", impacts.approaching_only);
    add("triangle_pairs", impacts.triangle_pairs);
    add("weld", impacts.weld);
    add("index", impacts.index);
    add("groups", static_cast<int>(impacts.filter.groups));
    add("held", static_cast<int>(running->held));
    add("radius", near.radius);
    add("output", static_cast<int>(near.output));
    add("strict", near.strict);
    add("closest", near.closest);
    add("least", near.least);
    add("rings", near.rings);
    add("shared", running->shared);
    code += "\n" + as_code(running->mesh, "") + as_code(running->end, "_end");
    for (const std::vector<Pose>* some : {&running->poses, &running->end_poses})
        for (const Pose& pose : *some)
            for (const double x : pose.rows) code += " " + std::to_string(x);
    std::fprintf(stderr, "\n%s\n", code.c_str());
    running = nullptr;
}

}  // namespace
}  // namespace crumple::fuzz

// Called by UndefinedBehaviorSanitizer before it ends the process.
extern "C" __attribute__((visibility("default"))) void __ubsan_on_report() { crumple::fuzz::print_running(); }

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    crumple::fuzz::on_failure = crumple::fuzz::print_running;
    __asan_set_error_report_callback([](const char*) { crumple::fuzz::print_running(); });
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace crumple;
    using namespace crumple::fuzz;
    Motion motion{Bytes({data, size})};
    motion.options.simd = present(motion.options.simd);
    static Detector reference(Options{.backend = Backend::reference});
    running = &motion;
    try {
        judge(motion, reference);
    } catch (const std::exception& error) {
        fail(std::string("an exception: ") + error.what());
    }
    running = nullptr;
    return 0;
}
