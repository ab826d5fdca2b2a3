#include "distributed/directory.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <type_traits>

#include "crumple/error.h"
#include "distributed/transport/exchange_lists.h"

namespace crumple::distribute {
namespace {

[[noreturn]] void refuse(const std::string& what, Element element, std::int64_t id) {
    throw Error(ErrorCode::invalid_argument, what, element, id);
}

Traffic traffic_of(MessageBatches& batches, const ByDirectoryRank& elements) {
    const int ranks = batches.transport().size();
    Traffic traffic(ranks);
    for (std::size_t r = 0; r < traffic.out.size(); ++r) traffic.out[r] = elements.first[r + 1] - elements.first[r];
    batches.transport().all_to_all(traffic.out, traffic.in);
    return traffic;
}

// Sends ids to their directory ranks. Fills the last argument with the ids that all ranks send to this one, in the
// order of the ranks.
void exchange_ids(MessageBatches& batches, const ByDirectoryRank& elements, const Ids& ids, const Traffic& traffic,
                  const std::vector<std::int64_t>& from, std::vector<std::int32_t>& received) {
    batches.exchange<std::int32_t>(
        traffic,
        [&](int rank, std::int64_t first, std::span<std::int32_t> rows) {
            const auto begin = static_cast<std::size_t>(elements.first[static_cast<std::size_t>(rank)] + first);
            for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = ids(elements.element[begin + i]);
        },
        [&](int rank, std::int64_t first, std::span<const std::int32_t> rows) {
            std::copy(rows.begin(), rows.end(),
                      received.begin() + static_cast<std::ptrdiff_t>(from[static_cast<std::size_t>(rank)] + first));
        });
}

// Returns the bits of a position: unlike numbers, they distinguish -0 from +0.
template <class Scalar>
auto bits_of(const std::array<Scalar, 3>& position) {
    using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
    return std::bit_cast<std::array<Bits, 3>>(position);
}

int rank_of_row(const std::vector<std::int64_t>& first, std::int64_t row) {
    return static_cast<int>(std::upper_bound(first.begin(), first.end(), row) - first.begin()) - 1;
}

}  // namespace

ByDirectoryRank::ByDirectoryRank(const Ids& ids, std::int64_t count, const std::vector<std::uint8_t>* chosen, int ranks)
    : first(static_cast<std::size_t>(ranks) + 1, 0) {
    const std::int64_t per = std::max<std::int64_t>(1, block(ids.all, ranks));
    const auto keeper = [&](std::int64_t i) { return static_cast<std::size_t>(ids(i) / per); };
    const auto is_chosen = [&](std::int64_t i) { return !chosen || (*chosen)[static_cast<std::size_t>(i)]; };
    for (std::int64_t i = 0; i < count; ++i)
        if (is_chosen(i)) ++first[keeper(i) + 1];
    for (std::size_t r = 0; r + 1 < first.size(); ++r) first[r + 1] += first[r];
    element.resize(static_cast<std::size_t>(first.back()));
    std::vector<std::int64_t> next(first.begin(), first.end() - 1);
    for (std::int64_t i = 0; i < count; ++i)
        if (is_chosen(i)) element[static_cast<std::size_t>(next[keeper(i)]++)] = static_cast<std::int32_t>(i);
}

// There are as many ids as triangles, all in range: if none occurs twice, none is missing.
void check_each_once(MessageBatches& batches, CollectiveCheck& agree, const Ids& ids, std::int64_t count) {
    const int ranks = batches.transport().size();
    ByDirectoryRank elements;
    agree(Phase::ids, [&] { elements = ByDirectoryRank(ids, count, nullptr, ranks); });
    const Traffic traffic = traffic_of(batches, elements);
    const std::vector<std::int64_t> from = first_of_each(traffic.in);
    std::vector<std::int32_t> received, seen;
    const std::int64_t per = ByDirectoryRank::block(ids.all, ranks), begin = per * batches.transport().rank();
    agree(Phase::ids, [&] {
        received.resize(static_cast<std::size_t>(from.back()));
        seen.assign(static_cast<std::size_t>(per), -1);
    });
    exchange_ids(batches, elements, ids, traffic, from, received);
    agree(Phase::ids, [&] {
        std::int64_t twice = ids.all;
        std::array<int, 2> by{};
        for (std::size_t i = 0; i < received.size(); ++i) {
            std::int32_t& first = seen[static_cast<std::size_t>(received[i] - begin)];
            if (first >= 0 && received[i] < twice)
                twice = received[i], by = {rank_of_row(from, first), rank_of_row(from, static_cast<std::int64_t>(i))};
            if (first < 0) first = static_cast<std::int32_t>(i);
        }
        if (twice < ids.all)
            refuse("triangle " + std::to_string(twice) + " is provided twice, by rank " + std::to_string(by[0]) +
                       " and by rank " + std::to_string(by[1]),
                   Element::triangle, twice);
    });
}

void GhostVertices::learn(MessageBatches& batches, CollectiveCheck& agree, const Ids& ids, std::int64_t count) {
    any_ = false;
    all_ = ids.all;
    shared_.clear();
    kept_.clear();
    if (!ids.are_given()) return;
    const int ranks = batches.transport().size();
    block_size_ = ByDirectoryRank::block(ids.all, ranks);
    block_begin_ = block_size_ * batches.transport().rank();
    ByDirectoryRank all;
    agree(Phase::ids, [&] { all = ByDirectoryRank(ids, count, nullptr, ranks); });
    const Traffic traffic = traffic_of(batches, all);
    const std::vector<std::int64_t> from = first_of_each(traffic.in);
    std::vector<std::int32_t> received, ranks_with;
    std::vector<std::uint8_t> flags;
    agree(Phase::ids, [&] {
        received.resize(static_cast<std::size_t>(from.back()));
        ranks_with.assign(static_cast<std::size_t>(block_size_), 0);
        shared_.assign(static_cast<std::size_t>(count), 0);
    });
    exchange_ids(batches, all, ids, traffic, from, received);
    agree(Phase::ids, [&] {
        for (const std::int32_t id : received) ++ranks_with[static_cast<std::size_t>(id - block_begin_)];
        const std::int64_t end = std::min(block_size_, ids.all - block_begin_);
        for (std::int64_t i = 0; i < end; ++i)
            if (ranks_with[static_cast<std::size_t>(i)] == 0)
                refuse("no rank provides vertex " + std::to_string(block_begin_ + i), Element::vertex,
                       block_begin_ + i);
    });
    Traffic back(ranks);
    back.out = traffic.in, back.in = traffic.out;
    batches.exchange<std::uint8_t>(
        back,
        [&](int rank, std::int64_t first, std::span<std::uint8_t> rows) {
            const std::int64_t begin = from[static_cast<std::size_t>(rank)] + first;
            for (std::size_t i = 0; i < rows.size(); ++i) {
                const std::int32_t id = received[static_cast<std::size_t>(begin) + i];
                rows[i] = ranks_with[static_cast<std::size_t>(id - block_begin_)] > 1;
            }
        },
        [&](int rank, std::int64_t first, std::span<const std::uint8_t> rows) {
            const auto begin = static_cast<std::size_t>(all.first[static_cast<std::size_t>(rank)] + first);
            for (std::size_t i = 0; i < rows.size(); ++i)
                shared_[static_cast<std::size_t>(all.element[begin + i])] = rows[i];
        });

    std::int64_t some = std::any_of(shared_.begin(), shared_.end(), [](std::uint8_t flag) { return flag != 0; });
    batches.transport().reduce({&some, 1}, Reduction::max);
    any_ = some != 0;
    if (!any_) return;
    agree(Phase::ids, [&] { told_ = ByDirectoryRank(ids, count, &shared_, ranks); });
    traffic_ = traffic_of(batches, told_);
    first_row_from_ = first_of_each(traffic_.in);
    agree(Phase::ids, [&] { kept_.resize(static_cast<std::size_t>(first_row_from_.back())); });
    exchange_ids(batches, told_, ids, traffic_, first_row_from_, kept_);
    for (std::int32_t& id : kept_) id -= static_cast<std::int32_t>(block_begin_);
}

void GhostVertices::check(MessageBatches& batches, CollectiveCheck& agree, const VertexReader& reader, bool float32,
                          const char* when) const {
    if (!any_) return;
    float32 ? check_copies<float>(batches, agree, reader, when) : check_copies<double>(batches, agree, reader, when);
}

template <class Scalar>
void GhostVertices::check_copies(MessageBatches& batches, CollectiveCheck& agree, const VertexReader& reader,
                                 const char* when) const {
    using Position = std::array<Scalar, 3>;
    std::vector<Position> first;
    std::vector<std::int32_t> by;
    std::int64_t differs = all_;
    std::array<int, 2> ranks{};
    agree(Phase::ids, [&] {
        first.resize(static_cast<std::size_t>(block_size_));
        by.assign(static_cast<std::size_t>(block_size_), -1);
    });
    batches.exchange<Position>(
        traffic_,
        [&](int rank, std::int64_t begin, std::span<Position> rows) {
            const auto at = static_cast<std::size_t>(told_.first[static_cast<std::size_t>(rank)] + begin);
            for (std::size_t i = 0; i < rows.size(); ++i) {
                const Vec3d p = reader(told_.element[at + i]);
                rows[i] = {static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)};
            }
        },
        [&](int rank, std::int64_t begin, std::span<const Position> rows) {
            const auto at = static_cast<std::size_t>(first_row_from_[static_cast<std::size_t>(rank)] + begin);
            for (std::size_t i = 0; i < rows.size(); ++i) {
                const std::int32_t v = kept_[at + i];
                std::int32_t& known = by[static_cast<std::size_t>(v)];
                Position& position = first[static_cast<std::size_t>(v)];
                if (known < 0) {
                    known = rank;
                    position = rows[i];
                } else if (bits_of(position) != bits_of(rows[i]) && block_begin_ + v < differs) {
                    differs = block_begin_ + v;
                    ranks = {known, rank};
                }
            }
        });
    agree(Phase::ids, [&] {
        if (differs < all_)
            refuse("the coordinates of vertex " + std::to_string(differs) + when + " differ between rank " +
                       std::to_string(ranks[0]) + " and rank " + std::to_string(ranks[1]),
                   Element::vertex, differs);
    });
}

}  // namespace crumple::distribute
