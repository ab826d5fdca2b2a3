// Fuzz target: overlaps of closed bodies, and intersections with containment. Broken promises besides what the
// sanitizers find: a result of the cpu backend that differs in a byte from brute force in rational arithmetic, or an
// error that the other backend does not report; overlaps from parts that differ from those of the whole.

#include <sanitizer/asan_interface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "crumple/crumple.h"
#include "fuzz/decode.h"
#include "fuzz/fail.h"
#include "fuzz/instruction_sets.h"
#include "fuzz/print.h"
#include "fuzz/same.h"
#include "overlaps/closed_bodies.h"

namespace crumple::fuzz {
namespace {

/// Up to three bodies, and a query.
struct Bodies {
    Options options;
    OverlapQuery query;
    std::vector<Mesh> meshes;
    std::vector<Pose> poses;

    explicit Bodies(Bytes bytes) {
        options = fuzz::options(bytes);
        const int flags = bytes.next();
        query.gradient = flags & 1;
        query.windings = flags & 2;
        query.self_overlaps = flags & 4;
        query.weld = flags & 8;
        query.open = flags & 16 ? OpenSurfaces::skip : OpenSurfaces::error;
        query.curves = flags & 128;
        if (query.curves && flags & 16 && bytes.flag()) query.open = OpenSurfaces::curves;
        constexpr Output outputs[] = {Output::pairs, Output::pairs, Output::body_pairs, Output::any};
        query.output = outputs[flags >> 5 & 3];
        constexpr double volumes[] = {0, 0, 0, 0x1p-10, 1, 1e300};
        query.min_volume = bytes.one_of(volumes);
        constexpr double scales[] = {0.0, 2.0, 1.0 / 3, -1e-3};
        Kind kind;
        kind.most = 3;
        kind.wild = bytes.next() % 8 == 7;
        const int count = 1 + bytes.below(3);
        for (int b = 0; b < count; ++b) {
            kind.single[0] = bytes.flag();
            meshes.push_back(mesh(bytes, kind, 0));
            close(bytes, meshes.back());
            Pose& pose = poses.emplace_back();
            const int how = bytes.next();
            if (how & 1)
                for (std::size_t i = 3; i < 12; i += 4) pose.rows[i] = bytes.below(8) - 4;
            if (how & 2) pose.rows[0] = -1;
            if (how & 4) pose.rows[5] = bytes.one_of(scales);
        }
        if (query.output == Output::pairs) add_parts(bytes, kind.wild);
    }

   private:
    /// Requests further numbers. Those that take long are left out for bodies with many triangles or wild numbers, so
    /// that an input takes less than a second.
    void add_parts(Bytes& bytes, bool wild) {
        const int parts = bytes.next();
        std::size_t triangles = 0;
        for (const Mesh& mesh : meshes) triangles += mesh.triangles.size();
        if ((wild || are_wide()) && triangles > 8) return;
        query.regions = parts & 1;
        query.extents = parts & 2;
        query.depths = parts & 4;
        query.translation = parts & 8;
        query.solids = parts & 16;
        query.unions = parts & 32;
        constexpr double tolerances[] = {0.25, 0.0625, 0.015625};
        if (parts & 64) query.depth_tolerance = bytes.one_of(tolerances) * largest_coordinate();
        if (!(query.depth_tolerance > 0 && std::isfinite(query.depth_tolerance))) query.depth_tolerance = 0;
        if (!(parts & 128)) return;
        for (int count = 1 + bytes.below(2); count > 0; --count) {
            std::array<double, 3> direction{};
            const bool any = bytes.flag();
            for (double& x : direction) x = any ? hostile_number(bytes, wild) : bytes.below(5) - 2;
            if (direction == std::array<double, 3>{} || !is_finite(direction)) direction = {0, 0, 1};
            query.directions.push_back(direction);
        }
        query.first_free = bytes.flag() && triangles <= 20;
        if (query.first_free) query.directions.resize(1);
    }

    /// True if integers that are multiples of all coordinates have hundreds of bits.
    bool are_wide() const {
        int low = 1100, high = -1100;
        for (const Mesh& mesh : meshes)
            for (const auto& p : mesh.vertices)
                for (const double x : p)
                    if (x != 0 && std::isfinite(x))
                        low = std::min(low, std::ilogb(x)), high = std::max(high, std::ilogb(x));
        return high - low > 100;
    }

    static bool is_finite(const std::array<double, 3>& v) {
        return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
    }

    /// Returns the largest magnitude of the coordinates that are finite, before poses.
    double largest_coordinate() const {
        double largest = 0;
        for (const Mesh& mesh : meshes)
            for (const auto& p : mesh.vertices)
                for (const double x : p)
                    if (std::isfinite(x)) largest = std::max(largest, std::abs(x));
        return largest;
    }

    /// Replaces each triangle by a tetrahedron or by two triangles back to back; rarely leaves it as it is, so that the
    /// surface is open.
    static void close(Bytes& bytes, Mesh& mesh) {
        const auto open = std::move(mesh.triangles);
        mesh.triangles.clear();
        for (const auto& [a, b, c] : open) {
            mesh.triangles.push_back({a, b, c});
            const int how = bytes.next();
            if (how == 255) continue;
            if (how < 64) {
                mesh.triangles.push_back({a, c, b});
                continue;
            }
            const std::int64_t d = how % static_cast<int>(mesh.vertices.size());
            for (const auto& triangle : {std::array{b, a, d}, std::array{c, b, d}, std::array{a, c, d}})
                mesh.triangles.push_back(triangle);
        }
    }
};

/// Compares the detector with the reference. Returns the result unless one of them reports an error.
template <class Query>
std::optional<typename Query::Result> judge(const World& world, const Query& query, Detector& detector,
                                            Detector& reference) {
    using Result = typename Query::Result;
    const auto run = [&](Detector& by) {
        return outcome_of<Result>([&]() -> const Result& { return by.find(world, query); });
    };
    const Outcome<Result> found = run(detector), expected = run(reference);
    const auto *error = std::get_if<Error>(&found), *expected_error = std::get_if<Error>(&expected);
    // A backend may skip a body that cannot collide with any other, and then misses its error (docs/worlds.md).
    if (error && !expected_error && error->code != ErrorCode::not_finite)
        fail(std::string("find throws: ") + error->what());
    if (expected_error && !error && expected_error->code != ErrorCode::not_finite)
        fail(std::string("find does not throw: ") + expected_error->what());
    if (error || expected_error) return std::nullopt;
    const std::string different = test::difference(std::get<Result>(found), std::get<Result>(expected));
    if (!different.empty()) fail(different + " differs");
    return std::get<Result>(found);
}

/// Requires overlaps from parts of one or two meshes to be those of the whole.
void judge_parts(const Scene& scene, const OverlapQuery& query, Detector& detector) {
    const auto whole = outcome_of<Overlaps>([&]() -> const Overlaps& { return detector.find(scene, query); });
    const auto joined = outcome_of<Overlaps>([&]() -> const Overlaps& {
        std::vector<Overlaps> found;
        for (const Part& part : detector.partition(scene, query, 3)) {
            detector.find(part, query);
            found.push_back(detector.take_result<Overlaps>());
        }
        return detector.combine(scene, query, found);
    });
    const auto *error = std::get_if<Error>(&joined), *expected = std::get_if<Error>(&whole);
    if (error && !expected) fail(std::string("combine throws: ") + error->what());
    if (expected && !error) fail(std::string("combine does not throw: ") + expected->what());
    if (error || expected) return;
    const std::string different = test::difference(std::get<Overlaps>(joined), std::get<Overlaps>(whole));
    if (!different.empty()) fail(different + " of parts differs");
}

void judge(const Bodies& bodies, Detector& reference) {
    std::vector<Arrays> arrays;
    std::vector<Shape> shapes;
    std::vector<Body> all;
    arrays.reserve(bodies.meshes.size());
    for (const Mesh& mesh : bodies.meshes) {
        arrays.emplace_back(mesh);
        shapes.emplace_back(arrays.back().view());
        all.push_back({.shape = static_cast<std::int32_t>(all.size())});
    }
    const World world{shapes, all, bodies.poses};
    Detector detector(bodies.options);
    if (const auto overlaps = judge(world, bodies.query, detector, reference); overlaps && bodies.query.curves)
        for (std::size_t i = 0; i < overlaps->volume.size(); ++i)
            for (std::int64_t j = overlaps->curve_offsets[i]; j < overlaps->curve_offsets[i + 1]; ++j)
                if (overlaps->curve_closed[j] == 0 && overlaps->relation[i] != OverlapRelation::undefined)
                    fail("a curve of closed surfaces is open");
    const MeshView first(shapes[0].vertices, shapes[0].triangles);
    if (all.size() == 1) judge_parts(first, bodies.query, detector);
    if (all.size() == 2)
        judge_parts({first, MeshView(shapes[1].vertices, shapes[1].triangles)}, bodies.query, detector);
    IntersectionQuery inside{.weld = bodies.query.weld, .containment = true};
    if (bodies.query.open == OpenSurfaces::skip) inside.open = OpenSurfaces::skip;
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs}) {
        inside.output = output;
        judge(world, inside, detector, reference);
    }
}

/// Bodies under test. print_input() prints them when a sanitizer report or a broken promise ends the process.
const Bodies* running = nullptr;

/// Returns a number in hexadecimal, which reads back exactly.
std::string exact_text(double x) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%a", x);
    return text.data();
}

void print_input() {
    if (!running) return;
    const OverlapQuery& query = running->query;
    std::string code = as_code(running->options) + "output " + std::to_string(static_cast<int>(query.output)) +
                       ", min_volume " + std::to_string(query.min_volume) + ", open " +
                       std::to_string(static_cast<int>(query.open)) + ", weld " + std::to_string(query.weld) +
                       ", self_overlaps " + std::to_string(query.self_overlaps) + ", gradient " +
                       std::to_string(query.gradient) + ", curves " + std::to_string(query.curves) + ", windings " +
                       std::to_string(query.windings) + ", regions " + std::to_string(query.regions) + ", extents " +
                       std::to_string(query.extents) + ", depths " + std::to_string(query.depths) + ", translation " +
                       std::to_string(query.translation) + ", solids " + std::to_string(query.solids) + ", unions " +
                       std::to_string(query.unions) + ", first_free " + std::to_string(query.first_free) +
                       ", depth_tolerance " + exact_text(query.depth_tolerance) + "\n";
    for (const auto& [x, y, z] : query.directions)
        code += "direction " + exact_text(x) + " " + exact_text(y) + " " + exact_text(z) + "\n";
    for (std::size_t b = 0; b < running->meshes.size(); ++b) {
        code += as_code(running->meshes[b], std::to_string(b));
        for (const double x : running->poses[b].rows) code += " " + std::to_string(x);
        code += "\n";
    }
    std::fprintf(stderr, "\n%s\n", code.c_str());
    running = nullptr;
}

}  // namespace
}  // namespace crumple::fuzz

// Called by UndefinedBehaviorSanitizer before it ends the process.
extern "C" __attribute__((visibility("default"))) void __ubsan_on_report() { crumple::fuzz::print_input(); }

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    crumple::fuzz::on_failure = crumple::fuzz::print_input;
    __asan_set_error_report_callback([](const char*) { crumple::fuzz::print_input(); });
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace crumple;
    using namespace crumple::fuzz;
    Bodies bodies{Bytes({data, size})};
    bodies.options.simd = present(bodies.options.simd);
    static Detector reference(Options{.backend = Backend::reference});
    running = &bodies;
    try {
        judge(bodies, reference);
    } catch (const std::exception& error) {
        fail(std::string("an exception: ") + error.what());
    }
    running = nullptr;
    return 0;
}
