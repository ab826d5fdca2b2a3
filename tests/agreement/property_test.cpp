// Properties that relate results of similar queries: RapidCheck looks for the smallest soup on a small grid that
// violates one.

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <numeric>

#include "agreement/compare.h"

namespace crumple::test {
namespace {

using Grid = Soup<double>;

Grid any_soup() {
    Grid soup;
    const int width = *rc::gen::inRange(2, 7);
    const auto coordinate = rc::gen::map(rc::gen::inRange(0, width), [](int x) { return static_cast<double>(x); });
    soup.vertices = *rc::gen::nonEmpty(
        rc::gen::container<std::vector<std::array<double, 3>>>(rc::gen::container<std::array<double, 3>>(coordinate)));
    const auto corner = rc::gen::inRange<std::int32_t>(0, static_cast<std::int32_t>(soup.vertices.size()));
    soup.triangles = *rc::gen::container<std::vector<std::array<std::int32_t, 3>>>(
        rc::gen::container<std::array<std::int32_t, 3>>(corner));
    // Adds six copies of each of up to three degenerate triangles.
    for (int copies = *rc::gen::inRange(0, 4); copies > 0; --copies) {
        const std::int32_t a = *corner, b = *corner;
        const std::array<std::int32_t, 3> copied = *rc::gen::element(
            std::array{a, a, a}, std::array{a, a, b}, std::array{a, b, a}, std::array{b, a, a}, std::array{b, b, a});
        const auto place = *rc::gen::inRange<std::size_t>(0, soup.triangles.size() + 1);
        soup.triangles.insert(soup.triangles.begin() + static_cast<std::ptrdiff_t>(place), 6, copied);
    }
    soup.groups = *rc::gen::container<std::vector<std::int32_t>>(soup.triangles.size(), rc::gen::inRange(0, 3));
    return soup;
}

Detector any_detector() {
    Options options;
    options.backend = Backend::cpu;
    options.clusters = *rc::gen::inRange(0, 9);
    options.leaf_size = *rc::gen::element(1, 5, 20, 3000);
    options.threads = *rc::gen::inRange(1, 4);
    options.method.sweep =
        *rc::gen::element(SweepDirection::pca, SweepDirection::x, SweepDirection::y, SweepDirection::z);
    return Detector(options);
}

IntersectionQuery any_query() {
    IntersectionQuery query;
    query.neighbours = *rc::gen::element(Neighbours::geometric, Neighbours::skip);
    query.kind = *rc::gen::element(IntersectionKind::all, IntersectionKind::proper);
    query.weld = *rc::gen::arbitrary<bool>();
    return query;
}

std::vector<Pair> self_pairs(const Grid& soup, const IntersectionQuery& query) {
    return pairs_of(any_detector().find(soup.view(), query));
}
std::vector<Pair> between_pairs(const Grid& a, const Grid& b, const IntersectionQuery& query) {
    return pairs_of(any_detector().find({a.view(), b.view()}, query));
}

void require_same(const std::vector<Pair>& expected, std::vector<Pair> found) {
    std::sort(found.begin(), found.end());
    RC_ASSERT(difference(expected, found) == "");
}

/// Returns a random order of 0 to n − 1.
std::vector<std::int32_t> any_order(std::size_t n) {
    std::vector<std::int32_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[*rc::gen::inRange<std::size_t>(0, i)]);
    return order;
}

template <class Change>
Grid with_positions(Grid soup, Change change) {
    for (auto& p : soup.vertices) p = change(p);
    return soup;
}

RC_GTEST_PROP(Property, order_of_triangles_does_not_change_the_pairs, ()) {
    const Grid soup = any_soup();
    const IntersectionQuery query = any_query();
    const auto order = any_order(soup.triangles.size());
    Grid shuffled = soup;
    for (std::size_t i = 0; i < order.size(); ++i)
        shuffled.triangles[i] = soup.triangles[static_cast<std::size_t>(order[i])];
    std::vector<Pair> found = self_pairs(shuffled, query);
    for (Pair& pair : found) {
        const auto [low, high] =
            std::minmax(order[static_cast<std::size_t>(pair.a)], order[static_cast<std::size_t>(pair.b)]);
        pair = {low, high};
    }
    require_same(self_pairs(soup, query), found);
}

RC_GTEST_PROP(Property, order_of_vertices_and_corners_does_not_change_the_pairs, ()) {
    const Grid soup = any_soup();
    const IntersectionQuery query = any_query();
    const auto order = any_order(soup.vertices.size());
    Grid renamed = soup;
    for (std::size_t i = 0; i < order.size(); ++i)
        renamed.vertices[static_cast<std::size_t>(order[i])] = soup.vertices[i];
    for (auto& triangle : renamed.triangles) {
        for (auto& corner : triangle) corner = order[static_cast<std::size_t>(corner)];
        const auto turn = any_order(3);
        const auto old = triangle;
        for (std::size_t i = 0; i < 3; ++i) triangle[i] = old[static_cast<std::size_t>(turn[i])];
    }
    require_same(self_pairs(soup, query), self_pairs(renamed, query));
}

RC_GTEST_PROP(Property, swapping_or_mirroring_axes_does_not_change_the_pairs, ()) {
    const Grid soup = any_soup();
    const IntersectionQuery query = any_query();
    const auto axis = any_order(3);
    const std::array sign{*rc::gen::element(-1.0, 1.0), *rc::gen::element(-1.0, 1.0), *rc::gen::element(-1.0, 1.0)};
    const Grid turned = with_positions(soup, [&](const auto& p) {
        std::array<double, 3> q{};
        for (std::size_t i = 0; i < 3; ++i) q[i] = sign[i] * p[static_cast<std::size_t>(axis[i])];
        return q;
    });
    require_same(self_pairs(soup, query), self_pairs(turned, query));
}

RC_GTEST_PROP(Property, scaling_by_powers_of_two_keeps_pairs_and_scales_contact_points, ()) {
    const Grid soup = any_soup();
    IntersectionQuery query = any_query();
    query.output = Output::contacts;
    const double scale = std::ldexp(1.0, *rc::gen::element(-1074, -1022, -400, -150, -20, 20, 100, 400, 1020));
    const Grid scaled = with_positions(soup, [&](auto p) {
        for (double& x : p) x *= scale;
        return p;
    });
    Detector one = any_detector(), two = any_detector();
    const Intersections& expected = one.find(soup.view(), query);
    const Intersections& found = two.find(scaled.view(), query);
    require_same(pairs_of(expected), pairs_of(found));
    RC_ASSERT(found.contacts.points.size() == expected.contacts.points.size());
    for (std::size_t i = 0; i < expected.contacts.points.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // Among subnormals the rounding is coarser.
            if (scale < 0x1p-960) break;
            RC_ASSERT(found.contacts.points[i][axis] == scale * expected.contacts.points[i][axis]);
        }
    }
}

RC_GTEST_PROP(Property, exact_translations_do_not_change_the_pairs, ()) {
    const Grid soup = any_soup();
    const IntersectionQuery query = any_query();
    const auto offset = [] { return static_cast<double>(*rc::gen::inRange<std::int64_t>(-(1LL << 50), 1LL << 50)); };
    const std::array by{offset(), offset(), offset()};
    const Grid moved = with_positions(soup, [&](auto p) {
        for (std::size_t i = 0; i < 3; ++i) p[i] += by[i];
        return p;
    });
    require_same(self_pairs(soup, query), self_pairs(moved, query));
}

RC_GTEST_PROP(Property, swapping_meshes_swaps_pairs, ()) {
    const Grid a = any_soup(), b = any_soup();
    const IntersectionQuery query = any_query();
    std::vector<Pair> mirrored = between_pairs(b, a, query);
    for (Pair& pair : mirrored) std::swap(pair.a, pair.b);
    require_same(between_pairs(a, b, query), mirrored);
}

RC_GTEST_PROP(Property, two_meshes_equal_two_groups_of_one_soup, ()) {
    const Grid a = any_soup(), b = any_soup();
    IntersectionQuery query = any_query();
    const std::vector<Pair> expected = between_pairs(a, b, query);
    Grid joined = a;
    joined.groups.assign(a.triangles.size(), 0);
    joined.groups.resize(a.triangles.size() + b.triangles.size(), 1);
    joined.vertices.insert(joined.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (auto triangle : b.triangles) {
        for (auto& corner : triangle) corner += static_cast<std::int32_t>(a.vertices.size());
        joined.triangles.push_back(triangle);
    }
    query.filter.groups = PairScope::between;
    std::vector<Pair> found = self_pairs(joined, query);
    for (Pair& pair : found) pair.b -= static_cast<std::int32_t>(a.triangles.size());
    require_same(expected, found);
}

RC_GTEST_PROP(Property, pairs_within_and_between_groups_add_up_to_all_pairs, ()) {
    const Grid soup = any_soup();
    IntersectionQuery query = any_query();
    const std::vector<Pair> all = self_pairs(soup, query);
    query.filter.groups = PairScope::between;
    std::vector<Pair> joined = self_pairs(soup, query);
    query.filter.groups = PairScope::within;
    for (const Pair& pair : self_pairs(soup, query)) joined.push_back(pair);
    require_same(all, joined);

    // Excluding one pair of groups leaves all other pairs.
    query.filter.groups = PairScope::both;
    query.filter.excluded_groups = {{2, 0}};
    std::vector<Pair> kept;
    for (const Pair& pair : all) {
        const auto g = soup.groups[static_cast<std::size_t>(pair.a)], h = soup.groups[static_cast<std::size_t>(pair.b)];
        if (std::min(g, h) != 0 || std::max(g, h) != 2) kept.push_back(pair);
    }
    require_same(kept, self_pairs(soup, query));
}

RC_GTEST_PROP(Property, pairs_of_parts_add_up_to_all_pairs, ()) {
    const Grid soup = any_soup();
    const IntersectionQuery query = any_query();
    Detector detector = any_detector();
    std::vector<Pair> joined;
    for (const Part& part : detector.partition(soup.view(), {}, *rc::gen::inRange(1, 130))) {
        for (const Pair& pair : pairs_of(detector.find(part, query))) joined.push_back(pair);
    }
    require_same(self_pairs(soup, query), joined);
}

RC_GTEST_PROP(Property, welded_pairs_depend_on_positions_and_not_on_vertex_indices, ()) {
    const Grid soup = any_soup();
    IntersectionQuery query = any_query();
    query.weld = true;
    Grid exploded;
    for (const auto& triangle : soup.triangles) {
        const auto first = static_cast<std::int32_t>(exploded.vertices.size());
        exploded.triangles.push_back({first, first + 1, first + 2});
        for (const std::int32_t corner : triangle)
            exploded.vertices.push_back(soup.vertices[static_cast<std::size_t>(corner)]);
    }
    require_same(self_pairs(soup, query), self_pairs(exploded, query));
}

RC_GTEST_PROP(Property, stricter_options_only_remove_pairs, ()) {
    const Grid soup = any_soup();
    const bool weld = *rc::gen::arbitrary<bool>();
    const auto under = [&](Neighbours neighbours, IntersectionKind intersections) {
        IntersectionQuery query;
        query.weld = weld;
        query.neighbours = neighbours;
        query.kind = intersections;
        return self_pairs(soup, query);
    };
    const auto all = under(Neighbours::geometric, IntersectionKind::all);
    const auto proper = under(Neighbours::geometric, IntersectionKind::proper);
    const auto skip = under(Neighbours::skip, IntersectionKind::all);
    const auto both = under(Neighbours::skip, IntersectionKind::proper);
    RC_ASSERT(std::includes(all.begin(), all.end(), proper.begin(), proper.end()));
    RC_ASSERT(std::includes(all.begin(), all.end(), skip.begin(), skip.end()));
    std::vector<Pair> in_both;
    std::set_intersection(proper.begin(), proper.end(), skip.begin(), skip.end(), std::back_inserter(in_both));
    require_same(in_both, both);
}

RC_GTEST_PROP(Property, results_match_brute_force, ()) {
    const Grid soup = any_soup();
    IntersectionQuery query = any_query();
    query.output = Output::contacts;
    Detector cpu = any_detector(), reference({.backend = Backend::reference});
    const testing::AssertionResult same = same_result(cpu.find(soup.view(), query), reference.find(soup.view(), query));
    if (!same) RC_FAIL(same.message());
}

}  // namespace
}  // namespace crumple::test
