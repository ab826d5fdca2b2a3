#include "scene/prepared_scene.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <string>

#include "crumple/error.h"
#include "geometry/position_hash.h"
#include "scene/outline.h"

namespace crumple {
namespace {

std::size_t size_of(ScalarType type) { return type == ScalarType::float32 ? sizeof(float) : sizeof(double); }
std::size_t size_of(IndexType type) { return type == IndexType::int64 ? sizeof(std::int64_t) : sizeof(std::int32_t); }

template <class Type>
bool contiguous(const ArrayView<Type>& view) {
    const auto size = static_cast<std::int64_t>(size_of(view.type));
    return view.column_stride == size && view.row_stride == 3 * size;
}

// Finds the bounds of contiguous rows, and checks that all coordinates are finite. Handles eight rows at a time: they
// fill vectors of any width, and a compiler vectorises a loop of this length instead of unrolling it. Minimum and
// maximum are written as a comparison and a selection, which vectorise without -ffast-math. A finite value minus itself
// is 0; for other values the difference is NaN, which persists in the sum.
template <class T>
ChunkCheck check_rows(const T* data, std::int64_t rows) {
    constexpr double most = std::numeric_limits<double>::max();
    constexpr std::int64_t rows_at_once = 8;
    std::array<T, 3 * rows_at_once> lo, hi, spoiled{};
    lo.fill(std::numeric_limits<T>::max());
    hi.fill(std::numeric_limits<T>::lowest());
    const auto visit = [&](const T* row, std::int64_t count) {
        const auto lanes = static_cast<std::size_t>(count);
        for (std::size_t l = 0; l < lanes; ++l) {
            const T value = row[l];
            lo[l] = value < lo[l] ? value : lo[l];
            hi[l] = value > hi[l] ? value : hi[l];
            spoiled[l] += value - value;
        }
    };
    std::int64_t i = 0;
    for (; i + rows_at_once <= rows; i += rows_at_once) visit(data + 3 * i, 3 * rows_at_once);
    visit(data + 3 * i, 3 * (rows - i));
    ChunkCheck check{{most, most, most}, {-most, -most, -most}, true};
    for (std::size_t l = 0; l < lo.size(); ++l) {
        check.good = check.good && spoiled[l] == 0;
        double &low = check.low[static_cast<int>(l % 3)], &high = check.high[static_cast<int>(l % 3)];
        low = min(low, static_cast<double>(lo[l]));
        high = max(high, static_cast<double>(hi[l]));
    }
    return check;
}

}  // namespace

ChunkCheck check_vertices(const VertexView& view, const VertexReader& reader, std::int64_t begin, std::int64_t end) {
    if (contiguous(view) && reinterpret_cast<std::uintptr_t>(view.data) % size_of(view.type) == 0) {
        if (view.type == ScalarType::float32)
            return check_rows(static_cast<const float*>(view.data) + 3 * begin, end - begin);
        return check_rows(static_cast<const double*>(view.data) + 3 * begin, end - begin);
    }
    constexpr double most = std::numeric_limits<double>::max();
    ChunkCheck check{{most, most, most}, {-most, -most, -most}, true};
    for (std::int64_t i = begin; i < end; ++i) {
        const Vec3d p = reader(i);
        check.good = check.good && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        check.low = min(check.low, p);
        check.high = max(check.high, p);
    }
    return check;
}

namespace {

[[noreturn]] void fail_infinite_vertex(const VertexView& view, const VertexReader& reader, const std::string& which) {
    std::int64_t i = 0;
    const auto finite = [](Vec3d p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); };
    while (i + 1 < view.rows && finite(reader(i))) ++i;
    fail_not_finite(which, i);
}

// Reads indices in the caller's memory; the array need not be aligned.
template <class Index>
struct HostIndexReader {
    const std::byte* data;
    std::int64_t row_stride, column_stride;

    explicit HostIndexReader(const TriangleView& view)
        : data(static_cast<const std::byte*>(view.data)),
          row_stride(view.row_stride),
          column_stride(view.column_stride) {}
    Index operator()(std::int64_t t, int corner) const {
        Index value;
        std::memcpy(&value, data + t * row_stride + corner * column_stride, sizeof(Index));
        return value;
    }
};

// True if all indices of triangles [begin, end) are in range. If an index is out of range, the highest bit of the index
// or of (last - index) is set.
template <class Index>
bool check_corners(const TriangleView& view, std::int64_t vertex_count, std::int64_t begin, std::int64_t end) {
    using Unsigned = std::make_unsigned_t<Index>;
    const Unsigned last = static_cast<Unsigned>(vertex_count) - 1;
    Unsigned outside = 0;
    const auto visit = [&](Index index) {
        const auto i = static_cast<Unsigned>(index);
        outside |= i | (last - i);
    };
    if (contiguous(view) && reinterpret_cast<std::uintptr_t>(view.data) % sizeof(Index) == 0) {
        const auto* values = static_cast<const Index*>(view.data);
        for (std::int64_t i = 3 * begin; i < 3 * end; ++i) visit(values[i]);
    } else {
        const HostIndexReader<Index> read(view);
        for (std::int64_t t = begin; t < end; ++t)
            for (int corner = 0; corner < 3; ++corner) visit(read(t, corner));
    }
    return outside >> (8 * sizeof(Index) - 1) == 0;
}

template <class Index>
[[noreturn]] void fail_wrong_index(const TriangleView& view, std::int64_t vertex_count, const std::string& which) {
    const HostIndexReader<Index> read(view);
    const auto wrong = [&](std::int64_t t, int corner) {
        return static_cast<std::make_unsigned_t<Index>>(read(t, corner)) >=
               static_cast<std::make_unsigned_t<Index>>(vertex_count);
    };
    std::int64_t t = 0;
    while (t + 1 < view.rows && !wrong(t, 0) && !wrong(t, 1) && !wrong(t, 2)) ++t;
    fail_index(which, t, read(t, wrong(t, 0) ? 0 : wrong(t, 1) ? 1 : 2), vertex_count);
}

// Copies the indices of `view` to `out` as int32, plus `offset`.
template <class Index>
void copy_corners(const TriangleView& view, std::int32_t offset, std::int32_t* out) {
    const HostIndexReader<Index> read(view);
    for (std::int64_t t = 0; t < view.rows; ++t)
        for (int corner = 0; corner < 3; ++corner)
            out[3 * t + corner] = static_cast<std::int32_t>(read(t, corner)) + offset;
}

// Checks vertices and triangles in parallel chunks; extends the box [low, high] by the vertices.
void check_content(const MeshView& mesh, const VertexReader& reader, const std::string& which, ParallelFor& workers,
                   Array<ChunkCheck>& checks, Vec3d& low, Vec3d& high) {
    constexpr std::int64_t chunk = 8192;
    const auto chunks = [](std::int64_t rows) { return static_cast<std::size_t>((rows + chunk - 1) / chunk); };
    const std::size_t vertex_chunks = chunks(mesh.vertices.rows), all = vertex_chunks + chunks(mesh.triangles.rows);
    checks.resize_discard(all);
    workers.parallel_for(all, [&](std::size_t c) {
        const bool of_vertices = c < vertex_chunks;
        const std::int64_t begin = static_cast<std::int64_t>(of_vertices ? c : c - vertex_chunks) * chunk;
        if (of_vertices) {
            checks[c] = check_vertices(mesh.vertices, reader, begin, std::min(mesh.vertices.rows, begin + chunk));
        } else {
            with_index_type(mesh.triangles.type, [&](auto index) {
                checks[c].good = check_corners<decltype(index)>(mesh.triangles, mesh.vertices.rows, begin,
                                                                std::min(mesh.triangles.rows, begin + chunk));
            });
        }
    });
    for (std::size_t c = 0; c < all; ++c) {
        if (!checks[c].good && c < vertex_chunks) fail_infinite_vertex(mesh.vertices, reader, which);
        if (!checks[c].good)
            with_index_type(mesh.triangles.type, [&](auto index) {
                fail_wrong_index<decltype(index)>(mesh.triangles, mesh.vertices.rows, which);
            });
        if (c >= vertex_chunks) continue;
        low = min(low, checks[c].low);
        high = max(high, checks[c].high);
    }
}

}  // namespace

// Uses a hash table with open addressing and linear probing, at most half full.
void find_representatives(const PreparedScene& scene, Array<std::int32_t>& table, Array<std::int32_t>& names) {
    const std::int64_t n = scene.vertex_count();
    const std::uint64_t slots = std::bit_ceil(static_cast<std::uint64_t>(2 * n + 1));
    const PositionHash hash;
    const auto equal = [&](std::int32_t u, std::int64_t v) {
        return scene.position(u) == scene.position(v) && scene.end_position(u) == scene.end_position(v);
    };
    table.assign(slots, -1);
    names.resize_discard(static_cast<std::size_t>(n));
    for (std::int64_t v = 0; v < n; ++v) {
        std::uint64_t slot = hash(scene.position(v)) & (slots - 1);
        while (table[slot] >= 0 && !equal(table[slot], v)) slot = (slot + 1) & (slots - 1);
        if (table[slot] < 0) table[slot] = static_cast<std::int32_t>(v);
        names[v] = table[slot];
    }
}

void add_motion(const VertexView& end, ParallelFor& workers, SceneBuffers& buffers, PreparedScene& scene) {
    outline_motion(end, scene);
    Vec3d low = scene.low, high = scene.high;
    check_content(MeshView(end, {}), scene.end, "at the end: ", workers, buffers.checks, low, high);
    if (end.rows > 0) scene.low = low, scene.high = high;
}

void check_finite(const VertexView& vertices, const std::string& which, ParallelFor& workers, SceneBuffers& buffers) {
    const VertexReader reader{static_cast<const std::byte*>(vertices.data), vertices.row_stride, vertices.column_stride,
                              vertices.type == ScalarType::float32};
    Vec3d low, high;
    check_content(MeshView(vertices, {}), reader, which, workers, buffers.checks, low, high);
}

PreparedScene prepare_scene(const MeshView& a, const MeshView* b, bool weld, ParallelFor& workers,
                            SceneBuffers& buffers) {
    PreparedScene scene = outline_scene(a, b, MemorySpace::host);
    const std::array<const MeshView*, 2> meshes{&a, b};
    constexpr double most = std::numeric_limits<double>::max();
    scene.side_low.fill({most, most, most});
    scene.side_high.fill({-most, -most, -most});
    for (std::size_t side = 0; side < (b ? 2u : 1u); ++side)
        check_content(*meshes[side], scene.reader[side], mesh_name(scene, side), workers, buffers.checks,
                      scene.side_low[side], scene.side_high[side]);
    if (scene.vertex_count() > 0) {
        scene.low = min(scene.side_low[0], scene.side_low[1]);
        scene.high = max(scene.side_high[0], scene.side_high[1]);
    }

    const bool as_is = !b && !weld && a.triangles.type != IndexType::int64 && contiguous(a.triangles) &&
                       reinterpret_cast<std::uintptr_t>(a.triangles.data) % sizeof(std::int32_t) == 0;
    if (as_is) {
        scene.corners = static_cast<const std::int32_t*>(a.triangles.data);
    } else {
        buffers.corners.resize_discard(static_cast<std::size_t>(3 * scene.triangle_count()));
        for (std::size_t side = 0; side < (b ? 2u : 1u); ++side)
            with_index_type(meshes[side]->triangles.type, [&](auto index) {
                copy_corners<decltype(index)>(meshes[side]->triangles,
                                              static_cast<std::int32_t>(side ? scene.vertices[0] : 0),
                                              buffers.corners.data() + (side ? 3 * scene.triangles[0] : 0));
            });
        if (weld) {
            find_representatives(scene, buffers.table, buffers.representative);
            for (std::int32_t& corner : buffers.corners) corner = buffers.representative[corner];
        }
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
