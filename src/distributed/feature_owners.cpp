#include "distributed/feature_owners.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace crumple::distribute {
namespace {

constexpr std::int32_t nobody = std::numeric_limits<std::int32_t>::max();

/// Side of a triangle, from its lower vertex to the higher one.
struct TriangleSide {
    std::int32_t low, high, triangle, side;
    auto key() const { return std::tuple(low, high, triangle, side); }
};
struct Numbered {
    std::int32_t edge, owned;
};

// Sends row(element) for each element to its directory rank, calls consume(rows) there with all received rows, and
// sends reply(index of the received row) back, which take(element, reply) consumes. Collective.
template <class Row, class Reply, class MakeRow, class Consume, class MakeReply, class Take>
void query_directory_ranks(MessageBatches& batches, CollectiveCheck& agree, const std::vector<std::int64_t>& first,
                           const std::vector<std::int32_t>& elements, MakeRow row, Consume consume, MakeReply reply,
                           Take take) {
    Traffic there(batches.transport().size());
    for (std::size_t r = 0; r < there.out.size(); ++r) there.out[r] = first[r + 1] - first[r];
    batches.transport().all_to_all(there.out, there.in);
    std::vector<std::int64_t> from(1, 0);
    for (const std::int64_t n : there.in) from.push_back(from.back() + n);
    std::vector<Row> rows;
    agree(Phase::ids, [&] { rows.resize(static_cast<std::size_t>(from.back())); });
    const auto element = [&](int rank, std::int64_t i) {
        return elements[static_cast<std::size_t>(first[static_cast<std::size_t>(rank)] + i)];
    };
    const auto place = [&](int rank, std::int64_t i) {
        return static_cast<std::size_t>(from[static_cast<std::size_t>(rank)] + i);
    };
    batches.exchange<Row>(
        there,
        [&](int rank, std::int64_t begin, std::span<Row> some) {
            for (std::size_t i = 0; i < some.size(); ++i)
                some[i] = row(element(rank, begin + static_cast<std::int64_t>(i)));
        },
        [&](int rank, std::int64_t begin, std::span<const Row> some) {
            std::copy(some.begin(), some.end(), rows.begin() + static_cast<std::ptrdiff_t>(place(rank, begin)));
        });
    consume(rows);
    Traffic back(batches.transport().size());
    back.out = there.in, back.in = there.out;
    batches.exchange<Reply>(
        back,
        [&](int rank, std::int64_t begin, std::span<Reply> some) {
            for (std::size_t i = 0; i < some.size(); ++i) some[i] = reply(place(rank, begin) + i);
        },
        [&](int rank, std::int64_t begin, std::span<const Reply> some) {
            for (std::size_t i = 0; i < some.size(); ++i)
                take(element(rank, begin + static_cast<std::int64_t>(i)), some[i]);
        });
}

}  // namespace

void FeatureOwners::learn(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local,
                          const GhostVertices& copies) {
    known_ = false;
    agree(Phase::ids, [&] { of_.assign(static_cast<std::size_t>(local.scene().triangle_count()), {}); });
    own_vertices(batches, agree, local, copies);
    own_edges(batches, agree, local);
    known_ = true;
}

// Finds the lowest triangle at each vertex. Only ghost vertices need the directory: all triangles at any other vertex
// are on this rank.
void FeatureOwners::own_vertices(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local,
                                 const GhostVertices& copies) {
    struct Least {
        std::int32_t vertex, triangle;
    };
    const PreparedScene& scene = local.scene();
    const std::int64_t n = scene.vertex_count(), m = scene.triangle_count();
    std::vector<std::int32_t> least;
    ByDirectoryRank shared;
    agree(Phase::ids, [&] {
        least.assign(static_cast<std::size_t>(n), nobody);
        for (std::int64_t i = 0; i < 3 * m; ++i) {
            std::int32_t& of = least[static_cast<std::size_t>(scene.corners[i])];
            of = std::min(of, local.triangles()(i / 3));
        }
        std::vector<std::uint8_t> chosen(static_cast<std::size_t>(n), 0);
        for (std::int64_t v = 0; v < n; ++v)
            chosen[static_cast<std::size_t>(v)] = copies.shared(static_cast<std::int32_t>(v));
        shared = ByDirectoryRank(local.vertices(), n, &chosen, batches.transport().size());
    });
    if (copies.any()) {
        const std::int64_t begin =
            ByDirectoryRank::block(local.vertices().all, batches.transport().size()) * batches.transport().rank();
        std::vector<std::int32_t> of_block, block_of_row;
        query_directory_ranks<Least, std::int32_t>(
            batches, agree, shared.first, shared.element,
            [&](std::int32_t v) {
                return Least{local.vertices()(v), least[static_cast<std::size_t>(v)]};
            },
            [&](const std::vector<Least>& rows) {
                agree(Phase::ids, [&] {
                    of_block.assign(static_cast<std::size_t>(
                                        ByDirectoryRank::block(local.vertices().all, batches.transport().size())),
                                    nobody);
                    for (const Least& row : rows) {
                        block_of_row.push_back(static_cast<std::int32_t>(row.vertex - begin));
                        std::int32_t& of = of_block[static_cast<std::size_t>(block_of_row.back())];
                        of = std::min(of, row.triangle);
                    }
                });
            },
            [&](std::size_t row) { return of_block[static_cast<std::size_t>(block_of_row[row])]; },
            [&](std::int32_t v, std::int32_t triangle) { least[static_cast<std::size_t>(v)] = triangle; });
    }
    for (std::int64_t t = 0; t < m; ++t)
        for (int k = 0; k < 3; ++k) {
            const std::int32_t* c = scene.corners + 3 * t;
            // Compares ids, since a rank may list a vertex twice.
            const auto id = [&](int corner) { return local.vertices()(c[corner]); };
            const bool again = (k > 0 && id(k) == id(0)) || (k > 1 && id(k) == id(1));
            if (!again && least[static_cast<std::size_t>(c[k])] == local.triangles()(t))
                of_[static_cast<std::size_t>(t)].owned |= 1 << k;
        }
}

void FeatureOwners::own_edges(MessageBatches& batches, CollectiveCheck& agree, const RankMesh& local) {
    const PreparedScene& scene = local.scene();
    const int ranks = batches.transport().size();
    const std::int64_t m = scene.triangle_count(),
                       per = std::max<std::int64_t>(1, ByDirectoryRank::block(local.vertices().all, ranks));
    const auto side_of = [&](std::int32_t slot) {
        const std::int32_t t = slot / 3, k = slot % 3;
        const std::int32_t a = local.vertices()(scene.corners[3 * std::int64_t{t} + k]),
                           b = local.vertices()(scene.corners[3 * std::int64_t{t} + (k + 1) % 3]);
        return TriangleSide{std::min(a, b), std::max(a, b), local.triangles()(t), k};
    };
    std::vector<std::int64_t> first;
    std::vector<std::int32_t> slots;
    agree(Phase::ids, [&] {
        if (m > nobody / 3)
            throw Error(ErrorCode::invalid_argument,
                        "a rank can have at most 715827882 triangles in a query about features; use more ranks");
        first.assign(static_cast<std::size_t>(ranks) + 1, 0);
        const auto each = [&](auto visit) {
            for (std::int32_t slot = 0; slot < 3 * m; ++slot) {
                const TriangleSide side = side_of(slot);
                if (side.low != side.high) visit(slot, static_cast<std::size_t>(side.low / per));
            }
        };
        each([&](std::int32_t, std::size_t keeper) { ++first[keeper + 1]; });
        for (std::size_t r = 0; r + 1 < first.size(); ++r) first[r + 1] += first[r];
        slots.resize(static_cast<std::size_t>(first.back()));
        std::vector<std::int64_t> next(first.begin(), first.end() - 1);
        each([&](std::int32_t slot, std::size_t keeper) { slots[static_cast<std::size_t>(next[keeper]++)] = slot; });
    });
    std::vector<Numbered> numbered;
    query_directory_ranks<TriangleSide, Numbered>(
        batches, agree, first, slots, side_of,
        [&](const std::vector<TriangleSide>& sides) {
            std::vector<std::int32_t> order;
            std::vector<std::int64_t> edges(static_cast<std::size_t>(ranks), 0);
            agree(Phase::ids, [&] {
                if (sides.size() > static_cast<std::size_t>(nobody))
                    throw Error(ErrorCode::invalid_argument,
                                "a rank has more than 2147483647 sides of triangles in the distributed directory; use "
                                "more ranks");
                numbered.resize(sides.size());
                order.resize(sides.size());
                for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
                const auto at = [&](std::int32_t i) -> const TriangleSide& {
                    return sides[static_cast<std::size_t>(i)];
                };
                std::sort(order.begin(), order.end(),
                          [&](std::int32_t i, std::int32_t j) { return at(i).key() < at(j).key(); });
                std::int32_t edge = -1;
                for (std::size_t i = 0; i < order.size(); ++i) {
                    const TriangleSide& side = at(order[i]);
                    const bool is_first =
                        i == 0 || at(order[i - 1]).low != side.low || at(order[i - 1]).high != side.high;
                    edge += is_first;
                    numbered[static_cast<std::size_t>(order[i])] = {edge, is_first};
                }
                edges[static_cast<std::size_t>(batches.transport().rank())] = edge + 1;
            });
            batches.transport().reduce(edges, Reduction::sum);
            agree(Phase::ids, [&] {
                if (std::accumulate(edges.begin(), edges.end(), std::int64_t{0}) > nobody)
                    throw Error(ErrorCode::invalid_argument, "there are more than 2147483647 edges over all ranks");
            });
            std::int64_t before = 0;
            for (int r = 0; r < batches.transport().rank(); ++r) before += edges[static_cast<std::size_t>(r)];
            for (Numbered& of : numbered) of.edge += static_cast<std::int32_t>(before);
        },
        [&](std::size_t row) { return numbered[row]; },
        [&](std::int32_t slot, const Numbered& reply) {
            if (!reply.owned) return;
            OwnedFeatures& of = of_[static_cast<std::size_t>(slot / 3)];
            of.owned |= 8 << slot % 3;
            of.edges[static_cast<std::size_t>(slot % 3)] = reply.edge;
        });
}

}  // namespace crumple::distribute
