// Compares regions, boxes and thicknesses of overlaps with those of bodies made of cubes, where they can be counted
// cell by cell.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "overlaps/closed_bodies.h"
#include "rounds.h"

namespace crumple {
namespace {

using Soup = test::Soup<double>;
using test::Dice;
using Cell = std::array<int, 3>;

/// Set of cubes of a cubic grid: cube (i, j, k) has the corner first + size · (i, j, k).
struct Cubes {
    int count, size;  ///< cubes along each axis, and their size
    std::array<int, 3> first;
    std::vector<bool> full;

    bool at(const Cell& c) const {
        for (const int i : c)
            if (i < 0 || i >= count) return false;
        return full[static_cast<std::size_t>((c[0] * count + c[1]) * count + c[2])];
    }
    /// True if the cube that contains a point is full; the point lies on no face.
    bool contains(const std::array<double, 3>& p) const {
        Cell c{};
        for (std::size_t k = 0; k < 3; ++k) c[k] = static_cast<int>(std::floor((p[k] - first[k]) / size));
        return at(c);
    }

    /// Surface, with vertices shared by all cubes.
    Soup surface() const {
        Soup soup;
        std::map<Cell, std::int32_t> index;
        const auto vertex = [&](const Cell& c) {
            const auto [found, is_new] = index.emplace(c, static_cast<std::int32_t>(soup.vertices.size()));
            if (is_new) {
                auto& p = soup.vertices.emplace_back();
                for (std::size_t k = 0; k < 3; ++k) p[k] = first[k] + size * c[k];
            }
            return found->second;
        };
        for (int n = 0; n < count * count * count; ++n) {
            const Cell c{n / (count * count), n / count % count, n % count};
            if (!at(c)) continue;
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (const int step : {-1, 1}) {
                    Cell next = c;
                    next[axis] += step;
                    if (at(next)) continue;
                    std::array<std::int32_t, 4> square{};
                    for (std::size_t k = 0; k < 4; ++k) {
                        Cell corner = c;
                        corner[axis] += step > 0;
                        corner[(axis + 1) % 3] += k == 1 || k == 2;
                        corner[(axis + 2) % 3] += k >= 2;
                        square[k] = vertex(corner);
                    }
                    if (step < 0) std::swap(square[1], square[3]);
                    soup.triangles.push_back({square[0], square[1], square[2]});
                    soup.triangles.push_back({square[0], square[2], square[3]});
                }
        }
        return soup;
    }
};

/// True if cubes around a grid point that are full are connected by faces, and those that are not, too. `cube`: the one
/// after the point.
bool is_manifold_at(const Cubes& cubes, const Cell& cube) {
    std::array<int, 2> all{}, reached{};  // by value: bits of the eight cubes
    for (int i = 0; i < 8; ++i) {
        const bool full = cubes.at({cube[0] - (i & 1), cube[1] - (i >> 1 & 1), cube[2] - (i >> 2)});
        all[full] |= 1 << i;
        if (reached[full] == 0) reached[full] = 1 << i;
    }
    for (int round = 0; round < 8; ++round)
        for (int i = 0; i < 8; ++i)
            for (const int step : {1, 2, 4})
                for (std::size_t value = 0; value < 2; ++value)
                    if (all[value] >> i & 1 && reached[value] >> (i ^ step) & 1) reached[value] |= 1 << i;
    return reached == all;
}

/// Returns random cubes whose surface is a manifold.
Cubes random_cubes(Dice& dice, int count, int size, std::array<int, 3> first) {
    Cubes cubes{count, size, first,
                std::vector<bool>(static_cast<std::size_t>(count * count * count), dice.chance(0.5))};
    if (count == 1) cubes.full[0] = true;
    for (int flips = count == 1 ? 0 : 20 + dice.below(100); flips > 0; --flips) {
        const Cell c{dice.below(count), dice.below(count), dice.below(count)};
        const auto n = static_cast<std::size_t>((c[0] * count + c[1]) * count + c[2]);
        cubes.full[n] = !cubes.full[n];
        for (int corner = 0; corner < 8; ++corner)
            if (!is_manifold_at(cubes, {c[0] + (corner & 1), c[1] + (corner >> 1 & 1), c[2] + (corner >> 2)})) {
                cubes.full[n] = !cubes.full[n];
                break;
            }
    }
    return cubes;
}

struct Region {
    double volume = 0;
    std::array<double, 3> area_vector{}, low{}, high{};
    std::array<std::int32_t, 2> pieces{};

    auto key() const { return std::tie(volume, low, high, area_vector, pieces); }
    friend bool operator==(const Region& x, const Region& y) { return x.key() == y.key(); }
    friend bool operator<(const Region& x, const Region& y) { return x.key() < y.key(); }
};

/// Overlap of two sets of cubes, cut into cells by the planes of both.
class CellOverlap {
   public:
    CellOverlap(const Cubes& a, const Cubes& b) : a_(a) {
        for (std::size_t k = 0; k < 3; ++k) {
            std::vector<double>& plane = plane_[k];
            for (const Cubes* cubes : {&a, &b})
                for (int i = 0; i <= cubes->count; ++i) plane.push_back(cubes->first[k] + i * cubes->size);
            plane.push_back(-100), plane.push_back(100);
            std::sort(plane.begin(), plane.end());
            n_[k] = static_cast<int>(plane.size()) - 1;
        }
        full_.resize(static_cast<std::size_t>(n_[0] * n_[1] * n_[2]));
        for (int n = 0; n < n_[0] * n_[1] * n_[2]; ++n)
            full_[static_cast<std::size_t>(n)] = a.contains(middle(cell(n))) && b.contains(middle(cell(n)));
        label();
    }

    /// Returns the regions, sorted: a connected set of cells of the overlap and one outside of it have one boundary in
    /// common, if they meet.
    std::vector<Region> regions() const {
        std::map<std::pair<int, int>, Region> found;
        std::map<std::pair<int, int>, std::array<std::vector<FaceEdges>, 2>> faces;  // by body
        for (int n = 0; n < n_[0] * n_[1] * n_[2]; ++n) {
            const Cell c = cell(n);
            if (!is_full(c)) continue;
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (const int step : {-1, 1}) {
                    Cell next = c;
                    next[axis] += step;
                    if (is_full(next)) continue;
                    const std::pair labels(label_of(c), label_of(next));
                    const auto [region, is_new] = found.try_emplace(labels);
                    const bool is_of_second = a_.contains(middle(next));
                    add_face(c, axis, step, is_of_second, is_new, region->second);
                    faces[labels][is_of_second].push_back(edges_of(c, axis, step));
                }
        }
        std::vector<Region> regions;
        for (auto& [labels, region] : found) {
            for (std::size_t body = 0; body < 2; ++body) region.pieces[body] = count_pieces(faces[labels][body]);
            regions.push_back(region);
        }
        std::sort(regions.begin(), regions.end());
        return regions;
    }

   private:
    Cell cell(int n) const { return {n / (n_[1] * n_[2]), n / n_[2] % n_[1], n % n_[2]}; }
    std::size_t index(const Cell& c) const { return static_cast<std::size_t>((c[0] * n_[1] + c[1]) * n_[2] + c[2]); }
    bool is_full(const Cell& c) const { return full_[index(c)]; }
    int label_of(const Cell& c) const { return label_[index(c)]; }
    double plane(std::size_t axis, int i) const { return plane_[axis][static_cast<std::size_t>(i)]; }
    std::array<double, 3> middle(const Cell& c) const {
        std::array<double, 3> p{};
        for (std::size_t k = 0; k < 3; ++k) p[k] = (plane(k, c[k]) + plane(k, c[k] + 1)) / 2;
        return p;
    }

    /// Labels connected sets of cells with the same value.
    void label() {
        label_.assign(full_.size(), -1);
        int labels = 0;
        for (int n = 0; n < n_[0] * n_[1] * n_[2]; ++n) {
            if (label_[static_cast<std::size_t>(n)] >= 0) continue;
            std::vector<Cell> open{cell(n)};
            label_[static_cast<std::size_t>(n)] = labels;
            while (!open.empty()) {
                const Cell c = open.back();
                open.pop_back();
                for (std::size_t axis = 0; axis < 3; ++axis)
                    for (const int step : {-1, 1}) {
                        Cell next = c;
                        next[axis] += step;
                        if (next[axis] < 0 || next[axis] >= n_[axis] || is_full(next) != is_full(c) ||
                            label_of(next) >= 0)
                            continue;
                        label_[index(next)] = labels;
                        open.push_back(next);
                    }
            }
            ++labels;
        }
    }

    /// Edges of the grid at the border of a face: axis, and indices of the lower end.
    using FaceEdges = std::array<std::array<int, 4>, 4>;
    static FaceEdges edges_of(const Cell& c, std::size_t axis, int step) {
        FaceEdges edges{};
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t along = (axis + 1 + k / 2) % 3, across = 3 - axis - along;
            Cell corner = c;
            corner[axis] += step > 0;
            corner[across] += k % 2 == 1;
            edges[k] = {static_cast<int>(along), corner[0], corner[1], corner[2]};
        }
        return edges;
    }
    /// Returns the number of sets of faces that are connected by edges.
    static std::int32_t count_pieces(const std::vector<FaceEdges>& faces) {
        DisjointSets sets(faces.size());
        std::map<std::array<int, 4>, std::int32_t> first;
        for (std::int32_t i = 0; i < std::ssize(faces); ++i)
            for (const auto& edge : faces[static_cast<std::size_t>(i)])
                sets.join(i, first.try_emplace(edge, i).first->second);
        std::int32_t count = 0;
        for (std::int32_t i = 0; i < std::ssize(faces); ++i) count += sets.find(i) == i;
        return count;
    }

    void add_face(const Cell& c, std::size_t axis, int step, bool outside_in_a, bool is_first, Region& region) const {
        const double at = plane(axis, c[axis] + (step > 0));
        double area = step;
        std::array<double, 3> low{}, high{};
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = k == axis ? at : plane(k, c[k]);
            high[k] = k == axis ? at : plane(k, c[k] + 1);
            if (k != axis) area *= high[k] - low[k];
        }
        if (axis == 0) region.volume += at * area;
        if (!outside_in_a) region.area_vector[axis] += area;  // the face belongs to the surface of the first body
        for (std::size_t k = 0; k < 3; ++k) {
            region.low[k] = is_first ? low[k] : std::min(region.low[k], low[k]);
            region.high[k] = is_first ? high[k] : std::max(region.high[k], high[k]);
        }
    }

    const Cubes& a_;
    std::array<std::vector<double>, 3> plane_;
    std::array<int, 3> n_{};
    std::vector<bool> full_;
    std::vector<int> label_;
};

std::vector<Region> regions_of(const Overlaps& found) {
    std::vector<Region> regions;
    for (std::size_t r = 0; r < found.region_volume.size(); ++r) {
        Region& region = regions.emplace_back(Region{found.region_volume[r], found.region_area_vector[r]});
        region.pieces = found.region_pieces[r];
        std::copy_n(found.region_box[r].begin(), 3, region.low.begin());
        std::copy_n(found.region_box[r].begin() + 3, 3, region.high.begin());
    }
    std::sort(regions.begin(), regions.end());
    return regions;
}

/// Cubes of the first body are larger, so that the second one pierces its faces; or its whole surface is one cube.
TEST(OverlapRegions, are_those_of_cells) {
    Detector detector(Options{.threads = 1});
    const int cases = std::max(60, scaled_rounds(100));
    int compared = 0, with_several = 0, with_cavities = 0, with_pieces = 0;
    for (int seed = 0; seed < cases; ++seed) {
        Dice dice(static_cast<unsigned>(seed));
        const bool one_cube = dice.chance(0.4);
        const Cubes a = one_cube ? random_cubes(dice, 1, 24, {0, 0, 0}) : random_cubes(dice, 3, 8, {0, 0, 0});
        const Cubes b = random_cubes(dice, 4 + dice.below(2), 6, {-5 + 2 * dice.below(4), -3, 1});
        const CellOverlap cells(a, b);
        const std::vector<Region> expected = cells.regions();
        for (const bool exchanged : {false, true}) {
            const Soup one = (exchanged ? b : a).surface(), other = (exchanged ? a : b).surface();
            const Overlaps& found =
                detector.find({one.view(), other.view()}, OverlapQuery{.curves = true, .regions = true});
            std::vector<Region> regions = regions_of(found);
            if (exchanged)
                for (Region& region : regions) {
                    for (double& x : region.area_vector) x = 0 - x;
                    std::swap(region.pieces[0], region.pieces[1]);
                }
            std::sort(regions.begin(), regions.end());
            ASSERT_EQ(regions.size(), expected.size()) << "case " << seed << (exchanged ? ", exchanged" : "");
            EXPECT_TRUE(regions == expected) << "case " << seed << (exchanged ? ", exchanged" : "");
            for (const std::uint8_t merged : found.region_is_merged) EXPECT_EQ(merged, 0) << "case " << seed;
            for (std::size_t j = 0; j < found.curve_regions.size(); ++j) {
                const auto region = static_cast<std::size_t>(found.curve_regions[j]);
                ASSERT_LT(region, found.region_volume.size());
                const auto& box = found.region_box[region];
                const auto& point = found.curve_points[static_cast<std::size_t>(found.curve_point_offsets[j])];
                for (std::size_t k = 0; k < 3; ++k)
                    EXPECT_TRUE(box[k] <= point[k] && point[k] <= box[k + 3]) << "case " << seed;
            }
        }
        ++compared;
        with_several += expected.size() > 1;
        with_cavities += !expected.empty() && expected[0].volume < 0;
        with_pieces += std::any_of(expected.begin(), expected.end(),
                                   [](const Region& region) { return region.pieces[0] > 1 || region.pieces[1] > 1; });
    }
    std::printf("%d cases, %d of them with several regions, %d with cavities\n", compared, with_several, with_cavities);
    EXPECT_GT(with_several, cases / 100);
    EXPECT_GT(with_cavities, 0);
    EXPECT_GT(with_pieces, cases / 100);
}

Soup box_soup(std::array<double, 3> low, std::array<double, 3> high) {
    Soup soup = Cubes{1, 1, {0, 0, 0}, {true}}.surface();
    for (auto& p : soup.vertices)
        for (std::size_t k = 0; k < 3; ++k) p[k] = p[k] == 0 ? low[k] : high[k];
    return soup;
}

/// Pieces depend neither on the number of curves nor on vertices: both a rod through a plate and a pipe that ends
/// within it have two curves.
TEST(OverlapRegions, have_two_pieces_of_a_surface_that_is_passed_through) {
    using Pieces = std::array<std::int32_t, 2>;
    const Soup plate = box_soup({-8, -8, -1}, {8, 8, 1});
    Cubes pipe{3, 2, {-3, -3, 0}, std::vector<bool>(27, true)};
    for (const std::size_t hole : {12U, 13U, 14U}) pipe.full[hole] = false;
    const auto pieces = [&](const Soup& one, const Soup& other) {
        const Overlaps found =
            Detector().find({one.view(), other.view()}, OverlapQuery{.curves = true, .regions = true});
        EXPECT_EQ(found.region_pieces.size(), 1u);
        return std::pair(found.region_pieces[0], found.curve_closed.size());
    };
    const Soup rod = box_soup({-1, -1, -5}, {1, 1, 5});
    EXPECT_EQ(pieces(rod, plate), std::pair(Pieces{1, 2}, std::size_t{2}));
    EXPECT_EQ(pieces(plate, rod), std::pair(Pieces{2, 1}, std::size_t{2}));
    EXPECT_EQ(pieces(box_soup({-1, -1, 0}, {1, 1, 5}), plate), std::pair(Pieces{1, 1}, std::size_t{1}));
    EXPECT_EQ(pieces(pipe.surface(), plate), std::pair(Pieces{1, 1}, std::size_t{2}));
    EXPECT_EQ(pieces(box_soup({7, -1, -5}, {9, 1, 5}), plate), std::pair(Pieces{1, 1}, std::size_t{1})) << "a notch";
    const Soup within = box_soup({1, 1, -0.5}, {2, 2, 0.5});
    EXPECT_EQ(pieces(within, plate), std::pair(Pieces{1, 0}, std::size_t{0}));
}

/// A body of two crossing slabs, whose faces cross on a face of the other body, so that the windings along a curve
/// vary.
TEST(OverlapRegions, are_merged_where_sheets_cross) {
    const auto box = box_soup;
    const Soup floor = box({-8, -8, -2}, {8, 8, 0});
    const Soup slabs = test::joined(box({-4, -1, -1}, {4, 1, 3}), box({-1, -4.5, -1.5}, {1, 4.5, 2}));
    Detector detector;
    for (const auto& [one, other] : {std::pair(floor, slabs), std::pair(slabs, floor)}) {
        const Overlaps& found = detector.find({one.view(), other.view()}, OverlapQuery{.regions = true});
        ASSERT_EQ(found.region_volume.size(), 1u);
        EXPECT_EQ(found.region_is_merged[0], 1);
        EXPECT_EQ(found.region_is_contact[0], 0);
        EXPECT_EQ(found.region_volume[0], found.volume[0]);
        EXPECT_EQ(found.volume[0], 8 * 2 * 1 + 2 * 9 * 1.5);
        EXPECT_EQ(found.thickness[0], 1.5);
        EXPECT_EQ(found.box[0], (std::array<double, 6>{-4, -4.5, -1.5, 4, 4.5, 0}));
    }
    // Two slabs side by side are two regions.
    const Soup apart = test::joined(box({-4, -1, -1}, {4, 1, 3}), box({-1, 2, -1.5}, {1, 4.5, 2}));
    const Overlaps& found = detector.find({floor.view(), apart.view()}, OverlapQuery{.regions = true});
    ASSERT_EQ(found.region_volume.size(), 2u);
    EXPECT_EQ(found.region_is_merged[0] + found.region_is_merged[1], 0);
}

/// Boxes that touch: a region without volume, or none.
TEST(OverlapRegions, of_bodies_that_touch_are_contacts) {
    const Soup cube = Cubes{1, 2, {0, 0, 0}, {true}}.surface(), above = Cubes{1, 2, {1, 1, 2}, {true}}.surface();
    Detector detector;
    const Overlaps& found = detector.find({cube.view(), above.view()}, OverlapQuery{.regions = true});
    ASSERT_EQ(found.count, 1);
    EXPECT_EQ(found.volume[0], 0);
    for (std::size_t r = 0; r < found.region_volume.size(); ++r) {
        EXPECT_EQ(found.region_volume[r], 0);
        EXPECT_EQ(found.region_is_contact[r], 1);
        EXPECT_EQ(found.region_thickness[r], 0);
    }
}

}  // namespace
}  // namespace crumple
