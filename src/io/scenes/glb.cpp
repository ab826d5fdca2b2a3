// Writer of binary glTF. A mesh has one array of positions, and one primitive for the triangles of each material. glTF
// stores positions as float32 only. If a float64 mesh lies so far from the origin, compared with its size, that it
// would lose more than 4 of the 24 bits, its positions are stored relative to the centre of its box, and its node
// translates them back.

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "io/bytes/bytes.h"
#include "io/bytes/json.h"
#include "io/formats.h"
#include "io/meshes/unit.h"
#include "io/scenes/glb.h"
#include "io/scenes/world_mesh.h"

namespace crumple::io {

namespace {

using Point = std::array<double, 3>;

/// Returns the point to subtract from the positions of a float64 mesh before they are rounded to float32: the centre of
/// its box if the mesh lies far from the origin compared with its size, else zero.
Point origin_of(const std::vector<double>& xyz) {
    Point low, high, centre;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < xyz.size(); ++i) {
        low[i % 3] = std::min(low[i % 3], xyz[i]);
        high[i % 3] = std::max(high[i % 3], xyz[i]);
    }
    double extent = 0, farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        extent = std::max(extent, high[axis] - low[axis]);
        farthest = std::max({farthest, std::abs(low[axis]), std::abs(high[axis])});
        centre[axis] = low[axis] / 2 + high[axis] / 2;
    }
    constexpr double bits_to_lose = 4;
    return !xyz.empty() && farthest > std::exp2(bits_to_lose) * extent ? centre : Point{};
}
Point origin_of(const std::vector<float>&) { return {}; }

template <class Scalar>
std::vector<float> positions_of(const std::vector<Scalar>& xyz, const Point& origin) {
    std::vector<float> positions(xyz.size());
    for (std::size_t i = 0; i < xyz.size(); ++i) {
        positions[i] = static_cast<float>(double{xyz[i]} - origin[i % 3]);
        if (std::isfinite(positions[i])) continue;
        const std::size_t vertex = i / 3;
        throw Error(ErrorCode::invalid_argument,
                    "vertex " + std::to_string(vertex) + " overflows float32, which .glb holds", Element::vertex,
                    static_cast<std::int64_t>(vertex));
    }
    return positions;
}

/// Converts a colour component from sRGB to linear, which glTF uses.
double linear(std::uint8_t srgb) {
    const double value = srgb / 255.0;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

tinygltf::Material material(const char* name, const Colour& colour, double opacity = 1) {
    tinygltf::Material material;
    material.name = name;
    material.doubleSided = true;
    if (opacity < 1) material.alphaMode = "BLEND";
    auto& surface = material.pbrMetallicRoughness;
    surface.baseColorFactor = {linear(colour.red), linear(colour.green), linear(colour.blue), opacity};
    surface.metallicFactor = 0;
    surface.roughnessFactor = 0.8;
    return material;
}

/// Appends the values to the model's one buffer and returns the index of their accessor.
template <class T>
int add_accessor(tinygltf::Model& model, const std::vector<T>& values, int component_type, int type, int target) {
    std::vector<unsigned char>& bytes = model.buffers[0].data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    for (const T value : values) {
        const auto little = std::bit_cast<std::array<unsigned char, sizeof(T)>>(little_endian(value));
        bytes.insert(bytes.end(), little.begin(), little.end());
    }
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count =
        values.size() / static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
    model.bufferViews.push_back(view);
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
}

int add_positions(tinygltf::Model& model, const std::vector<float>& positions) {
    const int index = add_floats(model, positions, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
    tinygltf::Accessor& accessor = model.accessors.back();
    accessor.minValues.assign(positions.begin(), positions.begin() + 3);
    accessor.maxValues = accessor.minValues;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        accessor.minValues[i % 3] = std::min(accessor.minValues[i % 3], double{positions[i]});
        accessor.maxValues[i % 3] = std::max(accessor.maxValues[i % 3], double{positions[i]});
    }
    return index;
}

/// Adds a mesh whose positions have been added before, and returns its index. `hit`: index of the material of each
/// triangle.
int add_mesh(tinygltf::Model& model, const std::vector<std::int32_t>& triangles, std::span<const std::uint8_t> hit,
             int position_accessor) {
    tinygltf::Mesh mesh;
    const std::size_t materials = model.materials.size();
    for (std::size_t shade = 0; shade < materials; ++shade) {
        std::vector<std::uint32_t> indices;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            if (std::min<std::size_t>(hit[i / 3], materials - 1) == shade)
                indices.push_back(static_cast<std::uint32_t>(triangles[i]));
        }
        if (indices.empty()) continue;  // glTF has no empty accessors
        tinygltf::Primitive primitive;
        primitive.attributes["POSITION"] = position_accessor;
        primitive.indices = add_accessor(model, indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                                         TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
        primitive.material = static_cast<int>(shade);
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        mesh.primitives.push_back(primitive);
    }
    model.meshes.push_back(std::move(mesh));
    return static_cast<int>(model.meshes.size()) - 1;
}

/// Creates the buffer if there is none. Throws Error (invalid_argument) if this many more bytes would exceed the 4 GiB
/// of .glb.
void reserve_bytes(tinygltf::Model& model, std::size_t bytes) {
    if (model.buffers.empty()) model.buffers.resize(1);
    if (model.buffers[0].data.size() + bytes > UINT32_MAX - (1u << 24)) {  // leaves 16 MiB for the JSON chunk
        throw Error(ErrorCode::invalid_argument, "the meshes are larger than the 4 GiB that .glb holds");
    }
}

int add_to_scene(tinygltf::Model& model, tinygltf::Node node) {
    model.nodes.push_back(std::move(node));
    const int index = static_cast<int>(model.nodes.size()) - 1;
    model.scenes[0].nodes.push_back(index);
    return index;
}

}  // namespace

tinygltf::Model empty_glb(std::span<const Material> materials) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "Crumple";
    for (const auto& [name, colour, opacity] : materials) model.materials.push_back(material(name, colour, opacity));
    model.scenes.resize(1);
    model.scenes[0].name = "collisions";
    model.defaultScene = 0;
    return model;
}

int add_floats(tinygltf::Model& model, const std::vector<float>& values, int type, int target) {
    return add_accessor(model, values, TINYGLTF_COMPONENT_TYPE_FLOAT, type, target);
}

std::optional<int> add_node(tinygltf::Model& model, const ColouredMesh& coloured) {
    if (coloured.hit.empty()) return {};  // glTF has no empty meshes
    reserve_bytes(model, 12 * (static_cast<std::size_t>(coloured.mesh.vertex_count()) + coloured.hit.size()));
    return std::visit(
        [&](const auto& xyz) {
            const Point origin = origin_of(xyz);
            tinygltf::Node node;
            node.mesh =
                add_mesh(model, coloured.mesh.triangles, coloured.hit, add_positions(model, positions_of(xyz, origin)));
            if (origin != Point{}) node.translation.assign(origin.begin(), origin.end());
            return add_to_scene(model, std::move(node));
        },
        coloured.mesh.vertices);
}

void write_glb(std::ostream& out, tinygltf::Model& model, Unit unit) {
    const bool scaled = unit != Unit::unknown && unit != Unit::metre && !model.scenes[0].nodes.empty();
    std::vector<int> roots = model.scenes[0].nodes;
    if (scaled) {
        tinygltf::Node above;
        above.name = name_of(unit);
        above.scale.assign(3, metres_in(unit));
        above.children = roots;
        model.scenes[0].nodes.clear();
        add_to_scene(model, std::move(above));
    }
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, out, false, true);
    if (scaled) model.nodes.pop_back();
    model.scenes[0].nodes = std::move(roots);
}

namespace {

/// Parts of a shape that have been added to the model: the index of its accessor of positions, and the index of its
/// mesh without colliding triangles (`free`); -1: not added yet. Positions are relative to `origin`.
struct WrittenShape {
    int positions = -1, free = -1;
    Point origin{};
};

int mesh_of(tinygltf::Model& model, const TriangleMesh& shape, std::span<const std::uint8_t> hit,
            WrittenShape& written) {
    const bool free = std::none_of(hit.begin(), hit.end(), [](std::uint8_t h) { return h != 0; });
    if (free && written.free >= 0) return written.free;
    reserve_bytes(model,
                  12 * ((written.positions < 0 ? static_cast<std::size_t>(shape.vertex_count()) : 0) + hit.size()));
    if (written.positions < 0) {
        std::visit(
            [&](const auto& xyz) {
                written.origin = origin_of(xyz);
                written.positions = add_positions(model, positions_of(xyz, written.origin));
            },
            shape.vertices);
    }
    const int mesh = add_mesh(model, shape.triangles, hit, written.positions);
    if (free) written.free = mesh;
    return mesh;
}

/// Returns the matrix of a node, by columns, for a mesh whose positions are relative to `origin`.
std::vector<double> matrix_of(const Pose& pose, const Point& origin) {
    std::vector<double> matrix(16);
    matrix[15] = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double* const r = &pose.rows[4 * i];
        for (std::size_t k = 0; k < 3; ++k) matrix[4 * k + i] = r[k];
        matrix[12 + i] = ((r[0] * origin[0] + r[1] * origin[1]) + r[2] * origin[2]) + r[3];
    }
    return matrix;
}

}  // namespace

namespace {

void write_glb(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit, tinygltf::Model& model) {
    std::vector<WrittenShape> written(world.shapes.size());
    for (const NamedBody& body : world.bodies) {
        const auto s = static_cast<std::size_t>(body.shape);
        const TriangleMesh& shape = world.shapes[s];
        const auto triangles = static_cast<std::size_t>(shape.triangle_count());
        tinygltf::Node node;
        node.name = valid_utf8(body.name);
        // glTF has no empty meshes.
        if (triangles) node.mesh = mesh_of(model, shape, hit.first(triangles), written[s]);
        hit = hit.subspan(triangles);
        if (body.pose != Pose{} || written[s].origin != Point{}) node.matrix = matrix_of(body.pose, written[s].origin);
        add_to_scene(model, std::move(node));
    }
    write_glb(out, model, world.unit);
}

}  // namespace

void write_coloured_glb(std::ostream& out, const WorldMesh& world, std::span<const std::uint8_t> hit,
                        std::span<const Material> materials) {
    tinygltf::Model model = empty_glb(materials);
    write_glb(out, world, hit, model);
}

void write_glb(std::ostream& out, const WorldMesh& world) {
    tinygltf::Model model = empty_glb();
    model.materials.resize(1);
    model.materials[0].name = "surface";
    model.scenes[0].name = "world";
    write_glb(out, world, std::vector<std::uint8_t>(static_cast<std::size_t>(world.triangle_count())), model);
}

void write_glb(std::ostream& out, const TriangleMesh& mesh, bool) { write_glb(out, world_of(mesh)); }

void write_shaded_glb(std::ostream& out, const ColouredMesh& coloured, std::span<const Colour> shades) {
    tinygltf::Model model = empty_glb();
    model.materials.clear();
    for (std::size_t i = 0; i < shades.size(); ++i)
        model.materials.push_back(material(i ? ("shade " + std::to_string(i)).c_str() : "free", shades[i]));
    add_node(model, coloured);
    write_glb(out, model, coloured.mesh.unit);
}

void write_coloured_glb(std::ostream& out, const ColouredMesh& coloured) {
    tinygltf::Model model = empty_glb(coloured.materials);
    add_node(model, coloured);
    write_glb(out, model, coloured.mesh.unit);
}

}  // namespace crumple::io
