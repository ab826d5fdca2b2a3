#include "contest.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "crumple/detector.h"
#include "peers/peers.h"
#include "report.h"

namespace crumple::benchmark {
namespace {

struct Peer {
    const char *name, *title, *version, *scalar, *threads, *computes;
    std::vector<Contestant> (*contestants)(const Workload&);
};

const std::vector<Peer> peers_built{
#ifdef CRUMPLE_PEER_CGAL
    {"cgal", "CGAL", CRUMPLE_CGAL_VERSION, "float64", "one or all",
     "whole result, exact; degenerate triangles only as such; manifold meshes, others are repaired before",
     cgal_contestants},
#endif
#ifdef CRUMPLE_PEER_CGAL_BOX
    {"cgal_box", "CGAL boxes", CRUMPLE_CGAL_VERSION, "float64", "one or all",
     "boxes only: pairs of overlapping boxes, neighbours included", cgal_box_contestants},
#endif
#ifdef CRUMPLE_PEER_EMBREE
    {"embree", "Embree", CRUMPLE_EMBREE_VERSION, "float32", "one or all",
     "boxes only: pairs of overlapping boxes, neighbours included", embree_contestants},
#endif
#ifdef CRUMPLE_PEER_FCL
    {"fcl", "FCL", CRUMPLE_FCL_VERSION, "float32 or float64", "one",
     "pairs between two meshes, with rounding errors, no points", fcl_contestants},
#endif
};

/// Peers that this program was built without: name and reason.
const std::vector<std::pair<const char*, const char*>> peers_left_out{
#ifndef CRUMPLE_PEER_CGAL
    {"CGAL", "libcgal-dev is not installed"},
    {"CGAL boxes", "libcgal-dev is not installed"},
#endif
#ifndef CRUMPLE_PEER_EMBREE
    {"Embree", "libembree-dev is not installed"},
#endif
#ifndef CRUMPLE_PEER_FCL
    {"FCL", "libfcl-dev is not installed"},
#endif
};

Difference difference(const std::vector<Pair>& theirs, const std::vector<Pair>& ours) {
    std::vector<Pair> missing, extra;
    std::set_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(), std::back_inserter(missing));
    std::set_difference(theirs.begin(), theirs.end(), ours.begin(), ours.end(), std::back_inserter(extra));
    return {static_cast<std::int64_t>(missing.size()), static_cast<std::int64_t>(extra.size())};
}

/// Calls the contestant once more and returns its pairs, normalised (workload.h) so that they can be compared.
std::vector<Pair> answer(const Contestant& contestant, Query query) {
    contestant.call();
    std::vector<Pair> pairs = contestant.pairs();
    normalise(pairs, query);
    return pairs;
}

}  // namespace

std::vector<std::string> built_peers() {
    std::vector<std::string> names;
    for (const Peer& peer : peers_built) names.emplace_back(peer.name);
    return names;
}

nlohmann::json describe_peers() {
    nlohmann::json peers = nlohmann::json::array();
    for (const Peer& peer : peers_built)
        peers.push_back({{"name", peer.title},
                         {"version", peer.version},
                         {"scalar", peer.scalar},
                         {"threads", peer.threads},
                         {"computes", peer.computes}});
    for (const auto& [name, package] : peers_left_out) peers.push_back({{"name", name}, {"left_out", package}});
    return peers;
}

std::vector<Contestant> peer_contestants(const Workload& workload, std::span<const std::string> peers) {
    std::vector<Contestant> contestants;
    for (const Peer& peer : peers_built)
        if (std::ranges::find(peers, peer.name) != peers.end())
            std::ranges::move(peer.contestants(workload), std::back_inserter(contestants));
    return contestants;
}

nlohmann::json contest(const Workload& workload, std::span<const std::string> peers, const Effort& effort) {
    std::vector<Contestant> contestants = crumple_contestants(workload);
    std::ranges::move(peer_contestants(workload, peers), std::back_inserter(contestants));
    const double before = processors_at_hand();
    const std::vector<Times> times = race(contestants, effort);
    const double processors = std::min(before, processors_at_hand());

    // For each name, finds the contestant with that name (method of that program) with the least median time.
    std::vector<std::size_t> best;
    for (std::size_t i = 0; i < contestants.size(); ++i) {
        if (!times[i].raced()) continue;
        const auto same = [&](std::size_t j) { return contestants[j].name == contestants[i].name; };
        const auto found = std::ranges::find_if(best, same);
        if (found == best.end())
            best.push_back(i);
        else if (times[i].summary().median < times[*found].summary().median)
            *found = i;
    }

    const std::size_t ours = best.front();
    const bool yes_or_no = workload.query == Query::any;
    const std::vector<Pair> pairs = yes_or_no ? std::vector<Pair>{} : answer(contestants[ours], workload.query);
    const std::string heading = fmt::format("{} ({}, {}): {} triangles, ", workload.name, name_of(workload.query),
                                            workload.scalar(), workload.triangle_count());
    Table table(heading + (yes_or_no ? std::string("yes or no") : fmt::format("{} pairs", pairs.size())),
                {"", "fastest way", "computes", "ms", "quartiles", "ratio", "quartiles", "missing", "extra"});
    nlohmann::json entries = nlohmann::json::array();
    for (std::size_t i = 0; i < contestants.size(); ++i) {
        nlohmann::json entry{{"name", contestants[i].name},         {"way", contestants[i].way},
                             {"computes", contestants[i].computes}, {"milliseconds", to_json(times[i].summary())},
                             {"raced", times[i].raced()},           {"fastest_way", false}};
        if (std::ranges::find(best, i) != best.end()) {
            entry["fastest_way"] = true;
            const Summary time = times[i].summary(), factor = ratio(times[i], times[ours]);
            std::string missing, extra;
            if (i != ours) entry["ratio"] = to_json(factor);
            if (i != ours && contestants[i].pairs) {
                const Difference d = difference(answer(contestants[i], workload.query), pairs);
                entry["missing"] = d.missing;
                entry["extra"] = d.extra;
                missing = std::to_string(d.missing);
                extra = std::to_string(d.extra);
            }
            table.row({contestants[i].name, contestants[i].way, contestants[i].computes, number(time.median),
                       range(time), i == ours ? "" : number(factor.median), i == ours ? "" : range(factor), missing,
                       extra});
        }
        entries.push_back(std::move(entry));
    }
    table.print();
    fmt::print("  {}\n", describe_processors(processors));
    return {{"processors_at_hand", processors},       {"workload", workload.name},
            {"question", name_of(workload.query)},    {"scalar", workload.scalar()},
            {"triangles", workload.triangle_count()}, {"pairs", pairs.size()},
            {"contestants", std::move(entries)}};
}

}  // namespace crumple::benchmark
