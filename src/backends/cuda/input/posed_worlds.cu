#include "backends/cuda/input/posed_worlds.h"

#include <algorithm>
#include <atomic>
#include <type_traits>
#include <utility>
#include <vector>

#include "backends/cuda/stages/scene_box.h"

namespace crumple::cuda {
namespace {

/// Number of vertices per tile. The host lists the body of each tile's first vertex, which shortens the search for the
/// bodies of the others.
constexpr std::size_t pose_tile = 256;

struct WorldBodies {
    const StaticBody* body;
    const std::uint32_t* first;  ///< body of each tile's first vertex; and the last body
    std::size_t vertices;

    /// Returns the body that contains vertex v: the last one with first_vertex <= v.
    __device__ StaticBody of(std::size_t v) const {
        std::uint32_t begin = first[v / pose_tile], end = first[v / pose_tile + 1] + 1;
        while (end - begin > 1) {
            const std::uint32_t middle = (begin + end) / 2;
            if (body[middle].first_vertex <= v)
                begin = middle;
            else
                end = middle;
        }
        return body[begin];
    }
};

// Applies a pose as Placement does (scene/placement.h): the identity leaves a vertex as it is.
template <class P>
__device__ Vec3d posed(const P* rows, const Vec3d& p) {
    Vec3d out;
    bool identity = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = rows[4 * axis], b = rows[4 * axis + 1], c = rows[4 * axis + 2], t = rows[4 * axis + 3];
        out[axis] = ((a * p.x + b * p.y) + c * p.z) + t;
        identity = identity && a == (axis == 0) && b == (axis == 1) && c == (axis == 2) && t == 0;
    }
    return identity ? p : out;
}

// Poses the vertices, one per thread. T: scalar type of the scene; P: scalar type of the poses.
template <class T, class P>
__global__ void pose_kernel(WorldBodies bodies, const T* shapes, const P* poses, T* vertices, SceneBox* box,
                            Counters* counters) {
    auto& shared = dynamic_shared<BoxShared>();
    constexpr double most = 1.7976931348623157e308;
    Vec3d low{most, most, most}, high{-most, -most, -most};
    for (std::size_t v = grid_thread(); v < bodies.vertices; v += grid_stride()) {
        const StaticBody body = bodies.of(v);
        const T* const given = shapes + 3 * (std::size_t{body.shape_vertex} + (v - body.first_vertex));
        const Vec3d at =
            posed(poses + 12 * static_cast<std::size_t>(body.body),
                  Vec3d{static_cast<double>(given[0]), static_cast<double>(given[1]), static_cast<double>(given[2])});
        const bool rounded = std::is_same_v<T, float> || body.float32 != 0;
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            p[axis] = rounded ? static_cast<double>(static_cast<float>(at[axis])) : at[axis];
            vertices[3 * v + static_cast<std::size_t>(axis)] = static_cast<T>(p[axis]);
        }
        // NaN and infinities fail these comparisons.
        if (!(std::abs(p.x) <= most && std::abs(p.y) <= most && std::abs(p.z) <= most)) {
            atomicMin(&counters->bad_vertex[0], static_cast<unsigned long long>(v));
            continue;
        }
        low = min(low, p);
        high = max(high, p);
    }
    widen(box, low, high, shared);
}

std::atomic<std::uint64_t> made{0};

// Returns the body of the first vertex of each tile; and the last body.
std::vector<std::uint32_t> first_bodies(std::span<const StaticBody> bodies, std::size_t vertices) {
    const std::size_t tiles = (vertices + pose_tile - 1) / pose_tile;
    std::vector<std::uint32_t> first(tiles + 1, static_cast<std::uint32_t>(bodies.empty() ? 0 : bodies.size() - 1));
    std::size_t b = 0;
    for (std::size_t tile = 0; tile < tiles; ++tile) {
        while (b + 1 < bodies.size() && bodies[b + 1].first_vertex <= tile * pose_tile) ++b;
        first[tile] = static_cast<std::uint32_t>(b);
    }
    return first;
}

}  // namespace

PosedWorlds::PosedWorlds(std::unique_ptr<StaticWorlds> static_worlds, cudaStream_t stream, MemoryMeter& meter)
    : static_worlds_(std::move(static_worlds)), block_(meter), scene_(static_worlds_->scene()), number_(++made) {
    const auto triangles = static_cast<std::size_t>(scene_.triangle_count());
    const auto worlds = static_cast<std::size_t>(scene_.worlds);
    const bool several = worlds > 1;
    const BodyFilter& rules = static_worlds_->rules();
    const std::vector<std::uint32_t> first =
        first_bodies(static_worlds_->bodies(), static_cast<std::size_t>(scene_.vertex_count()));
    std::vector<unsigned long long> first_of_joined, count;
    for (std::size_t w = 0; several && w <= worlds; ++w)
        first_of_joined.push_back(static_cast<unsigned long long>(scene_.first_of_world[w]));
    for (std::size_t w = 0; several && w < worlds; ++w) count.push_back(first_of_joined[w + 1] - first_of_joined[w]);
    wanted_ = rules.wanted();
    std::int32_t *corners = nullptr, *groups = nullptr, *first_of_class = nullptr;
    std::int64_t* first_of_world = nullptr;
    BodyClass* classes = nullptr;
    std::uint64_t *bodies_apart = nullptr, *groups_apart = nullptr;
    place_arrays(block_, [&](ArenaLayout& c) {
        shapes_ = c.take<std::byte>(static_worlds_->shape_bytes());
        bodies_ = c.take<StaticBody>(static_worlds_->bodies().size());
        first_body_ = c.take<std::uint32_t>(first.size());
        corners = c.take<std::int32_t>(3 * triangles);
        groups = c.take<std::int32_t>(triangles);
        classes = c.take<BodyClass>(rules.classes.size());
        first_of_class = c.take<std::int32_t>(static_worlds_->first_of_class().size());
        first_of_world = c.take<std::int64_t>(static_worlds_->first_of_world().size());
        bodies_apart = c.take<std::uint64_t>(static_cast<std::size_t>(wanted_.bodies.excluded_count));
        groups_apart = c.take<std::uint64_t>(static_cast<std::size_t>(wanted_.groups.excluded_count));
        worlds_ = {c.take<unsigned long long>(first_of_joined.size()), c.take<unsigned long long>(count.size())};
        found_ = c.take<unsigned long long>(count.size());
    });
    const auto bring = [&](auto* to, const auto* from, std::size_t n) {
        copy_now(stream, to, from, n, cudaMemcpyHostToDevice);
    };
    bring(shapes_, static_worlds_->shape_vertices(), static_worlds_->shape_bytes());
    bring(bodies_, static_worlds_->bodies().data(), static_worlds_->bodies().size());
    bring(first_body_, first.data(), first.size());
    bring(corners, scene_.corners, 3 * triangles);
    bring(groups, scene_.groups, triangles);
    bring(classes, rules.classes.data(), rules.classes.size());
    bring(first_of_class, static_worlds_->first_of_class().data(), static_worlds_->first_of_class().size());
    bring(first_of_world, static_worlds_->first_of_world().data(), static_worlds_->first_of_world().size());
    bring(bodies_apart, wanted_.bodies.excluded, static_cast<std::size_t>(wanted_.bodies.excluded_count));
    bring(groups_apart, wanted_.groups.excluded, static_cast<std::size_t>(wanted_.groups.excluded_count));
    bring(worlds_.first, first_of_joined.data(), first_of_joined.size());
    bring(worlds_.count, count.data(), count.size());
    if (!several) worlds_ = {}, found_ = nullptr;
    scene_.corners = corners;
    scene_.groups = groups;
    scene_.reader = {};
    scene_.reader[0].float32 = scene_.float32;
    scene_.low = scene_.high = {};
    wanted_.bodies.excluded = bodies_apart;
    wanted_.groups.excluded = groups_apart;
    wanted_.classes = classes;
    names_ = {groups, classes, first_of_class, first_of_world, static_worlds_->worlds(), false};
    static_worlds_->drop_lists();
}

std::size_t PosedWorlds::vertex_bytes() const {
    return 3 * static_cast<std::size_t>(scene_.vertex_count()) * (scene_.float32 ? sizeof(float) : sizeof(double));
}

void PosedWorlds::pose(const Geometry& geometry, cudaStream_t stream, const DevicePoses& poses, std::byte* vertices,
                       SceneBox* box, Counters* counters) const {
    const auto n = static_cast<std::size_t>(scene_.vertex_count());
    const Launch launch{stream, geometry.blocks(n), geometry.threads, sizeof(BoxShared)};
    const auto run = [&]<class T, class P>() {
        launch(pose_kernel<T, P>, WorldBodies{bodies_, first_body_, n}, reinterpret_cast<const T*>(shapes_),
               static_cast<const P*>(poses.data), reinterpret_cast<T*>(vertices), box, counters);
    };
    const auto run_for = [&]<class T>() {
        poses.type == ScalarType::float32 ? run.template operator()<T, float>() : run.template operator()<T, double>();
    };
    scene_.float32 ? run_for.template operator()<float>() : run_for.template operator()<double>();
}

void PosedWorlds::throw_error(cudaStream_t stream, const DevicePoses& poses, const Counters& counters) const {
    if (counters.bad_vertex[0] == ~0ull) return;
    static_worlds_->fail_not_finite(static_cast<std::int64_t>(counters.bad_vertex[0]), to_host(stream, poses));
}

std::vector<Pose> to_host(cudaStream_t stream, const DevicePoses& poses) {
    std::vector<Pose> host(static_cast<std::size_t>(poses.count));
    const auto read = [&]<class P>() {
        std::vector<P> numbers(12 * host.size());
        copy_now(stream, numbers.data(), static_cast<const P*>(poses.data), numbers.size(), cudaMemcpyDeviceToHost);
        for (std::size_t i = 0; i < numbers.size(); ++i) host[i / 12].rows[i % 12] = static_cast<double>(numbers[i]);
    };
    poses.type == ScalarType::float32 ? read.template operator()<float>() : read.template operator()<double>();
    return host;
}

}  // namespace crumple::cuda
