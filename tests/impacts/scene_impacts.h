#pragma once

// Impacts between frames of real scenes, of external origin, with the moves that lead to them.

#include <cstdint>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "crumple/io.h"
#include "impacts/moves.h"
#include "io/files.h"

namespace crumple {

/// Step of a scene: names of its files, and number of impacts.
struct SceneStep {
    std::string result_file, start, end;
    std::size_t impacts;
    friend std::ostream& operator<<(std::ostream& out, const SceneStep& step) { return out << step.result_file; }
};

inline const std::array<SceneStep, 3> scene_steps{
    {{"motion_cloth-funnel_227_228.txt", "cloth-funnel/frames/227.ply", "cloth-funnel/frames/228.ply", 134},
     {"motion_cloth-ball_92_93.txt", "cloth-ball/frames/cloth_ball92.ply", "cloth-ball/frames/cloth_ball93.ply",
      113'854},
     {"motion_n-body_18_19.txt", "n-body-simulation/frames/balls16_18.ply", "n-body-simulation/frames/balls16_19.ply",
      50'490}}};

/// Returns the name of a step for names of tests.
inline std::string name_of(const SceneStep& step) {
    std::string name = step.result_file.substr(0, step.result_file.find('.'));
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
}

/// Vertices of the two frames at the start and the end of a step, and their common faces.
class Frames {
   public:
    Frames(const std::filesystem::path& start, const std::filesystem::path& end)
        : start_(read(start)), end_(read(end)) {
        if (start_.triangles != end_.triangles) throw std::runtime_error("frames of different meshes");
    }

    MovingPoint vertex(std::int32_t i) const { return {position(start_, i), position(end_, i)}; }
    MovingPoint corner(std::int32_t face, std::size_t i) const {
        return vertex(start_.triangles.at(3 * static_cast<std::size_t>(face) + i));
    }

   private:
    static io::TriangleMesh read(const std::filesystem::path& path) {
        return io::read_mesh(path, {.precision = io::Precision::float64});
    }
    static Vec3d position(const io::TriangleMesh& mesh, std::int32_t vertex) {
        const auto at = 3 * static_cast<std::size_t>(vertex);
        const auto& xyz = std::get<std::vector<double>>(mesh.vertices);
        return {xyz.at(at), xyz.at(at + 1), xyz.at(at + 2)};
    }

    io::TriangleMesh start_, end_;
};

struct SceneImpact {
    Move move;
    Impact impact;
};

/// Returns the impacts in the order of the file, or nothing without the data.
inline std::optional<std::vector<SceneImpact>> read_impacts(const SceneStep& step) {
    const auto folder = io::test::data_folder();
    if (!folder || !std::filesystem::exists(*folder / "gt-motion" / step.result_file)) return {};
    const Frames frames(*folder / "scalable-ccd" / step.start, *folder / "scalable-ccd" / step.end);
    std::ifstream file(*folder / "gt-motion" / step.result_file);
    std::vector<SceneImpact> impacts;
    for (std::string kind; file >> kind;) {
        std::array<std::int32_t, 4> id{};
        const bool face = kind == "vf";
        for (std::size_t i = 0; i < (face ? 2U : 4U); ++i) file >> id[i];
        Impact impact{true};
        file >> impact.toi >> impact.start;
        if (!file) throw std::runtime_error(step.result_file + " breaks off");
        const Move move =
            face ? Move{Feature::vertex_face,
                        {frames.vertex(id[0]), frames.corner(id[1], 0), frames.corner(id[1], 1),
                         frames.corner(id[1], 2)}}
                 : Move{Feature::edge_edge,
                        {frames.vertex(id[0]), frames.vertex(id[1]), frames.vertex(id[2]), frames.vertex(id[3])}};
        impacts.push_back({move, impact});
    }
    return impacts;
}

}  // namespace crumple
