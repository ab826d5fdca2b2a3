#include "distributed/overlaps/gathered_mesh.h"

#include <algorithm>
#include <array>
#include <type_traits>

#include "distributed/transport/exchange_lists.h"

namespace crumple::distribute {

// Sends rows of this rank to the root. reserve(count) allocates those of all ranks; pack(first, rows) writes some
// rows; unpack(first, rows) reads some on the root, numbered in the order of ranks.
template <class Row, class Reserve, class Pack, class Unpack>
void GatheredMesh::send(std::int64_t rows, Reserve reserve, Pack pack, Unpack unpack) {
    const Traffic traffic = traffic_of(
        batches_, [&](std::size_t rank) { return rank == static_cast<std::size_t>(root_) ? rows : std::int64_t{0}; });
    agree_(Phase::rows, [&] { reserve(all(traffic.in)); });
    const std::vector<std::int64_t> first = first_of_each(traffic.in);
    batches_.exchange<Row>(
        traffic, [&](int, std::int64_t begin, std::span<Row> some) { pack(begin, some); },
        [&](int rank, std::int64_t begin, std::span<const Row> some) {
            unpack(first[static_cast<std::size_t>(rank)] + begin, some);
        });
}

void GatheredMesh::gather(const RankMesh& local, bool float32) {
    gather_triangles(local);
    float32 ? gather_vertices<float>(local) : gather_vertices<double>(local);
}

void GatheredMesh::gather_triangles(const RankMesh& local) {
    struct Triangle {
        std::int32_t id;
        std::array<std::int32_t, 3> corners;
    };
    const PreparedScene& scene = local.scene();
    const auto reserve = [&](std::size_t) {
        if (!is_root()) return;
        const auto count = static_cast<std::size_t>(3 * local.triangles().all);
        memory_.add(count * sizeof corners_[0]);
        corners_.resize(count);
    };
    const auto pack = [&](std::int64_t first, std::span<Triangle> rows) {
        for (Triangle& row : rows) {
            row.id = local.triangles()(first);
            for (std::size_t k = 0; k < 3; ++k)
                row.corners[k] = local.vertices()(scene.corners[3 * first + static_cast<std::int64_t>(k)]);
            ++first;
        }
    };
    const auto unpack = [&](std::int64_t, std::span<const Triangle> rows) {
        for (const Triangle& row : rows)
            std::copy(row.corners.begin(), row.corners.end(), corners_.begin() + 3 * std::ptrdiff_t{row.id});
    };
    send<Triangle>(scene.triangle_count(), reserve, pack, unpack);
}

// Copies of a ghost vertex are equal, so all of them are sent and the last one stays.
template <class Scalar>
void GatheredMesh::gather_vertices(const RankMesh& local) {
    struct Vertex {
        std::int32_t id;
        std::array<Scalar, 3> position;
    };
    const PreparedScene& scene = local.scene();
    const auto reserve = [&](std::size_t) {
        if (!is_root()) return;
        const auto count = static_cast<std::size_t>(3 * local.vertices().all);
        memory_.add(count * sizeof(Scalar));
        vertices_ = std::vector<Scalar>(count);
    };
    const auto pack = [&](std::int64_t first, std::span<Vertex> rows) {
        for (Vertex& row : rows) {
            row.id = local.vertices()(first);
            const Vec3d p = scene.position(first++);
            row.position = {static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)};
        }
    };
    const auto unpack = [&](std::int64_t, std::span<const Vertex> rows) {
        auto& vertices = std::get<std::vector<Scalar>>(vertices_);
        for (const Vertex& row : rows)
            std::copy(row.position.begin(), row.position.end(), vertices.begin() + 3 * std::ptrdiff_t{row.id});
    };
    send<Vertex>(scene.vertex_count(), reserve, pack, unpack);
}

void GatheredMesh::gather(std::span<const Pair> pairs) {
    const auto reserve = [&](std::size_t count) { pairs_.resize_discard(count); };
    const auto pack = [&](std::int64_t first, std::span<Pair> rows) {
        std::copy_n(pairs.begin() + first, rows.size(), rows.begin());
    };
    const auto unpack = [&](std::int64_t first, std::span<const Pair> rows) {
        std::copy(rows.begin(), rows.end(), pairs_.begin() + first);
    };
    send<Pair>(static_cast<std::int64_t>(pairs.size()), reserve, pack, unpack);
}

MeshView GatheredMesh::view() const {
    return std::visit(
        [&](const auto& xyz) {
            return MeshView(xyz.data(), static_cast<std::int64_t>(xyz.size() / 3), corners_.data(),
                            static_cast<std::int64_t>(corners_.size() / 3));
        },
        vertices_);
}

}  // namespace crumple::distribute
