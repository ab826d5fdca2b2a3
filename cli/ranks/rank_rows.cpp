#include "cli/ranks/rank_rows.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "cli/ranks/rank_gather.h"
#include "io/lists/pairs.h"

namespace crumple::cli {
namespace {

using distribute::Traffic;

std::size_t place(std::int64_t i) { return static_cast<std::size_t>(i); }

/// Offsets by first triangle and hit flags, as a detector makes them.
void index(Intersections& found, std::int64_t triangles) {
    found.offsets.resize_discard(place(triangles + 1));
    found.hit.resize_discard(place(triangles));
    std::fill(found.offsets.begin(), found.offsets.end(), 0);
    std::fill(found.hit.begin(), found.hit.end(), std::uint8_t{0});
    for (const Pair& pair : found.pairs) {
        ++found.offsets[pair.a + 1];
        found.hit[pair.a] = found.hit[pair.b] = 1;
    }
    std::partial_sum(found.offsets.begin(), found.offsets.end(), found.offsets.begin());
}

}  // namespace

std::int64_t count_hits(RankLink& link, const DistributedIntersections& found, io::Blocks triangles) {
    const std::int64_t begin = triangles.begin(link.rank()), end = triangles.end(link.rank());
    std::vector<std::uint8_t> hit;
    std::vector<std::int32_t> others;  // second triangles of other ranks, each once, in order
    link.agree([&] {
        hit.assign(place(end - begin), 0);
        for (const Pair& pair : found.pairs) {
            hit[place(pair.a - begin)] = 1;
            if (pair.b < end)
                hit[place(pair.b - begin)] = 1;
            else
                others.push_back(pair.b);
        }
        std::sort(others.begin(), others.end());
        others.erase(std::unique(others.begin(), others.end()), others.end());
    });
    Traffic traffic(link.ranks());
    for (const std::int32_t triangle : others) ++traffic.out[place(triangles.reader_of(triangle))];
    link.transport().all_to_all(traffic.out, traffic.in);
    std::vector<std::int64_t> first(traffic.out.size() + 1, 0);
    std::partial_sum(traffic.out.begin(), traffic.out.end(), first.begin() + 1);
    link.rounds().exchange<std::int32_t>(
        traffic,
        [&](int rank, std::int64_t from, std::span<std::int32_t> rows) {
            std::copy_n(others.data() + first[place(rank)] + from, rows.size(), rows.begin());
        },
        [&](int, std::int64_t, std::span<const std::int32_t> rows) {
            for (const std::int32_t triangle : rows) hit[place(triangle - begin)] = 1;
        });
    return link.sum(std::count(hit.begin(), hit.end(), std::uint8_t{1}));
}

RankText text_of(const RankLink& link, const DistributedIntersections& found, bool contacts, io::PairFormat format) {
    return {[&found, contacts, format, first = link.is_first()](std::ostream& out) {
        const io::RowTable table = io::pair_rows(contacts);
        io::RowWriter writer(out, table, format == io::PairFormat::csv);
        if (first) writer.write_heading();
        io::add_pairs(writer, found.pairs.span(), found.contacts);
    }};
}

Intersections collect(RankLink& link, const DistributedIntersections& found, io::Blocks triangles) {
    Intersections all;
    gather(link, found.pairs.span(), all.pairs);
    if (link.largest(!found.contacts.offsets.empty())) {
        const Contacts& mine = found.contacts;
        gather(link, mine.kinds.span(), all.contacts.kinds);
        gather(link, mine.points.span(), all.contacts.points);
        std::vector<std::uint8_t> points(mine.kinds.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            points[i] = static_cast<std::uint8_t>(mine.offsets[i + 1] - mine.offsets[i]);
        Array<std::uint8_t> counts;
        gather(link, std::span<const std::uint8_t>(points), counts);
        link.agree([&] {
            all.contacts.offsets.resize_discard(counts.size() + 1);
            all.contacts.offsets[0] = 0;
            for (std::size_t i = 0; i < counts.size(); ++i)
                all.contacts.offsets[i + 1] = all.contacts.offsets[i] + counts[i];
        });
    }
    link.agree([&] {
        if (link.is_first()) index(all, triangles.rows);
    });
    return all;
}

}  // namespace crumple::cli
