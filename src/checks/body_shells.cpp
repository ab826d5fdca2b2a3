#include "checks/body_shells.h"

#include <type_traits>

namespace crumple::checks {

std::vector<ShellMesh> split_into_shells(const io::TriangleMesh& mesh, std::span<const std::int32_t> labels,
                                         std::int32_t count) {
    std::vector<ShellMesh> shells(static_cast<std::size_t>(count));
    std::visit(
        [&](const auto& xyz) {
            using Coordinates = std::remove_cvref_t<decltype(xyz)>;
            for (ShellMesh& shell : shells) {
                shell.mesh.vertices = Coordinates();
                shell.mesh.unit = mesh.unit;
            }
            std::vector<std::int32_t> index(xyz.size() / 3, -1);  // within its shell; no vertex belongs to two shells
            for (std::size_t t = 0; t < labels.size(); ++t) {
                ShellMesh& shell = shells[static_cast<std::size_t>(labels[t])];
                auto& to = std::get<Coordinates>(shell.mesh.vertices);
                shell.triangles.push_back(static_cast<std::int32_t>(t));
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto vertex = static_cast<std::size_t>(mesh.triangles[3 * t + k]);
                    if (index[vertex] < 0) {
                        index[vertex] = static_cast<std::int32_t>(to.size() / 3);
                        to.insert(to.end(), &xyz[3 * vertex], &xyz[3 * vertex] + 3);
                    }
                    shell.mesh.triangles.push_back(index[vertex]);
                }
            }
        },
        mesh.vertices);
    return shells;
}

}  // namespace crumple::checks
