#include "distributed/delivery.h"

#include <algorithm>
#include <cstring>

#include "distributed/transport/exchange_lists.h"

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

Delivery::Delivery(MessageBatches& batches, CollectiveCheck& agree, const Owners& owners, RankMembers& members,
                   const RankMesh& local, const GhostVertices& copies, std::vector<AssembledPart>& mine,
                   std::size_t depth)
    : batches_(batches),
      check_(agree),
      owners_(owners),
      members_(members),
      local_(local),
      copies_(copies),
      all_mine_(mine),
      depth_(static_cast<std::int64_t>(depth)),
      ranks_(batches.transport().size()) {
    std::vector<std::int32_t> owned(static_cast<std::size_t>(ranks_), 0);
    for (const int owner : owners.all()) {
        std::int32_t& so_far = owned[static_cast<std::size_t>(owner)];
        place_.push_back(so_far++);
        most_parts_ = std::max(most_parts_, so_far);
    }
}

void Delivery::run(const What& what, FunctionRef<void(std::int64_t bytes)> room) {
    what_ = what;
    const int groups = choose_groups();
    for (int group = 0; group < groups; ++group) run_group(group, groups, room);
}

// Returns the number of groups into which parts are divided: 1, or if the deltas of some rank exceed the size of a
// message batch, the largest number of parts that a rank owns, so that each group has at most one part of each rank.
int Delivery::choose_groups() {
    std::int64_t most = 0;
    check_(Phase::members, [&] { most = members_.bytes_of_changes(); });
    batches_.transport().reduce({&most, 1}, Reduction::max);
    return most > batches_.bytes() ? most_parts_ : 1;
}

void Delivery::run_group(int group, int groups, FunctionRef<void(std::int64_t bytes)> room) {
    check_(Phase::members, [&] {
        parts_.clear();
        for (const std::int32_t part : members_.parts())
            if (place_[static_cast<std::size_t>(part)] % groups == group) parts_.push_back(part);
        members_.make_rows(parts_, local_, copies_);
        list_leaving();
        mine_.clear();
        for (std::size_t m = static_cast<std::size_t>(group); m < all_mine_.size();
             m += static_cast<std::size_t>(groups))
            mine_.push_back(&all_mine_[m]);
    });
    exchange_counts();
    check_(Phase::memory, [&] {
        room(bytes_coming());
        reserve();
    });
    exchange_news();
    check_(Phase::memory, [&] {
        for (std::size_t m = 0; m < mine_.size(); ++m)
            if (!news_[m].empty()) mine_[m]->take(news_[m]);
        news_.clear();
    });
    const PreparedScene& scene = local_.scene();
    const auto exchange = [&](const VertexReader& reader, bool at_end) {
        what_.float32 ? exchange_coordinates<float>(reader, at_end) : exchange_coordinates<double>(reader, at_end);
    };
    exchange(scene.reader[0], false);
    if (what_.moving) exchange(scene.end, true);
    members_.sent(parts_);
}

void Delivery::list_leaving() {
    leaving_.clear();
    for (const std::int32_t part : parts_)
        if (const DeltaCounts counts = members_.counts_of_delta(part); counts != DeltaCounts{})
            leaving_.push_back({owners_.of(part), part, counts});
    std::stable_sort(leaving_.begin(), leaving_.end(),
                     [](const Leaving& a, const Leaving& b) { return a.rank < b.rank; });
}

void Delivery::exchange_counts() {
    Traffic traffic(ranks_);
    for (const Leaving& some : leaving_) ++traffic.out[static_cast<std::size_t>(some.rank)];
    batches_.transport().all_to_all(traffic.out, traffic.in);
    check_(Phase::members, [&] {
        coming_.clear();
        coming_.reserve(all(traffic.in));
    });
    const auto first = first_of_each(traffic.out);
    // Each message batch appends rows of all ranks, so the rows of one rank are contiguous only after the sort below.
    batches_.exchange<CountsRow>(
        traffic,
        [&](int rank, std::int64_t begin, std::span<CountsRow> rows) {
            const auto at = static_cast<std::size_t>(first[static_cast<std::size_t>(rank)] + begin);
            for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = {leaving_[at + i].part, leaving_[at + i].counts};
        },
        [&](int rank, std::int64_t, std::span<const CountsRow> rows) {
            for (const CountsRow& row : rows) {
                const auto part = std::lower_bound(
                    mine_.begin(), mine_.end(), row.part,
                    [](const AssembledPart* mine, std::int64_t index) { return mine->index() < index; });
                coming_.push_back({rank, static_cast<std::size_t>(part - mine_.begin()), row.counts, nullptr});
            }
        });
    std::stable_sort(coming_.begin(), coming_.end(), [](const Coming& a, const Coming& b) { return a.rank < b.rank; });
}

// Returns how many bytes the rows to come add to this rank's parts. Counts per triangle: id, group, three corners,
// rank, masks, owned features; per vertex: coordinates. Does not count the copy of a part's lists that exists while
// deltas are merged.
std::int64_t Delivery::bytes_coming() const {
    std::int64_t bytes = 0;
    for (const Coming& some : coming_)
        bytes += some.counts.added * (24 + 8 * depth_ + (what_.features ? 40 : 0)) +
                 some.counts.vertices * (what_.float32 ? 12 : 24) * (what_.moving ? 2 : 1);
    return bytes;
}

void Delivery::reserve() {
    const auto size = [](std::int64_t n) { return static_cast<std::size_t>(n); };
    const auto is_news = [](const DeltaCounts& c) { return c.removed + c.changed + c.added + c.vertices > 0; };
    std::vector<std::size_t> of_part(mine_.size(), 0);
    for (const Coming& some : coming_) of_part[some.mine] += is_news(some.counts);
    news_.assign(mine_.size(), {});
    for (std::size_t m = 0; m < mine_.size(); ++m) news_[m].reserve(of_part[m]);
    for (Coming& some : coming_) {
        const DeltaCounts& counts = some.counts;
        if (!is_news(counts)) continue;
        some.news = &news_[some.mine].emplace_back();
        some.news->rank = some.rank;
        PartDelta& delta = some.news->delta;
        delta.removed.resize(size(counts.removed));
        delta.changed.resize(size(counts.changed));
        delta.changed_masks.resize(size(depth_ * counts.changed));
        delta.added.resize(size(counts.added));
        delta.added_masks.resize(size(depth_ * counts.added));
        if (what_.features) delta.added_features.resize(size(counts.added));
        delta.vertices.resize(size(counts.vertices));
    }
}

template <class Row, class Count, class Pack, class Unpack>
void Delivery::stream(Count count, Pack pack, Unpack unpack) {
    Traffic traffic(ranks_);
    ByPart out, in;
    const auto add = [&](const auto& some, ByPart& rows, std::vector<std::int64_t>& to) {
        rows.add(count(some.counts));
        to[static_cast<std::size_t>(some.rank)] += count(some.counts);
    };
    for (const Leaving& some : leaving_) add(some, out, traffic.out);
    for (const Coming& some : coming_) add(some, in, traffic.in);
    const auto first_out = first_of_each(traffic.out), first_in = first_of_each(traffic.in);
    batches_.exchange<Row>(
        traffic,
        [&](int rank, std::int64_t first, std::span<Row> rows) {
            out.visit(first_out[static_cast<std::size_t>(rank)] + first, rows.size(),
                      [&](std::size_t i, std::int64_t of_part, std::size_t at, std::size_t n) {
                          pack(leaving_[i], of_part, rows.subspan(at, n));
                      });
        },
        [&](int rank, std::int64_t first, std::span<const Row> rows) {
            in.visit(first_in[static_cast<std::size_t>(rank)] + first, rows.size(),
                     [&](std::size_t i, std::int64_t of_part, std::size_t at, std::size_t n) {
                         unpack(coming_[i], of_part, rows.subspan(at, n));
                     });
        });
}

template <class Element, class Count, class List>
void Delivery::stream_list(Count count, std::int64_t each, List list) {
    stream<Element>([&](const DeltaCounts& counts) { return each * count(counts); },
                    [&](const Leaving& some, std::int64_t first, std::span<Element> rows) {
                        const auto& from = list(members_.delta(some.part));
                        std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(first), rows.size(), rows.begin());
                    },
                    [&](const Coming& some, std::int64_t first, std::span<const Element> rows) {
                        auto& to = list(some.news->delta);
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
    stream<Position>(
        [](const DeltaCounts& c) { return c.coordinates; },
        [&](const Leaving& some, std::int64_t first, std::span<Position> rows) {
            gather(reader, members_.vertices(some.part).subspan(static_cast<std::size_t>(first), rows.size()), rows);
        },
        [&](const Coming& some, std::int64_t first, std::span<const Position> rows) {
            AssembledPart& part = *mine_[some.mine];
            Position* const to = part.template coordinates<Scalar>(at_end);
            part.visit_coordinates(some.rank, first, rows.size(),
                                   [&](std::int64_t place, std::size_t at, std::size_t n) {
                                       std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(at), n, to + place);
                                   });
        });
}

}  // namespace crumple::distribute
