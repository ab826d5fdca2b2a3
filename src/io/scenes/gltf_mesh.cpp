#include "io/scenes/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "io/bytes/bytes.h"
#include "io/formats.h"
#include "io/meshes/weld.h"

namespace crumple::io {

namespace {

constexpr auto little = std::endian::little;

/// Returns coordinate k of vertex i. Integers of a normalised accessor are divided by the largest value of their type.
double coordinate_at(const GltfElements& e, std::int64_t i, std::size_t k) {
    const char* const p = e.at(i);
    const auto number = [&](auto type) {
        using T = decltype(type);
        const auto value = static_cast<double>(load<T>(p + k * sizeof(T), little));
        return e.normalised ? std::max(value / std::numeric_limits<T>::max(), -1.0) : value;
    };
    switch (e.component_type) {
        case gltf_int8:
            return number(std::int8_t{});
        case gltf_uint8:
            return number(std::uint8_t{});
        case gltf_int16:
            return number(std::int16_t{});
        case gltf_uint16:
            return number(std::uint16_t{});
        default:
            return static_cast<double>(load<float>(p + 4 * k, little));
    }
}

/// Renumbers corners so that vertices without triangles are left out, and returns the old index of each remaining
/// vertex. If there is at least one corner for every four vertices, nothing is left out, to save time: all `count`
/// indices are returned.
std::vector<std::int64_t> used_vertices(std::vector<std::int64_t>& corners, std::int64_t count) {
    std::vector<std::int64_t> used;
    if (count / 4 <= static_cast<std::int64_t>(corners.size())) {
        for (std::int64_t v = 0; v < count; ++v) used.push_back(v);
        return used;
    }
    used = corners;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (std::int64_t& corner : corners) corner = std::lower_bound(used.begin(), used.end(), corner) - used.begin();
    return used;
}

}  // namespace

std::int32_t GltfMeshes::shape_of(std::int64_t index, const GltfObject& node) {
    const GltfObject mesh = file_.item("meshes", index, node, "mesh");
    if (of_mesh_.empty()) of_mesh_.assign(file_.root().size_of("meshes"), -1);
    std::int32_t& shape = of_mesh_[static_cast<std::size_t>(index)];
    if (shape >= 0) return shape;
    const std::vector<Primitive> primitives = primitives_of(mesh);
    const auto known = known_.find(primitives);
    if (known != known_.end()) return shape = known->second;
    shapes_.push_back(read(primitives, mesh));
    shape = static_cast<std::int32_t>(shapes_.size()) - 1;
    known_.emplace(primitives, shape);
    return shape;
}

std::vector<GltfMeshes::Primitive> GltfMeshes::primitives_of(const GltfObject& mesh) {
    std::vector<Primitive> primitives;
    const std::vector<double> weights = mesh.numbers("weights");
    const bool morphs = std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
    for (std::size_t i = 0; i < mesh.size_of("primitives"); ++i) {
        const GltfObject primitive = mesh.object_of("primitives", i);
        const std::int64_t mode = primitive.integer_or("mode", triangles);
        if (mode > fan) primitive.fail("mode", "is " + std::to_string(mode) + ", which glTF does not define");
        if (morphs && primitive.size_of("targets")) morph_targets.add(primitive.place());
        const auto attributes = primitive.object("attributes");
        const auto positions = attributes ? attributes->integer("POSITION") : std::nullopt;
        if (mode < triangles)
            points_and_lines.add(primitive.place());
        else if (!positions)
            without_positions.add(primitive.place());
        else
            primitives.push_back({mode, *positions, primitive.integer_or("indices", -1)});
    }
    return primitives;
}

TriangleMesh GltfMeshes::read(const std::vector<Primitive>& primitives, const GltfObject& mesh) {
    std::map<std::int64_t, Vertices> by_accessor;
    std::vector<const Vertices*> all;
    std::int64_t count = 0;
    std::vector<std::int64_t> corners;
    for (const Primitive& primitive : primitives) {
        auto [found, is_new] = by_accessor.try_emplace(primitive.positions);
        Vertices& vertices = found->second;
        if (is_new) {
            const GltfObject accessor = file_.item("accessors", primitive.positions, mesh, "primitives.POSITION");
            vertices = {file_.elements(accessor, "VEC3"), count, accessor.place()};
            if (vertices.elements.component_type == gltf_uint32)
                accessor.fail("componentType", "is 5125, which is not a type of positions");
            count += vertices.elements.count;
            all.push_back(&vertices);
        }
        add_corners(primitive, vertices, mesh, corners);
        // Limit against small files that expand to huge meshes. In a real file, primitives that share data refer to
        // each byte a few times at most.
        if ((corners_ + corners.size()) / 24 > file_.bytes_read())
            mesh.fail("refers to the same data so often that the file has more than 8 triangles per byte");
    }
    corners_ += corners.size();

    const std::vector<std::int64_t> used = used_vertices(corners, count);
    if (used.size() > INT32_MAX || corners.size() / 3 > INT32_MAX)
        mesh.fail("has more vertices or triangles than 32-bit ids can number");
    TriangleMesh result = in_precision(options_.precision, ScalarType::float32, [&](auto scalar) {
        std::vector<decltype(scalar)> xyz;
        xyz.reserve(3 * used.size());
        std::size_t a = 0;
        for (const std::int64_t v : used) {
            while (v >= all[a]->first + all[a]->elements.count) ++a;
            for (std::size_t k = 0; k < 3; ++k) {
                const double x = coordinate_at(all[a]->elements, v - all[a]->first, k);
                if (!std::isfinite(x))
                    throw Error(ErrorCode::format, file_.name() + ": vertex " + std::to_string(v - all[a]->first) +
                                                       " of " + all[a]->place + " is not finite");
                xyz.push_back(static_cast<decltype(scalar)>(x));
            }
        }
        return TriangleMesh{std::move(xyz), {corners.begin(), corners.end()}};
    });
    if (options_.weld != Weld::no) weld(result);
    return result;
}

void GltfMeshes::add_corners(const Primitive& primitive, const Vertices& vertices, const GltfObject& mesh,
                             std::vector<std::int64_t>& corners) {
    GltfElements indices;
    indices.count = vertices.elements.count;
    std::string place;
    if (primitive.indices >= 0) {
        const GltfObject accessor = file_.item("accessors", primitive.indices, mesh, "primitives.indices");
        indices = file_.elements(accessor, "SCALAR");
        place = accessor.place();
        if (!indices.has_indices())
            accessor.fail("componentType",
                          "is " + std::to_string(indices.component_type) + ", which is not a type of indices");
    }
    const auto corner = [&](std::int64_t i) {
        const std::int64_t index = indices.data ? indices.index_at(i) : i;
        if (index >= vertices.elements.count)
            throw Error(ErrorCode::format, file_.name() + ": index " + std::to_string(i) + " of " + place +
                                               " names vertex " + std::to_string(index) + " of " +
                                               std::to_string(vertices.elements.count));
        return vertices.first + index;
    };
    const std::int64_t n = indices.count;
    if (primitive.mode == triangles) {
        if (n % 3)
            mesh.fail("has a list of triangles with " + std::to_string(n) + " corners, which is not a multiple of 3");
        for (std::int64_t i = 0; i < n; ++i) corners.push_back(corner(i));
        return;
    }
    for (std::int64_t i = 0; i + 2 < n; ++i) {
        const bool turned = primitive.mode == strip && i % 2;  // every second triangle of a strip is reversed
        const std::int64_t a = corner(primitive.mode == fan ? 0 : i), b = corner(i + (turned ? 2 : 1)),
                           c = corner(i + (turned ? 1 : 2));
        // A strip that changes direction or jumps contains triangles that name a vertex twice; these are left out.
        if (a != b && b != c && c != a) corners.insert(corners.end(), {a, b, c});
    }
}

}  // namespace crumple::io
