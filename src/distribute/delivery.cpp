#include "distribute/delivery.h"

#include <algorithm>
#include <cstring>

namespace crumple::distribute {
namespace {

template <class Scalar>
void gather(const VertexReader& reader, std::span<const std::int32_t> vertices, std::span<std::array<Scalar, 3>> to) {
    if (reader.contiguous() && reader.scalar_bytes() == sizeof(Scalar)) {
        for (std::size_t i = 0; i < to.size(); ++i)
            std::memcpy(&to[i], reader.data + std::int64_t{vertices[i]} * reader.row_stride, sizeof to[i]);
        return;
    }
    for (std::size_t i = 0; i < to.size(); ++i) {
        const Vec3d p = reader(vertices[i]);
        to[i] = {static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)};
    }
}

}  // namespace

Delivery::Delivery(Rounds& rounds, Agreement& agree, const Owners& owners, Members& members, const Share& share,
                   const SharedVertices& copies, std::vector<AssembledPart>& mine, std::size_t depth)
    : rounds_(rounds),
      agree_(agree),
      members_(members),
      share_(share),
      copies_(copies),
      all_mine_(mine),
      depth_(static_cast<std::int64_t>(depth)),
      ranks_(rounds.transport().size()) {
    for (int r = 0; r < ranks_; ++r) all_parts_of_.push_back(owners.parts_of(r));
}

void Delivery::run(const What& what, FunctionRef<void(std::int64_t bytes)> room) {
    what_ = what;
    const int groups = choose_groups();
    for (int group = 0; group < groups; ++group) run_group(group, groups, room);
}

// One, unless some rank has more to tell than may be on its way at a time: then one for each part that a rank has.
int Delivery::choose_groups() {
    std::int64_t most = 0;
    agree_(Phase::members, [&] { most = members_.bytes_of_changes(); });
    rounds_.transport().reduce({&most, 1}, Reduction::max);
    std::size_t parts = 1;
    for (const auto& of_rank : all_parts_of_) parts = std::max(parts, of_rank.size());
    return most > rounds_.bytes() ? static_cast<int>(parts) : 1;
}

void Delivery::run_group(int group, int groups, FunctionRef<void(std::int64_t bytes)> room) {
    const auto begin = static_cast<std::size_t>(group), step = static_cast<std::size_t>(groups);
    agree_(Phase::members, [&] {
        std::vector<std::int32_t> parts;
        parts_of_.assign(static_cast<std::size_t>(ranks_), {});
        for (std::size_t r = 0; r < parts_of_.size(); ++r)
            for (std::size_t i = begin; i < all_parts_of_[r].size(); i += step) {
                parts_of_[r].push_back(all_parts_of_[r][i]);
                parts.push_back(all_parts_of_[r][i]);
            }
        members_.make_rows(parts, share_, copies_);
        mine_.clear();
        for (std::size_t m = begin; m < all_mine_.size(); m += step) mine_.push_back(&all_mine_[m]);
        coming_.assign(mine_.size() * static_cast<std::size_t>(ranks_), {});
    });
    exchange_counts();
    agree_(Phase::room, [&] {
        room(bytes_coming());
        make_room();
    });
    exchange_news();
    agree_(Phase::room, [&] {
        for (std::size_t m = 0; m < mine_.size(); ++m) {
            mine_[m]->take(news_[m]);
            news_[m].clear();
            news_[m].shrink_to_fit();
        }
    });
    const Scene& scene = share_.scene();
    const auto exchange = [&](const VertexReader& reader, bool at_end) {
        what_.float32 ? exchange_coordinates<float>(reader, at_end) : exchange_coordinates<double>(reader, at_end);
    };
    exchange(scene.reader[0], false);
    if (what_.moving) exchange(scene.end, true);
    for (const auto& parts : parts_of_) members_.sent(parts);
}

void Delivery::exchange_counts() {
    Traffic traffic(ranks_);
    for (std::size_t r = 0; r < traffic.out.size(); ++r) {
        traffic.out[r] = static_cast<std::int64_t>(parts_of_[r].size());
        traffic.in[r] = static_cast<std::int64_t>(mine_.size());
    }
    rounds_.exchange<DeltaCounts>(
        traffic,
        [&](int rank, std::int64_t first, std::span<DeltaCounts> rows) {
            const std::vector<std::int32_t>& parts = parts_of_[static_cast<std::size_t>(rank)];
            for (std::size_t i = 0; i < rows.size(); ++i)
                rows[i] = members_.counts_of_delta(parts[static_cast<std::size_t>(first) + i]);
        },
        [&](int rank, std::int64_t first, std::span<const DeltaCounts> rows) {
            for (std::size_t i = 0; i < rows.size(); ++i)
                coming_[(static_cast<std::size_t>(first) + i) * static_cast<std::size_t>(ranks_) +
                        static_cast<std::size_t>(rank)] = rows[i];
        });
}

// An id, a group, three corners and a rank a triangle, its masks, and a vertex; merging has the old and the new lists.
std::int64_t Delivery::bytes_coming() const {
    std::int64_t bytes = 0;
    for (const DeltaCounts& some : coming_)
        bytes += some.added * (24 + 8 * depth_ + (what_.features ? 40 : 0)) +
                 some.vertices * (what_.float32 ? 12 : 24) * (what_.moving ? 2 : 1);
    return bytes;
}

void Delivery::make_room() {
    news_.assign(mine_.size(), {});
    const auto size = [](std::int64_t n) { return static_cast<std::size_t>(n); };
    for (std::size_t m = 0; m < mine_.size(); ++m) {
        news_[m].resize(static_cast<std::size_t>(ranks_));
        for (int r = 0; r < ranks_; ++r) {
            const DeltaCounts& counts = counts_from(m, r);
            PartNews& news = news_[m][static_cast<std::size_t>(r)];
            news.rank = r;
            news.delta.removed.resize(size(counts.removed));
            news.delta.changed.resize(size(counts.changed));
            news.delta.changed_masks.resize(size(depth_ * counts.changed));
            news.delta.added.resize(size(counts.added));
            news.delta.added_masks.resize(size(depth_ * counts.added));
            if (what_.features) news.delta.added_features.resize(size(counts.added));
            news.delta.vertices.resize(size(counts.vertices));
        }
    }
}

template <class Row, class Count, class Pack, class Unpack>
void Delivery::stream(Count count, Pack pack, Unpack unpack) {
    const auto ranks = static_cast<std::size_t>(ranks_);
    std::vector<ByPart> out(ranks), in(ranks);
    Traffic traffic(ranks_);
    for (std::size_t r = 0; r < ranks; ++r) {
        for (const std::int32_t part : parts_of_[r]) out[r].add(count(members_.counts_of_delta(part)));
        for (std::size_t m = 0; m < mine_.size(); ++m) in[r].add(count(counts_from(m, static_cast<int>(r))));
        traffic.out[r] = out[r].rows(), traffic.in[r] = in[r].rows();
    }
    rounds_.exchange<Row>(
        traffic,
        [&](int rank, std::int64_t first, std::span<Row> rows) {
            const auto r = static_cast<std::size_t>(rank);
            out[r].visit(first, rows.size(), [&](std::size_t p, std::int64_t of_part, std::size_t at, std::size_t n) {
                pack(parts_of_[r][p], of_part, rows.subspan(at, n));
            });
        },
        [&](int rank, std::int64_t first, std::span<const Row> rows) {
            in[static_cast<std::size_t>(rank)].visit(
                first, rows.size(), [&](std::size_t m, std::int64_t of_part, std::size_t at, std::size_t n) {
                    unpack(m, rank, of_part, rows.subspan(at, n));
                });
        });
}

template <class Element, class Count, class List>
void Delivery::stream_list(Count count, std::int64_t each, List list) {
    stream<Element>([&](const DeltaCounts& counts) { return each * count(counts); },
                    [&](std::int32_t part, std::int64_t first, std::span<Element> rows) {
                        const auto& from = list(members_.delta(part));
                        std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(first), rows.size(), rows.begin());
                    },
                    [&](std::size_t m, int rank, std::int64_t first, std::span<const Element> rows) {
                        auto& to = list(news_[m][static_cast<std::size_t>(rank)].delta);
                        std::copy(rows.begin(), rows.end(), to.begin() + static_cast<std::ptrdiff_t>(first));
                    });
}

void Delivery::exchange_news() {
    const auto removed = [](const DeltaCounts& c) { return c.removed; };
    const auto changed = [](const DeltaCounts& c) { return c.changed; };
    const auto added = [](const DeltaCounts& c) { return c.added; };
    const auto vertices = [](const DeltaCounts& c) { return c.vertices; };
    stream_list<std::int32_t>(
        removed, 1, [](auto& delta) -> auto& { return delta.removed; });
    stream_list<std::int32_t>(
        changed, 1, [](auto& delta) -> auto& { return delta.changed; });
    stream_list<std::uint64_t>(
        changed, depth_, [](auto& delta) -> auto& { return delta.changed_masks; });
    stream_list<MemberRow>(
        added, 1, [](auto& delta) -> auto& { return delta.added; });
    stream_list<std::uint64_t>(
        added, depth_, [](auto& delta) -> auto& { return delta.added_masks; });
    if (what_.features)
        stream_list<OwnedFeatures>(
            added, 1, [](auto& delta) -> auto& { return delta.added_features; });
    stream_list<std::int32_t>(
        vertices, 1, [](auto& delta) -> auto& { return delta.vertices; });
}

template <class Scalar>
void Delivery::exchange_coordinates(const VertexReader& reader, bool at_end) {
    using Position = std::array<Scalar, 3>;
    stream<Position>([](const DeltaCounts& c) { return c.coordinates; },
                     [&](std::int32_t part, std::int64_t first, std::span<Position> rows) {
                         gather(reader, members_.vertices(part).subspan(static_cast<std::size_t>(first), rows.size()),
                                rows);
                     },
                     [&](std::size_t m, int rank, std::int64_t first, std::span<const Position> rows) {
                         Position* const to = mine_[m]->template coordinates<Scalar>(at_end);
                         mine_[m]->visit_coordinates(
                             rank, first, rows.size(), [&](std::int64_t place, std::size_t at, std::size_t n) {
                                 std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(at), n, to + place);
                             });
                     });
}

}  // namespace crumple::distribute
