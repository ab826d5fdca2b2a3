// Study of virtual subdivision, the remedy of [MZ] 5.1 (the paper that the library follows: ARCHITECTURE.md) for
// triangles of very different size: pieces of large triangles replace them in clustering, sorting and sweeping.
//
// Here the pieces are real triangles, made by longest-edge bisection, so that the library's code sweeps them. Pieces of
// one triangle have the same group, and pairs within a group are left out. The figures are the time of all stages up to
// `sweep`, and the number of overlapping boxes that it finds. Virtual subdivision would have these costs, and would
// then have to remove repeated pairs of triangles before it decides them. So cutting pays only if one of the two
// figures falls by more than the other rises.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

constexpr std::int64_t most_pieces = 16;  ///< largest mean number of pieces per triangle; finer cuts are not measured

using Point = std::array<double, 3>;
using Corners = std::array<Point, 3>;

double squared_edge(const Corners& c, std::size_t k) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double d = c[(k + 1) % 3][axis] - c[k][axis];
        sum += d * d;
    }
    return sum;
}

std::size_t longest_edge(const Corners& c) {
    std::size_t longest = 0;
    for (const std::size_t k : {1u, 2u})
        if (squared_edge(c, k) > squared_edge(c, longest)) longest = k;
    return longest;
}

std::vector<Corners> corners_of(const io::TriangleMesh& mesh) {
    const std::vector<double> xyz = coordinates<double>(mesh);
    std::vector<Corners> triangles(static_cast<std::size_t>(mesh.triangle_count()));
    for (std::size_t c = 0; c < mesh.triangles.size(); ++c)
        for (std::size_t axis = 0; axis < 3; ++axis)
            triangles[c / 3][c % 3][axis] = xyz[3 * static_cast<std::size_t>(mesh.triangles[c]) + axis];
    return triangles;
}

/// Returns the pieces of all triangles, with no edge longer than `longest`. A piece's group is the number of its
/// triangle. Empty if there are more pieces than most_pieces allows.
io::TriangleMesh cut(const std::vector<Corners>& triangles, double longest) {
    io::TriangleMesh pieces;
    auto& xyz = pieces.vertices.emplace<std::vector<float>>();
    std::vector<Corners> left;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (left.assign(1, triangles[t]); !left.empty();) {
            const Corners piece = left.back();
            left.pop_back();
            const std::size_t k = longest_edge(piece);
            if (squared_edge(piece, k) > longest * longest) {
                Point middle;
                for (std::size_t axis = 0; axis < 3; ++axis)
                    middle[axis] = 0.5 * (piece[k][axis] + piece[(k + 1) % 3][axis]);
                Corners one = piece, other = piece;
                one[(k + 1) % 3] = other[k] = middle;
                left.insert(left.end(), {one, other});
                continue;
            }
            for (const Point& corner : piece) {
                pieces.triangles.push_back(static_cast<std::int32_t>(xyz.size() / 3));
                for (const double value : corner) xyz.push_back(static_cast<float>(value));
            }
            pieces.groups.push_back(static_cast<std::int32_t>(t));
        }
        if (pieces.triangle_count() > most_pieces * static_cast<std::int64_t>(triangles.size())) return {};
    }
    return pieces;
}

struct Cost {
    Summary until_sweep;
    std::int64_t overlaps = 0, members = 0;
};

Cost cost_of(const io::TriangleMesh& mesh, const IntersectionQuery& query, const Effort& effort) {
    Detector detector({.threads = 1});
    std::vector<double> until_sweep;
    Cost cost;
    const Contestant contestant{
        "",
        "",
        "",
        [&] {
            const Statistics& s = detector.find(mesh.view(), query).statistics;
            double sum = 0;
            for (const Stage stage : {Stage::bounds, Stage::subdivide, Stage::align, Stage::sort, Stage::sweep})
                sum += s[stage];
            until_sweep.push_back(sum);
            cost.overlaps = s.box_overlaps;
            cost.members = s.members;
        },
        {}};
    race(std::array{contestant}, effort);
    cost.until_sweep = summarise(until_sweep);
    return cost;
}

}  // namespace

nlohmann::json study_virtual_subdivision(const StudySettings& settings) {
    nlohmann::json scenes = nlohmann::json::array();
    for (const std::string& scene : choose_scenes(settings, {"five_decades", "ground", "Generic_Twin_right", "needles"},
                                                  {"five_decades", "ground", "fans", "needles"})) {
        const Workload workload = load(scene);
        const std::vector<Corners> triangles = corners_of(workload.a);
        double longest = 0;
        for (const Corners& c : triangles) longest = std::max(longest, std::sqrt(squared_edge(c, longest_edge(c))));

        Table table(fmt::format("virtual subdivision: {}, one thread", scene),
                    {"longest edge", "pieces", "members", "box overlaps", "until sweep, ms"});
        nlohmann::json rows = nlohmann::json::array();
        const auto add = [&](const std::string& edge, std::int64_t pieces, const Cost& cost) {
            table.row({edge, std::to_string(pieces), std::to_string(cost.members), std::to_string(cost.overlaps),
                       number(cost.until_sweep.median)});
            rows.push_back({{"longest_edge", edge},
                            {"pieces", pieces},
                            {"members", cost.members},
                            {"box_overlaps", cost.overlaps},
                            {"until_sweep", to_json(cost.until_sweep)}});
        };
        add("uncut", workload.triangle_count(), cost_of(workload.a, {}, settings.effort));
        // Welds vertices, so that adjacent pieces are recognised as such and skipped. This changes only the time of
        // `narrow`, which is not measured.
        const IntersectionQuery apart{
            .neighbours = Neighbours::skip, .weld = true, .filter = {.groups = PairScope::between}};
        for (int halvings = 1; halvings <= (settings.quick ? 3 : 12); ++halvings) {
            const io::TriangleMesh pieces = cut(triangles, std::ldexp(longest, -halvings));
            if (pieces.triangles.empty()) break;
            add(fmt::format("1/{}", 1 << halvings), pieces.triangle_count(), cost_of(pieces, apart, settings.effort));
        }
        table.print();
        scenes.push_back({{"workload", scene}, {"rows", std::move(rows)}});
    }
    return scenes;
}

}  // namespace crumple::benchmark
