#include "distributed/overlaps/body_copies.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "distributed/by_part.h"
#include "distributed/transport/exchange_lists.h"

namespace crumple::distribute {

std::int32_t BodyCopies::place_of(std::int32_t number) const {
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), number);
    return at == ids_.end() || *at != number ? -1 : static_cast<std::int32_t>(at - ids_.begin());
}

void BodyCopies::exchange(MessageBatches& batches, CollectiveCheck& agree, const Bodies& bodies,
                          const PairsOfBodies& pairs) {
    Transport& transport = batches.transport();
    agree(Phase::memory, [&] { list_leaving(bodies, pairs, transport.size(), transport.rank()); });
    const Traffic traffic = traffic_of(batches, [&](std::size_t r) { return leaving_[r].size(); });
    const Traffic of_shapes = traffic_of(batches, [&](std::size_t r) { return leaving_shapes_[r].size(); });
    agree(Phase::memory, [&] {
        coming_.resize(all(traffic.in));
        coming_shapes_.resize(all(of_shapes.in));
        const std::vector<std::int64_t> first_shape = first_of_each(of_shapes.in);
        for (std::size_t r = 0; r < traffic.in.size(); ++r)
            coming_first_shape_.insert(coming_first_shape_.end(), static_cast<std::size_t>(traffic.in[r]),
                                       first_shape[r]);
    });
    exchange_lists(
        batches, traffic, [&](std::size_t r) -> auto& { return leaving_[r]; }, coming_);
    const auto shape_of = [&](std::int32_t s) -> const Shape& {
        return bodies.local().world().shapes[static_cast<std::size_t>(s)];
    };
    const auto is_float32 = [](const Shape& shape) { return shape.vertices.type == ScalarType::float32; };
    std::vector<std::vector<ShapeRow>> rows;
    agree(Phase::memory, [&] {
        rows.resize(leaving_shapes_.size());
        for (std::size_t r = 0; r < rows.size(); ++r)
            for (const std::int32_t s : leaving_shapes_[r])
                rows[r].push_back({shape_of(s).vertices.rows, shape_of(s).triangles.rows, is_float32(shape_of(s))});
    });
    exchange_lists(
        batches, of_shapes, [&](std::size_t r) -> auto& { return rows[r]; }, coming_shapes_);
    const auto vertices_if = [&](bool float32) {
        return [&, float32](const Shape& shape) { return is_float32(shape) == float32 ? shape.vertices.rows : 0; };
    };
    const auto read_as = [](auto scalar) {
        return [](const Shape& shape, std::int64_t first, auto rows_of_shape) {
            const VertexReader position = reader_of(shape);
            for (auto& row : rows_of_shape) {
                const Vec3d p = position(first++);
                row = {static_cast<decltype(scalar)>(p.x), static_cast<decltype(scalar)>(p.y),
                       static_cast<decltype(scalar)>(p.z)};
            }
        };
    };
    exchange_rows(batches, agree, bodies, vertices_if(true), read_as(float{}), floats_);
    exchange_rows(batches, agree, bodies, vertices_if(false), read_as(double{}), doubles_);
    const auto read_corners = [](const Shape& shape, std::int64_t first, std::span<Corners> triangles) {
        with_corner_reader(shape, [&](auto corner) {
            for (std::size_t i = 0; i < triangles.size(); ++i)
                for (int k = 0; k < 3; ++k)
                    triangles[i][static_cast<std::size_t>(k)] =
                        static_cast<std::int32_t>(corner(first + static_cast<std::int64_t>(i), k));
        });
    };
    exchange_rows(
        batches, agree, bodies, [](const Shape& shape) { return shape.triangles.rows; }, read_corners, corners_);
    agree(Phase::memory, [&] {
        read_local(bodies, pairs, transport.rank());
        add_copies(pairs);
    });
}

// Lists what this rank sends to each other rank.
void BodyCopies::list_leaving(const Bodies& bodies, const PairsOfBodies& pairs, int ranks, int rank) {
    const WorldOutline& local = bodies.local();
    leaving_.assign(static_cast<std::size_t>(ranks), {});
    leaving_shapes_.assign(static_cast<std::size_t>(ranks), {});
    std::map<std::int32_t, std::int32_t> local_body;  // by number over all ranks
    for (std::int32_t b = 0; b < local.bodies(); ++b) local_body[bodies.number_of(b)] = b;
    std::map<std::pair<int, std::int32_t>, std::int32_t> sent;  // by rank and local shape: index among those sent
    for (const auto& [to, id] : pairs.destinations(bodies, rank)) {
        const std::int32_t b = local_body.at(id), shape = local.body(b).shape;
        std::vector<std::int32_t>& shapes = leaving_shapes_[static_cast<std::size_t>(to)];
        const auto [at, is_new] = sent.try_emplace({to, shape}, static_cast<std::int32_t>(shapes.size()));
        if (is_new) shapes.push_back(shape);
        const auto& poses = local.world().poses;
        leaving_[static_cast<std::size_t>(to)].push_back(
            {id, at->second, poses.empty() ? Pose{} : poses[static_cast<std::size_t>(b)]});
    }
}

// Exchanges one list of rows for each shape: count(shape) rows, which read(shape, first row, rows) reads.
template <class Row, class Count, class Read>
void BodyCopies::exchange_rows(MessageBatches& batches, CollectiveCheck& agree, const Bodies& bodies, Count count,
                               Read read, std::vector<Row>& coming) {
    std::vector<ByPart> rows(leaving_shapes_.size());
    const auto shape_of = [&](std::size_t rank, std::size_t i) -> const Shape& {
        return bodies.local().world().shapes[static_cast<std::size_t>(leaving_shapes_[rank][i])];
    };
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t i = 0; i < leaving_shapes_[r].size(); ++i) rows[r].add(count(shape_of(r, i)));
    const Traffic traffic = traffic_of(batches, [&](std::size_t r) { return rows[r].rows(); });
    agree(Phase::memory, [&] {
        memory_.add(all(traffic.in) * sizeof(Row));
        coming.resize(all(traffic.in));
    });
    const std::vector<std::int64_t> first = first_of_each(traffic.in);
    batches.exchange<Row>(
        traffic,
        [&](int rank, std::int64_t begin, std::span<Row> some) {
            const auto r = static_cast<std::size_t>(rank);
            rows[r].visit(begin, some.size(), [&](std::size_t i, std::int64_t of_shape, std::size_t at, std::size_t n) {
                read(shape_of(r, i), of_shape, some.subspan(at, n));
            });
        },
        [&](int rank, std::int64_t begin, std::span<const Row> some) {
            std::copy(some.begin(), some.end(),
                      coming.begin() + static_cast<std::ptrdiff_t>(first[static_cast<std::size_t>(rank)] + begin));
        });
}

// Adds the local bodies that are in pairs of this rank. All local shapes come first, in their order, so that their
// surfaces stay cached.
void BodyCopies::read_local(const Bodies& bodies, const PairsOfBodies& pairs, int rank) {
    std::vector<std::int32_t> searched;
    for (const auto& [a, b] : pairs.pairs_of(rank)) searched.insert(searched.end(), {a, b});
    std::sort(searched.begin(), searched.end());
    const WorldOutline& local = bodies.local();
    for (const Shape& shape : local.world().shapes) shapes_.emplace_back(shape.vertices, shape.triangles);
    for (std::int32_t b = 0; b < local.bodies(); ++b) {
        const std::int32_t id = bodies.number_of(b);
        if (!std::binary_search(searched.begin(), searched.end(), id)) continue;
        const auto& poses = local.world().poses;
        ids_.push_back(id);
        bodies_.push_back({.shape = local.body(b).shape, .group = pairs.row(id).group});
        poses_.push_back(poses.empty() ? Pose{} : poses[static_cast<std::size_t>(b)]);
    }
}

// Adds the copies of bodies of other ranks, and sorts all bodies by their numbers over all ranks.
void BodyCopies::add_copies(const PairsOfBodies& pairs) {
    const auto first_copy = static_cast<std::int64_t>(shapes_.size());
    std::size_t floats = 0, doubles = 0, corners = 0;
    for (const ShapeRow& shape : coming_shapes_) {
        const TriangleView triangles =
            rows_of_three(corners_.empty() ? nullptr : corners_[0].data() + 3 * corners, shape.triangles);
        const VertexView vertices =
            shape.float32
                ? rows_of_three(floats_.empty() ? nullptr : floats_[0].data() + 3 * floats, shape.vertices)
                : rows_of_three(doubles_.empty() ? nullptr : doubles_[0].data() + 3 * doubles, shape.vertices);
        shapes_.emplace_back(vertices, triangles);
        corners += static_cast<std::size_t>(shape.triangles);
        (shape.float32 ? floats : doubles) += static_cast<std::size_t>(shape.vertices);
    }
    for (std::size_t i = 0; i < coming_.size(); ++i) {
        const BodyRow& body = coming_[i];
        const std::int64_t shape = first_copy + coming_first_shape_[i] + body.shape;
        ids_.push_back(body.id);
        bodies_.push_back({.shape = static_cast<std::int32_t>(shape), .group = pairs.row(body.id).group});
        poses_.push_back(body.pose);
    }
    std::vector<std::size_t> order(ids_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return ids_[i] < ids_[j]; });
    const auto sort_by_number = [&](auto& list) {
        auto sorted = list;
        for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = list[order[i]];
        list = std::move(sorted);
    };
    sort_by_number(bodies_);
    sort_by_number(poses_);
    sort_by_number(ids_);
}

}  // namespace crumple::distribute
