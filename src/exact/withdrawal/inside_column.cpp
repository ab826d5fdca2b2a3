#include "exact/withdrawal/inside_column.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace crumple {
namespace {

/// Face that a column crosses. The height of the crossing is `height` + e · `slope`.
struct ColumnCrossing {
    Rational height, slope;
    std::array<int, 2> jump;  ///< of the winding numbers of a and of b
    const ShearedFace* face;
};

void add_crossings(FacesOfColumn faces, std::size_t body, const Rational& lift, const ShearedPlace& p,
                   const ShearedPlace& w, std::vector<ColumnCrossing>& crossings) {
    for (const ShearedFace* face : faces) {
        if (face->is_upright() || !face->contains_next_to(p, w)) continue;
        ColumnCrossing& crossing = crossings.emplace_back();
        crossing.height = face->height(p) + lift;
        crossing.slope = face->slope(w);
        crossing.jump = {body == 0 ? face->jump() : 0, body == 0 ? 0 : face->jump()};
        crossing.face = face;
    }
}

/// Half of the plane in which a direction points: directions are sorted by it, then by the sign of cross products.
bool is_in_upper_half(const ShearedPlace& w) { return w.v > 0 || (w.v == 0 && w.u > 0); }

bool is_before_by_angle(const ShearedPlace& w, const ShearedPlace& x) {
    const bool upper = is_in_upper_half(w), other_upper = is_in_upper_half(x);
    return upper != other_upper ? upper : cross(w, x) > 0;
}

}  // namespace

std::vector<InsideInterval> insides_next_to(FacesOfColumn faces, const ShearedPlace& p, const ShearedPlace& w) {
    std::vector<ColumnCrossing> crossings;
    add_crossings(faces, 0, 0, p, w, crossings);
    std::sort(crossings.begin(), crossings.end(),
              [](const ColumnCrossing& x, const ColumnCrossing& y) { return x.height < y.height; });
    std::vector<InsideInterval> intervals;
    bool inside = false;
    int winding = 0;
    for (std::size_t i = 0; i < crossings.size();) {
        const ColumnCrossing& first = crossings[i];
        for (; i < crossings.size() && crossings[i].height == first.height; ++i) winding += crossings[i].jump[0];
        if (inside) intervals.back().high = first.height, intervals.back().top = first.face;
        if (winding != 0 && !inside) intervals.push_back({first.height, first.height, first.face, first.face});
        inside = winding != 0;
    }
    return intervals;
}

std::vector<LiftInterval> lifts_next_to(FacesOfColumn a, FacesOfColumn b, const ShearedPlace& p,
                                        const ShearedPlace& w) {
    std::vector<LiftInterval> lifts;
    const std::vector<InsideInterval> of_b = insides_next_to(b, p, w);
    if (of_b.empty()) return lifts;
    for (const InsideInterval& x : insides_next_to(a, p, w))
        for (const InsideInterval& y : of_b) lifts.push_back({x.low - y.high, x.high - y.low, x.top, y.bottom});
    return lifts;
}

std::vector<ShearedPlace> sectors_around(FacesOfColumn a, FacesOfColumn b, const Rational& lift,
                                         const ShearedPlace& p) {
    std::vector<ShearedPlace> borders{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    const auto add = [&](const ShearedPlace& w) {
        if (w == ShearedPlace{0, 0}) return;
        borders.push_back(w);
        borders.push_back(Rational(-1) * w);
    };
    std::vector<std::pair<Rational, const ShearedFace*>> at;  // height at p
    for (const bool of_b : {false, true})
        for (const ShearedFace* face : of_b ? b : a) {
            if (face->is_upright()) continue;
            for (std::size_t k = 0; k < 3; ++k)
                if (cross(face->edge(k), p - face->place(k)) == 0) add(face->edge(k));
            at.emplace_back(face->height(p) + (of_b ? lift : 0), face);
        }
    for (std::size_t i = 0; i < at.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            if (at[i].first != at[j].first) continue;
            const ShearedPoint &n = at[i].second->normal(), &m = at[j].second->normal();
            const ShearedPlace gradient{n.x * m.z - m.x * n.z, n.y * m.z - m.y * n.z};
            add({-gradient.v, gradient.u});
        }
    std::sort(borders.begin(), borders.end(), is_before_by_angle);
    std::vector<ShearedPlace> sectors;
    for (std::size_t i = 0; i < borders.size(); ++i) {
        const ShearedPlace &from = borders[i], &to = borders[i + 1 == borders.size() ? 0 : i + 1];
        if (cross(from, to) != 0) sectors.push_back(from + to);
    }
    return sectors;
}

bool overlap_next_to(FacesOfColumn a, FacesOfColumn b, const Rational& lift, const ShearedPlace& p,
                     const ShearedPlace& w) {
    std::vector<ColumnCrossing> crossings;
    add_crossings(a, 0, 0, p, w, crossings);
    add_crossings(b, 1, lift, p, w, crossings);
    const auto is_same = [](const ColumnCrossing& x, const ColumnCrossing& y) {
        return x.height == y.height && x.slope == y.slope;
    };
    std::sort(crossings.begin(), crossings.end(), [](const ColumnCrossing& x, const ColumnCrossing& y) {
        return x.height != y.height ? x.height < y.height : x.slope < y.slope;
    });
    std::array<int, 2> winding{};
    for (std::size_t i = 0; i < crossings.size(); ++i) {
        for (std::size_t body = 0; body < 2; ++body) winding[body] += crossings[i].jump[body];
        if (i + 1 < crossings.size() && is_same(crossings[i], crossings[i + 1])) continue;
        if (winding[0] != 0 && winding[1] != 0) return true;
    }
    return false;
}

}  // namespace crumple
