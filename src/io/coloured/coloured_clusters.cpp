// Meshes coloured by clusters or leaves, with sweep directions, and the arrays of a clustering.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/grouped.h"
#include "io/coloured/html_page.h"
#include "io/formats.h"
#include "io/lists/list_arrays.h"

namespace crumple::io {
namespace {

using Vector = Clustering::Vector;
constexpr int colours = 64;

/// Returns a colour whose hue differs from those of the colours before: each is 1 / golden ratio of a circle further.
Colour colour_of(int index, double brightness) {
    const double hue = 6 * std::fmod(index * 0.6180339887498949, 1.0), saturation = index % 2 == 0 ? 0.75 : 0.5;
    const auto component = [&](double centre) {
        const double d = std::abs(std::remainder(hue - centre, 6.0));
        const double share = std::clamp(2 - d, 0.0, 1.0);
        return static_cast<std::uint8_t>(std::lround(255 * brightness * (1 - saturation * (1 - share))));
    };
    return {component(0), component(2), component(4)};
}

/// Materials that triangles use, and the material of each triangle.
class Painter {
   public:
    Painter(const Clustering& clustering, ColouredBy by)
        : clustering_(clustering), by_(by), place_(2 * colours + 1, -1) {
        const std::size_t triangles = clustering.nearest_cluster.size();
        std::vector<std::int32_t> groups(triangles, 0);
        if (by == ColouredBy::clusters)
            for (std::size_t t = 0; t < triangles; ++t)
                groups[t] = static_cast<std::int32_t>(clustering.offsets[t + 1] - clustering.offsets[t]);
        else
            for (const std::int32_t t : clustering.members) ++groups[static_cast<std::size_t>(t)];
        const auto& nearest = by == ColouredBy::clusters ? clustering.nearest_cluster : clustering.nearest_leaf;
        names_.reserve(place_.size());  // materials refer to names
        for (std::size_t t = 0; t < triangles; ++t) hit.push_back(material_of(nearest[t], groups[t] > 1));
    }

    std::vector<std::uint8_t> hit;
    std::vector<Material> materials;

   private:
    std::uint8_t material_of(std::int32_t group, bool shared) {
        const int key = group < 0 ? 2 * colours : 2 * (group % colours) + shared;
        int& place = place_[static_cast<std::size_t>(key)];
        if (place < 0) {
            place = static_cast<int>(materials.size());
            names_.push_back(name_of(group, shared));
            materials.push_back(
                {names_.back().c_str(), group < 0 ? free_colour : colour_of(group % colours, shared ? 0.55 : 0.95)});
        }
        return static_cast<std::uint8_t>(place);
    }
    std::string name_of(std::int32_t group, bool shared) const {
        if (group < 0) return "left_out";
        const std::string number = std::to_string(group % colours);
        const std::string name = by_ == ColouredBy::clusters
                                     ? "cluster_" + number
                                     : (std::ssize(clustering_.leaf_cluster) > colours ? "leaves_" : "leaf_") + number;
        return shared ? name + "_and_others" : name;
    }

    const Clustering& clustering_;
    ColouredBy by_;
    std::vector<int> place_;  ///< by key of a material: its position in `materials`, or -1
    std::vector<std::string> names_;
};

Vector vertex_of(const TriangleMesh& mesh, std::int32_t index) {
    const auto at = 3 * static_cast<std::size_t>(index);
    return std::visit(
        [&](const auto& xyz) {
            return Vector{static_cast<double>(xyz[at]), static_cast<double>(xyz[at + 1]),
                          static_cast<double>(xyz[at + 2])};
        },
        mesh.vertices);
}

/// Returns a line along the sweep direction of each leaf, through the middle of its box in its frame, a tenth longer
/// than the box. Lengths are sums of products of coordinates: those of extreme coordinates may overflow, and such
/// leaves get no line.
std::vector<PagePoint> sweep_lines(const TriangleMesh& mesh, const Clustering& clustering) {
    std::vector<PagePoint> lines;
    for (std::size_t l = 0; l < clustering.axes.size(); ++l) {
        const auto& axes = clustering.axes[l];
        if (axes[0] == Vector{}) continue;
        Vector low, high;
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        for (std::int64_t m = clustering.leaf_offsets[l]; m < clustering.leaf_offsets[l + 1]; ++m)
            for (int k = 0; k < 3; ++k) {
                const std::int64_t corner = 3 * std::int64_t{clustering.members[static_cast<std::size_t>(m)]} + k;
                const Vector p = vertex_of(mesh, mesh.triangles[static_cast<std::size_t>(corner)]);
                for (std::size_t a = 0; a < 3; ++a) {
                    const double along = axes[a][0] * p[0] + axes[a][1] * p[1] + axes[a][2] * p[2];
                    low[a] = std::min(low[a], along);
                    high[a] = std::max(high[a], along);
                }
            }
        const double more = 0.05 * (high[0] - low[0]);
        PagePoint ends[2];
        bool finite = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const double middle = axes[1][i] * (low[1] + high[1]) / 2 + axes[2][i] * (low[2] + high[2]) / 2;
            ends[0][i] = middle + axes[0][i] * (low[0] - more);
            ends[1][i] = middle + axes[0][i] * (high[0] + more);
            finite = finite && std::isfinite(ends[0][i]) && std::isfinite(ends[1][i]);
        }
        if (finite) lines.insert(lines.end(), {ends[0], ends[1]});
    }
    return lines;
}

std::string caption_of(const Clustering& clustering, ColouredBy by) {
    const auto count = [](std::int64_t n, const std::string& what) {
        return grouped(n) + ' ' + what + (n == 1 ? "" : "s");
    };
    const std::string clusters = count(std::ssize(clustering.centres), "cluster"),
                      leaves = grouped(std::ssize(clustering.leaf_cluster)) +
                               (clustering.leaf_cluster.size() == 1 ? " leaf" : " leaves");
    return (by == ColouredBy::clusters ? clusters + " of " : leaves + " in " + clusters + " of ") +
           count(std::ssize(clustering.nearest_cluster), "triangle") + "; darker triangles belong to several";
}

void write_page_of(std::ostream& out, const ColouredMesh& coloured, const Clustering& clustering, ColouredBy by) {
    Page page;
    constexpr std::size_t most_named = 16;
    page.sides.push_back({&coloured.mesh,
                          coloured.hit,
                          {},
                          {},
                          coloured.materials,
                          coloured.materials.size() <= 2 * most_named ? coloured.materials.size() : 0});
    page.lines = sweep_lines(coloured.mesh, clustering);
    page.line_name = "sweep direction of a leaf";
    page.caption = caption_of(clustering, by);
    write_page(out, page, 0);
}

void check_clustering(const ColouredMesh& joined, const Clustering& clustering) {
    const auto triangles = static_cast<std::size_t>(joined.mesh.triangle_count());
    const std::size_t leaves = clustering.leaf_cluster.size();
    bool fits = clustering.nearest_cluster.size() == triangles && clustering.nearest_leaf.size() == triangles &&
                clustering.offsets.size() == triangles + 1 && clustering.leaf_offsets.size() == leaves + 1 &&
                clustering.axes.size() == leaves && clustering.leaf_offsets.front() == 0 &&
                clustering.leaf_offsets.back() == std::ssize(clustering.members) &&
                std::is_sorted(clustering.leaf_offsets.begin(), clustering.leaf_offsets.end());
    for (const std::int32_t t : clustering.members) fits = fits && t >= 0 && static_cast<std::size_t>(t) < triangles;
    if (!fits) throw Error(ErrorCode::invalid_argument, "the clustering is not that of the meshes");
}

/// Returns both meshes as one, not yet coloured.
ColouredMesh join(const TriangleMesh& mesh, const TriangleMesh* second) {
    Intersections nothing;
    nothing.hit.assign(static_cast<std::size_t>(mesh.triangle_count()), 0);
    if (second) nothing.hit_second.assign(static_cast<std::size_t>(second->triangle_count()), 0);
    return coloured_mesh(mesh, second, nothing);
}

template <class Row>
ListMember column(std::string name, NumberType type, std::size_t width, const std::vector<Row>& rows) {
    return with_rows(ListArray{std::move(name), type, width}, std::span<const Row>(rows));
}

}  // namespace

void write_coloured(const std::filesystem::path& path, const TriangleMesh& mesh, const TriangleMesh* second,
                    const Clustering& clustering, ColouredBy groups) {
    const FloatEnvironment environment;
    const MeshFormat format = mesh_format_of(extension_of(path));
    check_has_colours(path, format);
    ColouredMesh coloured = join(mesh, second);
    check_clustering(coloured, clustering);
    Painter painter(clustering, groups);
    coloured.hit = std::move(painter.hit);
    coloured.materials = painter.materials;
    if (format == MeshFormat::obj) return write_coloured_obj(path, coloured);
    AtomicFile file(path);
    if (format == MeshFormat::html)
        write_page_of(file.stream(), coloured, clustering, groups);
    else if (format == MeshFormat::ply)
        write_coloured_ply(file.stream(), coloured);
    else if (format == MeshFormat::glb)
        write_coloured_glb(file.stream(), coloured);
    else
        write_coloured_3mf(file.stream(), coloured);
    file.commit();
}

void write_clustering(const std::filesystem::path& path, const Clustering& c) {
    const FloatEnvironment environment;
    const std::string extension = extension_of(path);
    if (extension != ".json" && extension != ".npz")
        throw Error(ErrorCode::invalid_argument,
                    "cannot write " + path.string() + ": the arrays of a clustering are written as .json or .npz");
    const std::uint8_t complete = c.complete;
    ListMember is_complete{{"complete", NumberType::uint8}, &complete, 1};
    const std::vector<ListMember> members{column("centres", NumberType::float64, 3, c.centres),
                                          column("offsets", NumberType::int64, 1, c.offsets),
                                          column("clusters", NumberType::int32, 1, c.clusters),
                                          column("nearest_cluster", NumberType::int32, 1, c.nearest_cluster),
                                          column("leaf_cluster", NumberType::int32, 1, c.leaf_cluster),
                                          column("leaf_centres", NumberType::float64, 3, c.leaf_centres),
                                          column("axes", NumberType::float64, 9, c.axes),
                                          column("leaf_offsets", NumberType::int64, 1, c.leaf_offsets),
                                          column("members", NumberType::int32, 1, c.members),
                                          column("nearest_leaf", NumberType::int32, 1, c.nearest_leaf),
                                          std::move(is_complete)};
    AtomicFile file(path);
    extension == ".json" ? write_list_json(file.stream(), members) : write_list_npz(file.stream(), members);
    file.commit();
}

}  // namespace crumple::io
