#pragma once

// Functions that make or simulate the scenes. scenes.cpp lists them. Each is in a source file of its own, or in one
// with similar scenes.

#include <memory>

#include "scenes/scenes.h"
#include "scenes/simulation/simulation.h"

namespace crumple::scenes {

io::TriangleMesh make_cloth(const Parameters& parameters);
io::TriangleMesh make_ground(const Parameters& parameters);
io::TriangleMesh make_soup(const Parameters& parameters);
io::TriangleMesh make_needles(const Parameters& parameters);
io::TriangleMesh make_five_decades(const Parameters& parameters);
io::TriangleMesh make_bodies(const Parameters& parameters);
io::TriangleMesh make_knots(const Parameters& parameters);
io::TriangleMesh make_model(const Parameters& parameters);
io::TriangleMesh make_shells(const Parameters& parameters);
io::TriangleMesh make_fans(const Parameters& parameters);
io::TriangleMesh make_lattice(const Parameters& parameters);

std::unique_ptr<Simulation> simulate_cloth_on_ball(const Parameters& parameters);
std::unique_ptr<Simulation> simulate_funnel(const Parameters& parameters);
std::unique_ptr<Simulation> simulate_cutting(const Parameters& parameters);

}  // namespace crumple::scenes
