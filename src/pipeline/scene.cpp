#include "pipeline/scene.h"

#include <bit>
#include <limits>
#include <string>

#include "crumple/error.h"

namespace crumple {
namespace {

[[noreturn]] void fail(ErrorCode code, const std::string& message, Element element = Element::none,
                       std::int64_t index = -1) {
    throw Error(code, message, element, index);
}

std::size_t size_of(ScalarType type) { return type == ScalarType::float32 ? sizeof(float) : sizeof(double); }
std::size_t size_of(IndexType type) { return type == IndexType::int64 ? sizeof(std::int64_t) : sizeof(std::int32_t); }

template <class Type>
bool contiguous(const ArrayView<Type>& view) {
    const auto size = static_cast<std::int64_t>(size_of(view.type));
    return view.column_stride == size && view.row_stride == 3 * size;
}

void check_shape(const MeshView& mesh, const std::string& which) {
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    if (mesh.memory != MemorySpace::host)
        fail(ErrorCode::invalid_argument, which + "lies in device memory, which needs the cuda backend");
    if (mesh.vertices.rows < 0 || mesh.vertices.rows > most)
        fail(ErrorCode::invalid_argument,
             which + "has " + std::to_string(mesh.vertices.rows) + " vertices; 0 to 2147483647 are possible");
    if (mesh.triangles.rows < 0 || mesh.triangles.rows > most)
        fail(ErrorCode::invalid_argument,
             which + "has " + std::to_string(mesh.triangles.rows) + " triangles; 0 to 2147483647 are possible");
    if (mesh.vertices.rows > 0 && !mesh.vertices.data) fail(ErrorCode::invalid_argument, which + "has no vertex data");
    if (mesh.triangles.rows > 0 && !mesh.triangles.data)
        fail(ErrorCode::invalid_argument, which + "has no triangle data");
    if (!mesh.groups.empty() && static_cast<std::int64_t>(mesh.groups.size()) != mesh.triangles.rows)
        fail(ErrorCode::invalid_argument, which + "has " + std::to_string(mesh.groups.size()) + " group ids for " +
                                              std::to_string(mesh.triangles.rows) + " triangles");
}

// Least and largest of each coordinate of contiguous rows, and whether all are finite. Twelve lanes, four rows at once,
// are a multiple of every vector's width, and compare-and-select in lanes keeps its meaning without -ffast-math.
template <class T, class Bits, Bits exponent>
bool box_of_rows(const T* data, std::int64_t rows, Vec3d& low, Vec3d& high) {
    std::array<T, 12> lo, hi;
    lo.fill(std::numeric_limits<T>::max());
    hi.fill(std::numeric_limits<T>::lowest());
    std::array<Bits, 12> bad{};
    const auto visit = [&](const T* row, int lanes) {
        for (int l = 0; l < lanes; ++l) {
            const T value = row[l];
            lo[l] = value < lo[l] ? value : lo[l];
            hi[l] = value > hi[l] ? value : hi[l];
            bad[l] |= static_cast<Bits>((std::bit_cast<Bits>(value) & exponent) == exponent);
        }
    };
    std::int64_t i = 0;
    for (; i + 4 <= rows; i += 4) visit(data + 3 * i, 12);
    for (; i < rows; ++i) visit(data + 3 * i, 3);
    Bits any = 0;
    for (int l = 0; l < 12; ++l) {
        any |= bad[l];
        low[l % 3] = min(low[l % 3], static_cast<double>(lo[l]));
        high[l % 3] = max(high[l % 3], static_cast<double>(hi[l]));
    }
    return any == 0;
}

void check_vertices(const VertexView& view, const VertexReader& reader, const std::string& which, Vec3d& low,
                    Vec3d& high) {
    bool finite = true;
    const bool aligned = reinterpret_cast<std::uintptr_t>(view.data) % size_of(view.type) == 0;
    if (contiguous(view) && aligned && view.type == ScalarType::float32) {
        finite =
            box_of_rows<float, std::uint32_t, 0x7f800000u>(static_cast<const float*>(view.data), view.rows, low, high);
    } else if (contiguous(view) && aligned) {
        finite = box_of_rows<double, std::uint64_t, 0x7ff0000000000000u>(static_cast<const double*>(view.data),
                                                                         view.rows, low, high);
    } else {
        for (std::int64_t i = 0; i < view.rows; ++i) {
            const Vec3d p = reader(i);
            finite &= std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
            low = min(low, p);
            high = max(high, p);
        }
    }
    if (finite) return;
    for (std::int64_t i = 0; i < view.rows; ++i) {
        const Vec3d p = reader(i);
        for (int axis = 0; axis < 3; ++axis)
            if (!std::isfinite(p[axis]))
                fail(ErrorCode::not_finite, which + "vertex " + std::to_string(i) + " is not finite", Element::vertex,
                     i);
    }
}

// Copies the indices of `view` to `out` as int32, `offset` added. The address arithmetic is by bytes, since a caller's
// array need not be aligned.
template <class Index>
void copy_corners(const TriangleView& view, std::int32_t offset, std::int32_t* out) {
    const auto* base = static_cast<const std::byte*>(view.data);
    for (std::int64_t t = 0; t < view.rows; ++t) {
        for (int corner = 0; corner < 3; ++corner) {
            Index value;
            std::memcpy(&value, base + t * view.row_stride + corner * view.column_stride, sizeof(Index));
            out[3 * t + corner] = static_cast<std::int32_t>(value) + offset;
        }
    }
}

template <class Index>
void check_corners(const TriangleView& view, std::int64_t vertex_count, const std::string& which) {
    const auto* base = static_cast<const std::byte*>(view.data);
    const auto read = [&](std::int64_t t, int corner) {
        Index value;
        std::memcpy(&value, base + t * view.row_stride + corner * view.column_stride, sizeof(Index));
        return value;
    };
    // Negative values become large ones, so a single comparison finds both.
    bool bad = false;
    using Unsigned = std::make_unsigned_t<Index>;
    const auto limit = static_cast<Unsigned>(vertex_count);
    if (contiguous(view) && reinterpret_cast<std::uintptr_t>(view.data) % sizeof(Index) == 0) {
        const auto* values = static_cast<const Index*>(view.data);
        for (std::int64_t i = 0; i < 3 * view.rows; ++i) bad |= static_cast<Unsigned>(values[i]) >= limit;
    } else {
        for (std::int64_t t = 0; t < view.rows; ++t)
            for (int corner = 0; corner < 3; ++corner) bad |= static_cast<Unsigned>(read(t, corner)) >= limit;
    }
    if (!bad) return;
    for (std::int64_t t = 0; t < view.rows; ++t)
        for (int corner = 0; corner < 3; ++corner)
            if (static_cast<Unsigned>(read(t, corner)) >= limit)
                fail(ErrorCode::index_out_of_range,
                     which + "triangle " + std::to_string(t) + " names vertex " + std::to_string(read(t, corner)) +
                         " of " + std::to_string(vertex_count),
                     Element::triangle, t);
}

template <class Function>
void with_index_type(IndexType type, Function function) {
    switch (type) {
        case IndexType::int32:
            function(std::int32_t{});
            break;
        case IndexType::uint32:
            function(std::uint32_t{});
            break;
        case IndexType::int64:
            function(std::int64_t{});
            break;
    }
}

std::uint64_t hash(Vec3d p) {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
        h ^= std::bit_cast<std::uint64_t>(p[axis] + 0.0);  // -0 becomes +0
        h *= 0x9e3779b97f4a7c15u;
        h ^= h >> 32;
    }
    return h;
}

// Replaces each corner by the lowest vertex at the same position: open addressing, linear probing, half full at most.
void weld_corners(Scene& scene, SceneBuffers& buffers) {
    const std::int64_t n = scene.vertex_count();
    const std::uint64_t slots = std::bit_ceil(static_cast<std::uint64_t>(2 * n + 1));
    buffers.table.assign(slots, -1);
    buffers.representative.resize_discard(static_cast<std::size_t>(n));
    for (std::int64_t v = 0; v < n; ++v) {
        const Vec3d p = scene.position(v);
        std::uint64_t slot = hash(p) & (slots - 1);
        while (buffers.table[slot] >= 0 && !(scene.position(buffers.table[slot]) == p)) slot = (slot + 1) & (slots - 1);
        if (buffers.table[slot] < 0) buffers.table[slot] = static_cast<std::int32_t>(v);
        buffers.representative[static_cast<std::size_t>(v)] = buffers.table[slot];
    }
    for (std::int32_t& corner : buffers.corners) corner = buffers.representative[static_cast<std::size_t>(corner)];
}

}  // namespace

Scene prepare_scene(const MeshView& a, const MeshView* b, bool weld, SceneBuffers& buffers) {
    Scene scene;
    scene.between = b != nullptr;
    const std::array<const MeshView*, 2> meshes{&a, b};
    const int count = b ? 2 : 1;
    const std::array<std::string, 2> which{b ? "first mesh: " : "", "second mesh: "};

    constexpr double most = std::numeric_limits<double>::max();
    Vec3d low{most, most, most}, high{-most, -most, -most};
    for (int side = 0; side < count; ++side) {
        const MeshView& mesh = *meshes[side];
        check_shape(mesh, which[side]);
        scene.vertices[side] = mesh.vertices.rows;
        scene.triangles[side] = mesh.triangles.rows;
        scene.reader[side] = {static_cast<const std::byte*>(mesh.vertices.data), mesh.vertices.row_stride,
                              mesh.vertices.column_stride, mesh.vertices.type == ScalarType::float32};
        scene.float32 = scene.float32 && scene.reader[side].float32;
        check_vertices(mesh.vertices, scene.reader[side], which[side], low, high);
        with_index_type(mesh.triangles.type, [&](auto index) {
            check_corners<decltype(index)>(mesh.triangles, mesh.vertices.rows, which[side]);
        });
    }
    if (scene.vertex_count() > 0) {
        scene.low = low;
        scene.high = high;
    }
    constexpr std::int64_t most_ids = std::numeric_limits<std::int32_t>::max();
    if (scene.vertex_count() > most_ids || scene.triangle_count() > most_ids)
        fail(ErrorCode::invalid_argument, "both meshes together have more than 2147483647 vertices or triangles");

    const bool as_is = !b && !weld && a.triangles.type != IndexType::int64 && contiguous(a.triangles) &&
                       reinterpret_cast<std::uintptr_t>(a.triangles.data) % sizeof(std::int32_t) == 0;
    if (as_is) {
        scene.corners = static_cast<const std::int32_t*>(a.triangles.data);
    } else {
        buffers.corners.resize_discard(static_cast<std::size_t>(3 * scene.triangle_count()));
        for (int side = 0; side < count; ++side)
            with_index_type(meshes[side]->triangles.type, [&](auto index) {
                copy_corners<decltype(index)>(meshes[side]->triangles,
                                              static_cast<std::int32_t>(side ? scene.vertices[0] : 0),
                                              buffers.corners.data() + (side ? 3 * scene.triangles[0] : 0));
            });
        if (weld) weld_corners(scene, buffers);
        scene.corners = buffers.corners.data();
    }

    if (!b) {
        scene.groups = a.groups.empty() ? nullptr : a.groups.data();
    } else if (!a.groups.empty() || !b->groups.empty()) {
        buffers.groups.assign(static_cast<std::size_t>(scene.triangle_count()), 0);
        std::copy(a.groups.begin(), a.groups.end(), buffers.groups.begin());
        std::copy(b->groups.begin(), b->groups.end(), buffers.groups.begin() + scene.triangles[0]);
        scene.groups = buffers.groups.data();
    }
    return scene;
}

}  // namespace crumple
