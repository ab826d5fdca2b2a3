#include "cli/ranks/rank_overlaps.h"

#include <algorithm>
#include <vector>

#include "cli/commands.h"
#include "cli/ranks/guarded_ranks.h"
#include "cli/ranks/rank_link.h"
#include "cli/ranks/rank_statistics.h"
#include "crumple/mpi.h"
#include "distributed/overlaps/overlap_messages.h"

namespace crumple::cli {
namespace {

/// Bodies of a world that a rank provides.
struct BodiesOfRank {
    std::vector<Body> bodies;
    std::vector<Pose> poses;
    std::vector<std::int64_t> ids;

    BodiesOfRank(const World& world, const RankLink& link) {
        for (std::size_t b = static_cast<std::size_t>(link.rank()); b < world.bodies.size();
             b += static_cast<std::size_t>(link.ranks())) {
            bodies.push_back(world.bodies[b]);
            if (!world.poses.empty()) poses.push_back(world.poses[b]);
            ids.push_back(static_cast<std::int64_t>(b));
        }
    }
};

/// Collective. Returns the rows of all ranks and their skipped bodies on rank 0, and none on the other ranks.
Overlaps rows_of_all_ranks(RankLink& link, const Overlaps& mine) {
    std::vector<std::byte> message;
    link.run_checked([&] { message = distribute::packed_rows(mine); });
    const std::vector<std::size_t> sizes = link.gather(std::vector<std::size_t>{message.size()});
    const std::vector<std::byte> messages = link.gather(message);
    const std::vector<std::int32_t> skipped = link.gather(mine.skipped);
    Overlaps all;
    link.run_checked([&] {
        std::vector<Overlaps> rows;
        std::size_t at = 0;
        for (const std::size_t size : sizes) {
            rows.push_back(distribute::unpacked_rows(std::span(messages).subspan(at, size)));
            at += size;
        }
        distribute::merge_rows(rows, all);
        for (const std::int32_t body : skipped) all.skipped.push_back(body);
        std::sort(all.skipped.begin(), all.skipped.end());
    });
    return all;
}

int search_together(RankLink& link, const RankOverlapSearch& search) {
    World world;
    OverlapQuery query;
    link.run_checked([&] {
        world = search.read();
        query = search.query();
    });
    const BodiesOfRank mine(world, link);
    DistributedOptions options;
    options.detector = search.options;
    mpi::Detector detector(MPI_COMM_WORLD, options);
    const auto find = [&]() -> const DistributedOverlaps& {
        try {
            return detector.find(LocalWorld{{world.shapes, mine.bodies, mine.poses}, mine.ids}, query);
        } catch (const Error& error) {
            // All ranks have read the same bodies, so the rank does not matter.
            throw search.named(error.element == Element::body ? without_rank_name(error) : without_rank(error));
        }
    };
    const DistributedOverlaps& found = find();
    Overlaps all = rows_of_all_ranks(link, found.rows);
    all.any = found.any;
    all.count = found.count;
    DistributedStatistics statistics = found.statistics;
    statistics.search.threads = detector.options().detector.threads;
    all.statistics = total(link, statistics).search;
    all.statistics.pairs = found.count;
    all.statistics.triangles = 0;
    for (const Body& body : world.bodies)
        all.statistics.triangles += world.shapes[static_cast<std::size_t>(body.shape)].triangles.rows;
    std::int64_t status = done;
    link.run_checked([&] {
        if (link.is_first()) status = search.write(all);
    });
    return static_cast<int>(link.largest(status));
}

}  // namespace

int overlaps_on_ranks(const RankOverlapSearch& search) {
    return guarded_on_ranks([&] {
        RankLink link;
        return search_together(link, search);
    });
}

}  // namespace crumple::cli
