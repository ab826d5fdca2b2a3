#include "fuzz/feature_rows.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "fuzz/fail.h"
#include "io/lists/feature_kinds.h"

namespace crumple::fuzz {
namespace {

using io::PairFormat;

constexpr std::int32_t most_bodies = 100;  // the result has an offset for each body

constexpr std::pair<PairFormat, const char*> formats[] = {{PairFormat::txt, "again.txt"},
                                                          {PairFormat::csv, "again.csv"},
                                                          {PairFormat::json, "again.json"},
                                                          {PairFormat::npz, "again.npz"}};

template <class Result>
auto& list_of_kind(Result& result, CandidateKind kind) {
    for (const FeatureKind feature : io::all_feature_kinds)
        if (io::kind_of(feature) == kind) return result[feature];
    if constexpr (requires { result.triangle_pairs; })
        if (kind == CandidateKind::face_face) return result.triangle_pairs;
    fail("a row of a kind that the list cannot have");
}
auto& list_of_kind(Candidates& result, CandidateKind kind) { return result[kind]; }

template <class Rows>
std::int32_t bodies_of(const Rows& list) {
    std::int32_t most = list.has_bodies ? 1 : 0;
    for (const auto& row : list.rows) most = std::max({most, row.bodies.first, row.bodies.second});
    return most == INT32_MAX ? most : most + 1;
}

template <class Row>
void require_sound(const Row& row, bool has_bodies) {
    const CandidateKind kind = row.kind;
    for (const std::int32_t id : row.ids) require(id >= 0, "a row names nothing");
    require(row.bodies.first >= 0 && row.bodies.second >= 0, "a row names no body");
    require(has_bodies || row.bodies == BodyPair{0, 0}, "a body where there is none");
    for (const std::size_t side : {0U, 1U}) {
        const std::size_t at = side == 0 ? 0 : io::first_ids(kind);
        require(!io::is_edge(kind, side) || row.ids[at] < row.ids[at + 1], "an edge that is not in order");
    }
}

/// Returns a result with the rows of `list`. Each edge that a row names becomes a new edge of the result.
template <class Result, class Rows, class Add>
Result result_of(const Rows& list, Add add) {
    Result result;
    std::map<std::int32_t, std::vector<Edge>> edges;
    for (const auto& row : list.rows) {
        const CandidateKind kind = row.kind;
        const auto index = [&](std::size_t side, std::int32_t body) {
            const std::size_t at = side == 0 ? 0 : io::first_ids(kind);
            if (!io::is_edge(kind, side)) return row.ids[at];
            edges[body].push_back({row.ids[at], row.ids[at + 1]});
            return static_cast<std::int32_t>(edges[body].size() - 1);
        };
        auto& of_kind = list_of_kind(result, row.kind);
        const std::int32_t first = index(0, row.bodies.first);
        of_kind.pairs.push_back({first, index(1, row.bodies.second)});
        if (list.has_bodies) of_kind.bodies.push_back(row.bodies);
        add(of_kind, row);
    }
    result.first_edge.push_back(0);
    for (std::int32_t body = 0; body < bodies_of(list); ++body) {
        for (const Edge& edge : edges[body]) result.edges.push_back(edge);
        result.first_edge.push_back(static_cast<std::int64_t>(result.edges.size()));
    }
    return result;
}

/// Sorts the rows by kind; in each format, writes them by write(out, format) and reads them by read(bytes, name).
/// Requires rows(list, format) to be equal for the list before and after.
template <class Rows, class Write, class Read, class Same>
void require_kept(Rows list, Write write, Read read, Same rows) {
    std::stable_sort(list.rows.begin(), list.rows.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
    for (const auto& [format, name] : formats) {
        std::ostringstream out;
        write(out, format);
        if (rows(read(out.str(), name), format) != rows(list, format))
            fail(std::string("rows written and read differ: ") + name);
    }
}

template <class Read>
auto read_bytes(std::string_view bytes, Read read) {
    std::istringstream in{std::string(bytes)};
    return read(in);
}

}  // namespace

io::FeatureList read_impacts(std::string_view bytes, const std::string& name) {
    return read_bytes(bytes, [&](std::istream& in) { return io::read_impacts(in, name); });
}
io::FeatureList read_near(std::string_view bytes, const std::string& name) {
    return read_bytes(bytes, [&](std::istream& in) { return io::read_near(in, name); });
}
io::CandidateRows read_candidates(std::string_view bytes, const std::string& name) {
    return read_bytes(bytes, [&](std::istream& in) { return io::read_candidates(in, name); });
}

void require_kept(const io::FeatureList& list, bool impacts) {
    for (const io::FeatureRow& row : list.rows) {
        require_sound(row, list.has_bodies);
        require(row.value >= 0 && (!impacts || row.value <= 1), "a number that cannot be");
        require(!row.flag || row.value == 0, "what touches has another number than 0");
    }
    if (bodies_of(list) > most_bodies) return;
    Impacts of_impacts;
    Proximities of_near;
    if (impacts)
        of_impacts = result_of<Impacts>(list, [](ImpactList& to, const io::FeatureRow& row) {
            to.toi.push_back(row.value);
            to.start.push_back(row.flag);
        });
    else
        of_near = result_of<Proximities>(list, [](ProximityList& to, const io::FeatureRow& row) {
            to.squared_distance.push_back(row.value);
            to.touching.push_back(row.flag);
        });
    of_impacts.lists_triangle_pairs = true;
    const auto write = [&](std::ostream& out, PairFormat format) {
        impacts ? io::write_impacts(out, of_impacts, format) : io::write_near(out, of_near, format);
    };
    const auto read = [&](const std::string& bytes, const char* name) {
        return impacts ? read_impacts(bytes, name) : read_near(bytes, name);
    };
    const auto rows = [&](io::FeatureList of, PairFormat format) {
        if (!impacts && format == PairFormat::txt)  // .txt has no flag
            for (io::FeatureRow& row : of.rows) row.flag = row.value == 0;
        return of.rows;
    };
    require_kept(list, write, read, rows);
}

void require_kept(const io::CandidateRows& list) {
    for (const io::CandidateRow& row : list.rows) require_sound(row, list.has_bodies);
    if (bodies_of(list) > most_bodies) return;
    auto result = result_of<Candidates>(list, [](const CandidateList&, const io::CandidateRow&) {});
    result.listed.fill(true);
    require_kept(
        list, [&](std::ostream& out, PairFormat format) { io::write_candidates(out, result, format); }, read_candidates,
        [](const io::CandidateRows& of, PairFormat) { return of.rows; });
}

}  // namespace crumple::fuzz
