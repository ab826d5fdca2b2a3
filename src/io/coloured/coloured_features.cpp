// Writes meshes as binary glTF, with the triangles of impacts or near pairs coloured by time or distance: one material
// for each eighth of the range.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/float_environment.h"
#include "crumple/io_features.h"
#include "io/bytes/atomic_file.h"
#include "io/formats.h"
#include "io/lists/feature_kinds.h"

namespace crumple::io {

namespace {

// Grey, then ColorBrewer's YlOrRd, the darkest first.
constexpr std::array<Colour, 9> shades{{free_colour,
                                        {177, 0, 38},
                                        {227, 26, 28},
                                        {252, 78, 42},
                                        {253, 141, 60},
                                        {254, 178, 76},
                                        {254, 217, 118},
                                        {255, 237, 160},
                                        {255, 255, 204}}};
constexpr double untouched = std::numeric_limits<double>::infinity();

/// Least value of each feature of one mesh, over all rows that name the feature.
class Least {
   public:
    explicit Least(const TriangleMesh& mesh)
        : mesh_(mesh),
          of_vertex_(static_cast<std::size_t>(mesh.vertex_count()), untouched),
          of_triangle_(static_cast<std::size_t>(mesh.triangle_count()), untouched) {}

    void add_vertex(std::int32_t vertex, double value) { lower(of_vertex_, vertex, value); }
    void add_face(std::int32_t triangle, double value) { lower(of_triangle_, triangle, value); }
    void add_edge(Edge edge, double value) {
        if (edge.a < 0 || edge.b >= mesh_.vertex_count()) foreign();
        double& least = of_edge_.try_emplace(edge, untouched).first->second;
        least = std::min(least, value);
    }

    /// Returns the least value of a triangle, its vertices and its edges.
    double of(std::size_t triangle) const {
        double least = of_triangle_[triangle];
        const std::int32_t* const c = &mesh_.triangles[3 * triangle];
        for (std::size_t k = 0; k < 3; ++k) {
            least = std::min(least, of_vertex_[static_cast<std::size_t>(c[k])]);
            const auto [a, b] = std::minmax(c[k], c[(k + 1) % 3]);
            const auto edge = of_edge_.find({a, b});
            if (edge != of_edge_.end()) least = std::min(least, edge->second);
        }
        return least;
    }

   private:
    [[noreturn]] static void foreign() {
        throw Error(ErrorCode::invalid_argument, "the result refers to features that the mesh does not have");
    }
    static void lower(std::vector<double>& values, std::int32_t index, double value) {
        if (index < 0 || static_cast<std::size_t>(index) >= values.size()) foreign();
        double& least = values[static_cast<std::size_t>(index)];
        least = std::min(least, value);
    }

    const TriangleMesh& mesh_;
    std::vector<double> of_vertex_, of_triangle_;
    std::map<Edge, double> of_edge_;
};

void add(std::vector<Least>& meshes, const FeatureRow& row, double value) {
    const auto mesh = [&](std::int32_t body) -> Least& {
        if (body < 0 || static_cast<std::size_t>(body) >= meshes.size())
            throw Error(ErrorCode::invalid_argument, "the result refers to a body for which there is no mesh");
        return meshes[static_cast<std::size_t>(body)];
    };
    Least &first = mesh(row.bodies.first), &second = mesh(row.bodies.second);
    const auto add_feature = [&](Least& least, std::size_t side, std::size_t at) {
        const Feature feature = feature_of(row.kind, side);
        if (feature == Feature::edge)
            least.add_edge({row.ids[at], row.ids[at + 1]}, value);
        else if (feature == Feature::face)
            least.add_face(row.ids[at], value);
        else
            least.add_vertex(row.ids[at], value);
    };
    add_feature(first, 0, 0);
    add_feature(second, 1, first_ids(row.kind));
}

/// Returns the shade of each triangle: 0 (grey) if no row names the triangle, one of its edges or one of its vertices;
/// else from 1 for the least values to 8 for those near `most`.
Array<std::uint8_t> shades_of(const TriangleMesh& mesh, const Least& least, double most) {
    Array<std::uint8_t> result;
    constexpr double steps = shades.size() - 1;
    for (std::size_t t = 0; t < static_cast<std::size_t>(mesh.triangle_count()); ++t) {
        const double value = least.of(t), share = most > 0 ? value / most : 0;
        result.push_back(value == untouched ? 0 : static_cast<std::uint8_t>(1 + std::min(steps - 1, steps * share)));
    }
    return result;
}

ColouredMesh coloured(const TriangleMesh& mesh, const TriangleMesh* second, const FeatureList& list, double most) {
    validate(mesh);
    std::vector<Least> least{Least(mesh)};
    if (second) {
        validate(*second);
        least.emplace_back(*second);
    }
    for (const FeatureRow& row : list.rows) add(least, row, std::min(row.value, std::numeric_limits<double>::max()));
    Intersections hits;
    hits.hit = shades_of(mesh, least[0], most);
    if (second) hits.hit_second = shades_of(*second, least[1], most);
    return coloured_mesh(mesh, second, hits);
}

ColouredMesh coloured(const TriangleMesh& start, const Impacts& impacts) {
    return coloured(start, nullptr, list_of(impacts), 1);
}

ColouredMesh coloured(const TriangleMesh& mesh, const TriangleMesh* second, const Proximities& nearby) {
    FeatureList list = list_of(nearby);
    double most = 0;
    for (FeatureRow& row : list.rows) {
        row.value = std::sqrt(row.value);
        if (std::isfinite(row.value)) most = std::max(most, row.value);
    }
    return coloured(mesh, second, list, most);
}

void write(const std::filesystem::path& path, const ColouredMesh& mesh) {
    if (extension_of(path) != ".glb")
        throw Error(ErrorCode::invalid_argument,
                    "cannot write " + path.string() + ": meshes coloured by time or distance are written as .glb");
    AtomicFile file(path);
    write_shaded_glb(file.stream(), mesh, shades);
    file.commit();
}

void write(std::ostream& out, const ColouredMesh& mesh) {
    write_shaded_glb(out, mesh, shades);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write a coloured mesh to the stream");
}

}  // namespace

void write_coloured(const std::filesystem::path& path, const TriangleMesh& start, const Impacts& impacts) {
    const FloatEnvironment environment;
    write(path, coloured(start, impacts));
}
void write_coloured(std::ostream& out, const TriangleMesh& start, const Impacts& impacts) {
    const FloatEnvironment environment;
    write(out, coloured(start, impacts));
}

void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                    const Proximities& nearby) {
    const FloatEnvironment environment;
    write(path, coloured(mesh, second, nearby));
}
void write_coloured(std::ostream& out, const TriangleMesh& mesh, const TriangleMesh* second,
                    const Proximities& nearby) {
    const FloatEnvironment environment;
    write(out, coloured(mesh, second, nearby));
}

}  // namespace crumple::io
