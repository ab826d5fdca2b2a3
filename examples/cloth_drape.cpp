// A simulation loop that calls the detector at every frame, warm: cloth falls on a ball and folds.
//
//   example_cloth_drape [cells [frames [drape.glb]]]
//
// Prints, frame by frame, how many pairs of the cloth's triangles collide and how long the detector took, and writes an
// animation with them in colour if it is given a name. The cloth solver is that of scenes/; how it finds contacts, also
// by Crumple, is in scenes/simulation/self_contact.cpp.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include "crumple/crumple.h"
#include "crumple/io.h"
#include "scenes/simulation/cloth_solver.h"

using namespace crumple;

namespace {

constexpr double frame_time = 1.0 / 30;
constexpr double width = 4;  // of the square sheet; the ball has the radius 1

scenes::ClothSolver hang(const scenes::Fabric& fabric) {
    scenes::ClothProperties properties;
    properties.shear_speed = 6;
    properties.bend_speed = 2;
    properties.thickness = properties.clearance = 0.4 * fabric.spacing;
    properties.separation_speed = 0.3;
    scenes::ClothSolver solver(fabric, properties);
    for (std::size_t i = 0; i < solver.points.size(); ++i) {
        solver.points[i] = {fabric.flat[i][0], fabric.flat[i][1], 2.1};
    }
    return solver;
}

/// The solver's own arrays, where they lie: nothing is copied, and nothing is registered with the detector.
MeshView view_of(const scenes::ClothSolver& solver, const scenes::Fabric& fabric) {
    return {&solver.points[0].x, static_cast<std::int64_t>(solver.points.size()), fabric.triangles[0].data(),
            static_cast<std::int64_t>(fabric.triangles.size())};
}

/// A copy, for the animation.
io::TriangleMesh mesh_of(const scenes::ClothSolver& solver, const scenes::Fabric& fabric) {
    std::vector<double> xyz;
    for (const auto& p : solver.points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
    std::vector<std::int32_t> corners;
    for (const auto& t : fabric.triangles) corners.insert(corners.end(), t.begin(), t.end());
    return {xyz, corners, {}};
}

void run(int cells, int frames, const std::string& output) {
    scenes::Random random(1);
    const scenes::Fabric fabric = scenes::weave(cells, cells, width / cells, random);
    scenes::ClothSolver solver = hang(fabric);

    scenes::Ball ball;
    ball.centre = {0, 0, 1};
    scenes::Floor floor(0);
    const std::array<const scenes::Collider*, 2> bodies{&ball, &floor};

    // One detector for the whole simulation. It keeps its buffers and its cluster centres from call to call, so after
    // the first frame it allocates next to nothing and starts from the last frame's clusters.
    Detector detector;
    std::optional<io::ColouredAnimation> animation;
    if (!output.empty()) animation.emplace(1 / frame_time);

    std::printf("frame  pairs  colliding triangles       ms\n");
    for (int frame = 1; frame <= frames; ++frame) {
        solver.advance((frame - 1) * frame_time, frame_time, 30, 10, bodies, [&](double time) {
            ball.spin = {0, 0, time < 1.5 ? 0.0 : 3.0};
        });

        // The answer belongs to the detector and is good until its next call.
        const Collisions& found = detector.find_self(view_of(solver, fabric));
        std::int64_t colliding = 0;
        for (const std::uint8_t hit : found.hit) colliding += hit;
        std::printf("%5d  %5zu  %19lld  %7.2f\n", frame, found.pairs.size(), static_cast<long long>(colliding),
                    found.statistics.milliseconds);

        if (animation) animation->add(mesh_of(solver, fabric), nullptr, found);
    }
    if (animation) animation->write(output);
}

}  // namespace

int main(int argc, char** argv) {
    const int cells = argc > 1 ? std::atoi(argv[1]) : 80, frames = argc > 2 ? std::atoi(argv[2]) : 90;
    if (cells < 2 || cells > 2000 || frames < 1) {
        std::fprintf(stderr, "usage: %s [cells [frames [drape.glb]]]\n", argv[0]);
        return 2;
    }
    try {
        run(cells, frames, argc > 3 ? argv[3] : "");
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
