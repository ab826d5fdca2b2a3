#pragma once

// Check of bodies that were read from files: each body's surface, where it passes through itself, how its shells lie to
// each other, and how bodies lie to each other.

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "checks/body_shells.h"
#include "checks/boundary_loops.h"
#include "checks/check_items.h"
#include "crumple/detector.h"
#include "io/scenes/body_origins.h"

namespace crumple::checks {

struct CheckInput {
    const io::WorldMesh& world;
    const io::BodyOrigins& origins;
    std::vector<BodyPair> excluded = {};  ///< pairs of bodies that are not checked; (a, a): body a with itself
};

struct CheckOptions {
    double ignore_below = 0;          ///< overlaps that are nowhere deeper are not findings; in the scene's unit
    std::optional<double> clearance;  ///< pairs of bodies whose distance is less are findings; in the scene's unit
};

/// Body under its pose.
struct CheckedBody {
    io::TriangleMesh mesh;
    BodyReport report;
    std::vector<BoundaryLoop> loops;
    std::int32_t first_shell, shells;           ///< its shells in CheckReport::shells
    std::optional<double> overlap_with_itself;  ///< volume that it covers twice; none if it is not closed
};

struct CheckedShell {
    BodyPart part;
    const io::TriangleMesh* mesh;              ///< its body's mesh, if it is the only shell
    std::vector<std::int32_t> triangles = {};  ///< index in the body of each triangle; empty if it is the only shell
    std::optional<double> volume = {};         ///< none if the shell is not closed; negative if it faces inwards
    std::optional<double> overlap_with_itself = {};
    std::vector<std::int32_t> inside = {};  ///< numbers of the body's shells in which it lies
    int winding_around = 0;                 ///< winding number around it of the shells in which it lies
    bool is_cavity = false;                 ///< true if it faces inwards where that winding number is 1

    /// True if it faces outwards within other shells that do, so that its inside counts twice.
    bool covers_twice() const { return volume && *volume > 0 && winding_around > 0; }
    std::int32_t triangle_in_body(std::int32_t triangle) const {
        return triangles.empty() ? triangle : triangles[static_cast<std::size_t>(triangle)];
    }
};

struct CheckReport {
    std::vector<std::string> names;  ///< names of the bodies
    std::string files;
    io::Unit unit = io::Unit::unknown;
    std::vector<CheckedBody> bodies;
    std::vector<ShellMesh> shell_meshes;  ///< shells of bodies that have several
    std::vector<CheckedShell> shells;
    Intersections crossings;       ///< pairs of triangles of shells, with contacts
    std::vector<CheckItem> items;  ///< first those of one body, in the order of bodies

    std::int64_t count_findings() const;
    /// Returns shell s of a body, from 0 to its number of shells.
    const CheckedShell& shell_of(const CheckedBody& body, std::int32_t s) const {
        return shells[static_cast<std::size_t>(body.first_shell) + static_cast<std::size_t>(s)];
    }
};

/// Checks all bodies. Bodies and shells that are not closed have no volumes and no relations: if their surfaces meet
/// others, the relation is `undefined`. Throws Error that names the body that it concerns, or else all files.
CheckReport check_bodies(Detector& detector, const CheckInput& input, const CheckOptions& options,
                         std::stop_token stop = {});

}  // namespace crumple::checks
