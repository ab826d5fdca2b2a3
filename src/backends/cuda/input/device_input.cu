#include "backends/cuda/input/device_input.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include "backends/cuda/input/index_reader.h"
#include "scene/outline.h"

namespace crumple::cuda {
namespace {

constexpr std::int32_t no_vertex = -1;
constexpr unsigned empty_slot = ~0u;

// Writes one mesh's corners, as vertex indices in which the vertices of a second mesh follow those of the first
// (`offset`). Indices out of range become no_vertex, which `bounds` reports.
template <class Reader>
__global__ void join_kernel(Reader read, std::size_t triangles, std::int64_t vertices, std::int64_t offset,
                            std::int32_t* corners) {
    for (std::size_t i = grid_thread(); i < 3 * triangles; i += grid_stride()) {
        const std::int64_t index = read(i / 3, static_cast<int>(i % 3));
        corners[i] = index >= 0 && index < vertices ? static_cast<std::int32_t>(index + offset) : no_vertex;
    }
}

// Fills a hash table of positions, with open addressing and linear probing, at most half full. A slot holds the lowest
// vertex at its position.
__global__ void fill_table_kernel(PreparedScene scene, PositionHash hash, unsigned* table, std::size_t slots) {
    const auto n = static_cast<std::size_t>(scene.vertex_count());
    for (std::size_t v = grid_thread(); v < n; v += grid_stride()) {
        const auto vertex = static_cast<unsigned>(v);
        const Vec3d p = scene.position(vertex);
        // NaN equals nothing, so vertices with the same NaN position would each probe past all earlier ones.
        if (!(p == p)) continue;
        std::size_t slot = hash(p) & (slots - 1);
        for (;; slot = (slot + 1) & (slots - 1)) {
            const unsigned holder = atomicCAS(&table[slot], empty_slot, vertex);
            if (holder == empty_slot) break;
            if (scene.position(holder) == p) {
                atomicMin(&table[slot], vertex);
                break;
            }
        }
    }
}

__global__ void weld_kernel(PreparedScene scene, PositionHash hash, const unsigned* table, std::size_t slots,
                            std::int32_t* corners) {
    const auto n = 3 * static_cast<std::size_t>(scene.triangle_count());
    for (std::size_t i = grid_thread(); i < n; i += grid_stride()) {
        if (corners[i] == no_vertex) continue;
        const Vec3d p = scene.position(corners[i]);
        if (!(p == p)) continue;  // not in the table; check_vertices() reports it
        std::size_t slot = hash(p) & (slots - 1);
        while (!(scene.position(table[slot]) == p)) slot = (slot + 1) & (slots - 1);
        corners[i] = static_cast<std::int32_t>(table[slot]);
    }
}

template <class T>
void copy(cudaStream_t stream, T* to, const T* from, std::size_t n) {
    if (n == 0) return;
    CRUMPLE_CUDA(cudaMemcpyAsync(to, from, n * sizeof(T), cudaMemcpyHostToDevice, stream));
    CRUMPLE_CUDA(cudaStreamSynchronize(stream));  // the host's arrays need not outlive the call
}

std::size_t bytes_of(const VertexReader& reader, std::int64_t vertices) {
    return 3 * static_cast<std::size_t>(vertices) * reader.scalar_bytes();
}

// Returns the vertices as rows without gaps: the caller's array, or else a copy in `packed`.
const std::byte* pack(const VertexReader& reader, std::int64_t vertices, Array<std::byte>& packed) {
    if (reader.contiguous()) return reader.data;
    const std::size_t size = reader.scalar_bytes();
    std::byte* out = packed.resize_discard(bytes_of(reader, vertices));
    for (std::int64_t v = 0; v < vertices; ++v)
        for (int axis = 0; axis < 3; ++axis, out += size)
            std::memcpy(out, reader.data + v * reader.row_stride + axis * reader.column_stride, size);
    return packed.data();
}

bool is_int32_rows(const TriangleView& view) {
    return view.type != IndexType::int64 && view.column_stride == 4 && view.row_stride == 12 &&
           reinterpret_cast<std::uintptr_t>(view.data) % 4 == 0;
}

}  // namespace

// Drops the input of an earlier call.
void Input::forget() {
    mesh_[0] = mesh_[1] = {};
    cached_shape_ = {};
    posed_.reset();
    names_ = {};
    weld_ = false;
}

void Input::bring(const PreparedScene& host) {
    forget();
    scene_ = host;
    // Vertices of both meshes, and end positions of the first.
    struct Vertices {
        const VertexReader* from;
        VertexReader* to;
        std::int64_t count;
        std::byte* data = nullptr;
    };
    Vertices vertices[3] = {{&host.reader[0], &scene_.reader[0], host.vertices[0]},
                            {&host.reader[1], &scene_.reader[1], host.vertices[1]},
                            {&host.end, &scene_.end, host.moving ? host.vertices[0] : 0}};
    const auto triangles = static_cast<std::size_t>(host.triangle_count());
    place_arrays(block_, [&](ArenaLayout& c) {
        box_ = c.take<SceneBox>(1);
        for (Vertices& v : vertices) v.data = c.take<std::byte>(bytes_of(*v.from, v.count));
        corners_ = c.take<std::int32_t>(3 * triangles);
        groups_ = c.take<std::int32_t>(host.groups ? triangles : 0);
    });
    SceneBox box;
    for (int axis = 0; axis < 3; ++axis)
        box.low[axis] = ordered(host.low[axis]), box.high[axis] = ordered(host.high[axis]);
    copy(stream_, box_, &box, 1);
    for (const Vertices& v : vertices) {
        copy(stream_, v.data, pack(*v.from, v.count, packed_), bytes_of(*v.from, v.count));
        const auto size = static_cast<std::int64_t>(v.from->scalar_bytes());
        *v.to = {v.data, 3 * size, size, v.from->float32};
    }
    copy(stream_, corners_, host.corners, 3 * triangles);
    if (host.groups) copy(stream_, groups_, host.groups, triangles);
    scene_.corners = corners_;
    scene_.groups = host.groups ? groups_ : nullptr;
    worlds_.bring(stream_, host);
}

void Input::view(const Shape& shape, const CachedMesh& known, Growth growth) {
    forget();
    MeshView mesh(shape.vertices, shape.triangles, shape.groups);
    mesh.memory = MemorySpace::cuda;
    scene_ = outline_scene(mesh, nullptr, MemorySpace::cuda);
    if (shape.end.data) outline_motion(shape.end, scene_);
    worlds_.forget();
    places_.check(shape);
    cached_shape_ = shape;
    known_ = known;
    place_arrays(
        block_, [&](ArenaLayout& c) { box_ = c.take<SceneBox>(1); }, growth);
    scene_.triangles[0] += known.proxies;
    scene_.corners = known.corners;
    scene_.groups = shape.groups.empty() ? nullptr : shape.groups.data();
}

void Input::view(const MeshView& a, const MeshView* b, bool weld, Growth growth) {
    forget();
    scene_ = outline_scene(a, b, MemorySpace::cuda);
    worlds_.forget();
    places_.check(a, b);
    mesh_[0] = a;
    mesh_[1] = b ? std::optional(*b) : std::nullopt;
    weld_ = weld;
    const auto vertices = static_cast<std::size_t>(scene_.vertex_count());
    const auto triangles = static_cast<std::size_t>(scene_.triangle_count());
    const bool as_is = !b && !weld && is_int32_rows(a.triangles);
    const bool any_groups = !a.groups.empty() || (b && !b->groups.empty());
    slots_ = weld ? std::bit_ceil(2 * vertices + 1) : 0;
    const auto cut = [&](ArenaLayout& c) {
        box_ = c.take<SceneBox>(1);
        corners_ = c.take<std::int32_t>(as_is ? 0 : 3 * triangles);
        groups_ = c.take<std::int32_t>(b && any_groups ? triangles : 0);
        table_ = c.take<unsigned>(slots_);
    };
    place_arrays(block_, cut, growth);
    scene_.corners = as_is ? static_cast<const std::int32_t*>(a.triangles.data) : corners_;
    scene_.groups = !any_groups ? nullptr : b ? groups_ : a.groups.data();
}

void Input::pose(std::shared_ptr<const PosedWorlds> worlds, const DevicePoses& poses, bool weld, bool pairs,
                 Growth growth) {
    forget();
    scene_ = worlds->scene();
    worlds_.share(worlds->worlds(), worlds->found());
    if (poses.count > 0) places_.check("poses", poses.data);
    const auto vertices = static_cast<std::size_t>(scene_.vertex_count());
    slots_ = weld ? std::bit_ceil(2 * vertices + 1) : 0;
    const auto cut = [&](ArenaLayout& c) {
        box_ = c.take<SceneBox>(1);
        vertices_ = c.take<std::byte>(worlds->vertex_bytes());
        corners_ = c.take<std::int32_t>(weld ? 3 * static_cast<std::size_t>(scene_.triangle_count()) : 0);
        table_ = c.take<unsigned>(slots_);
    };
    place_arrays(block_, cut, growth);
    const std::int64_t size = scene_.float32 ? sizeof(float) : sizeof(double);
    scene_.reader[0] = {vertices_, 3 * size, size, scene_.float32};
    if (weld) scene_.corners = corners_;
    names_ = worlds->names();
    names_.pairs = pairs;
    weld_ = weld;
    poses_ = poses;
    posed_ = std::move(worlds);
}

void Input::want(const IntersectionQuery& query, Growth growth) {
    if (posed_) {
        wanted_ = posed_->wanted();
        return;
    }
    rule_.prepare(query.filter, scene_.bodies);
    want(rule_, growth);
}

void Input::want(const SceneFilter& rule, Growth growth) {
    wanted_ = rule.wanted();
    const auto bring = [&](Mirror<std::uint64_t>& there, GroupSelection& wanted) {
        const std::span<const std::uint64_t> host(wanted.excluded, static_cast<std::size_t>(wanted.excluded_count));
        wanted.excluded = there.bring(stream_, host, growth);
    };
    bring(excluded_groups_, wanted_.groups);
    bring(excluded_bodies_, wanted_.bodies);
    if (scene_.bodies) wanted_.classes = classes_.bring(stream_, scene_.bodies->classes.span(), growth);
}

void Input::clear(BatchedClear& batch) const {
    if (cached_shape_) cuda::clear(batch, box_);
    if (mesh_[0] || posed_) {
        cuda::clear(batch, box_);
        for (std::size_t side = 0; scene_.between && scene_.groups && side < 2; ++side)
            if (mesh_[side]->groups.empty())
                batch.add(groups_ + (side ? scene_.triangles[0] : 0),
                          static_cast<std::size_t>(scene_.triangles[side]) * sizeof *groups_);
        if (weld_) batch.add(table_, slots_ * sizeof *table_, empty_slot);
    }
}

void Input::join(const Geometry& geometry, cudaStream_t stream, Counters* counters) {
    check_vertices(geometry, stream, scene_, box_, counters);
    if (scene_.corners == corners_) {
        for (std::size_t side = 0; side < (scene_.between ? 2u : 1u); ++side) {
            const auto n = static_cast<std::size_t>(scene_.triangles[side]);
            with_reader(mesh_[side]->triangles, [&](auto reader) {
                Launch{stream, geometry.blocks(3 * n), geometry.threads}(
                    join_kernel<decltype(reader)>, reader, n, scene_.vertices[side], side ? scene_.vertices[0] : 0,
                    corners_ + (side ? 3 * scene_.triangles[0] : 0));
            });
        }
    }
    for (std::size_t side = 0; scene_.between && scene_.groups && side < 2; ++side)
        if (const auto& groups = mesh_[side]->groups; !groups.empty())
            CRUMPLE_CUDA(cudaMemcpyAsync(groups_ + (side ? scene_.triangles[0] : 0), groups.data(), groups.size_bytes(),
                                         cudaMemcpyDeviceToDevice, stream));
    if (weld_) weld(geometry, stream);
}

void Input::pose(const Geometry& geometry, cudaStream_t stream, Counters* counters) {
    posed_->pose(geometry, stream, poses_, vertices_, box_, counters);
    if (!weld_) return;
    const auto corners = 3 * static_cast<std::size_t>(scene_.triangle_count());
    if (corners > 0)
        CRUMPLE_CUDA(cudaMemcpyAsync(corners_, posed_->scene().corners, corners * sizeof *corners_,
                                     cudaMemcpyDeviceToDevice, stream));
    weld(geometry, stream);
}

void Input::weld(const Geometry& geometry, cudaStream_t stream) {
    const Launch over_vertices{stream, geometry.blocks(static_cast<std::size_t>(scene_.vertex_count())),
                               geometry.threads};
    const Launch over_corners{stream, geometry.blocks(3 * static_cast<std::size_t>(scene_.triangle_count())),
                              geometry.threads};
    over_vertices(fill_table_kernel, scene_, hash_, table_, slots_);
    over_corners(weld_kernel, scene_, hash_, table_, slots_, corners_);
}

void Input::enqueue(const Geometry& geometry, cudaStream_t stream, Counters* counters) {
    if (mesh_[0]) join(geometry, stream, counters);
    if (posed_) pose(geometry, stream, counters);
    if (!cached_shape_) return;
    check_vertices(geometry, stream, scene_, box_, counters);
    compare(geometry, stream, *cached_shape_, known_, counters);
}

// Throws the first error in the order in which the host checks meshes.
void Input::throw_error(const Counters& counters) const {
    if (posed_) return posed_->throw_error(stream_, poses_, counters);
    constexpr unsigned long long none = ~0ull;
    if (counters.bad_radius != none) fail_radius("", static_cast<std::int64_t>(counters.bad_radius));
    if (counters.bad_rest != none) fail_not_finite("rest shape: ", static_cast<std::int64_t>(counters.bad_rest));
    for (std::size_t side = 0; side < 2; ++side) {
        const std::string which = mesh_name(scene_, side);
        const unsigned long long vertex = counters.bad_vertex[side], t = counters.bad_triangle[side];
        if (vertex != none) fail_not_finite(which, static_cast<std::int64_t>(vertex));
        if (t == none) continue;
        const TriangleView& view = mesh_[side]->triangles;
        with_index_type(view.type, [&](auto index) {
            std::int64_t wrong = 0;
            for (int corner = 2; corner >= 0; --corner) {
                const auto* row =
                    static_cast<const std::byte*>(view.data) + static_cast<std::int64_t>(t) * view.row_stride;
                CRUMPLE_CUDA(cudaMemcpyAsync(&index, row + corner * view.column_stride, sizeof index,
                                             cudaMemcpyDeviceToHost, stream_));
                CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
                const auto value = static_cast<std::int64_t>(index);
                if (value < 0 || value >= scene_.vertices[side]) wrong = value;
            }
            fail_index(which, static_cast<std::int64_t>(t), wrong, scene_.vertices[side]);
        });
    }
    if (counters.changed != none) throw MeshChanged{};
    if (counters.bad_end != none) fail_not_finite("at the end: ", static_cast<std::int64_t>(counters.bad_end));
}

Input::Work Input::work() const {
    Work work;
    if (cached_shape_) {
        work.triangles[0] = cached_shape_->triangles;
        work.known = known_;
        if (cached_shape_->edges) work.lists[0] = cached_shape_->edges->data();
        if (cached_shape_->points) work.lists[1] = cached_shape_->points->data();
    }
    for (std::size_t side = 0; side < 2; ++side) {
        if (!mesh_[side]) continue;
        work.triangles[side] = mesh_[side]->triangles;
        work.groups[side] = mesh_[side]->groups.data();
    }
    if (posed_) {
        work.poses = poses_.data;
        work.type_of_poses = poses_.type;
        work.bodies = posed_->number();
        work.names = names_;
    }
    work.block = block_.data();
    work.weld = weld_;
    return work;
}

void Input::release() {
    posed_.reset();
    block_.release();
    worlds_.release();
    rule_.release();
    excluded_groups_.release();
    excluded_bodies_.release();
    classes_.release();
    packed_.release();
}

}  // namespace crumple::cuda
