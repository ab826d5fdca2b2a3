// Many ranks against one machine: byte for byte, for any number of ranks and any distribution.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "agreement/hard_soups.h"
#include "crumple/crumple.h"
#include "distribute/pretended_ranks.h"
#include "distribute/rank_detector.h"
#include "distribute/shares.h"

namespace crumple::test {
namespace {

using distribute::RankDetector;
using distribute::Transport;

DistributedOptions one_thread() {
    DistributedOptions options;
    options.detector.backend = Backend::cpu;
    options.detector.threads = 1;
    return options;
}

WholeMesh whole(const io::TriangleMesh& mesh) {
    WholeMesh out;
    out.vertices = mesh.vertices;
    out.corners = mesh.triangles;
    out.groups = mesh.groups;
    return out;
}

testing::AssertionResult same_as_one(const WholeMesh& mesh, Distribution how, int ranks, const Query& query,
                                     const DistributedOptions& options = one_thread()) {
    Detector one({.backend = Backend::cpu});
    const Collisions expected = one.find_self(mesh.view(), query);
    std::vector<DistributedCollisions> rows(static_cast<std::size_t>(ranks));
    std::vector<std::vector<std::int64_t>> ids(rows.size());
    bool sound = true;
    run_ranks(ranks, [&](Transport& transport) {
        const MeshPiece piece(mesh, how, transport.rank(), ranks);
        RankDetector detector(transport, options);
        const auto r = static_cast<std::size_t>(transport.rank());
        ids[r] = piece.triangle_ids;
        rows[r] = detector.find_self(piece.share(), query);
        const bool any = detector.has_collision(piece.share(), query);
        const std::int64_t count = detector.count(piece.share(), query);
        if (r == 0) sound = any == (count > 0) && count == static_cast<std::int64_t>(expected.pairs.size());
    });
    if (!sound) return testing::AssertionFailure() << "any or count differ";
    return merged_is(rows, ids, expected);
}

TEST(Ranks, have_the_answer_of_one_machine) {
    const WholeMesh sheet(wavy_sheet<float>(24)), soup(random_soup<double>(500, 0.2));
    for (const int ranks : {1, 2, 3, 5})
        for (const Distribution how : every_distribution)
            for (const WholeMesh* mesh : {&sheet, &soup})
                for (const bool contacts : {false, true})
                    ASSERT_TRUE(same_as_one(*mesh, how, ranks, {.contacts = contacts}))
                        << ranks << " ranks, distribution " << static_cast<int>(how) << ", contacts " << contacts;
}

TEST(Ranks, have_the_answer_of_one_machine_on_hard_soups) {
    const std::vector<NamedMesh> soups = hard_soups();
    std::size_t number = 0;
    for (const NamedMesh& soup : soups) {
        Query query;
        query.contacts = number % 2 == 0;
        query.weld = number % 3 == 0;
        query.neighbours = number % 5 == 0 ? Neighbours::skip : Neighbours::geometric;
        query.intersections = number % 7 == 0 ? Intersections::proper : Intersections::all;
        if (!soup.mesh.groups.empty())
            query.wanted = number % 4 == 1 ? Wanted::between : number % 4 == 2 ? Wanted::within : Wanted::both;
        ASSERT_TRUE(
            same_as_one(whole(soup.mesh), every_distribution[number % 4], 2 + static_cast<int>(number % 3), query))
            << soup.name;
        ++number;
    }
}

}  // namespace
}  // namespace crumple::test
