#include "exact/withdrawal/inside_column.h"

#include <algorithm>
#include <utility>

namespace crumple {
namespace {

/// Half of the plane in which a direction points: directions are sorted by it, then by the sign of cross products.
bool is_in_upper_half(const ShearedPlace& w) { return w.v > 0 || (w.v == 0 && w.u > 0); }

bool is_before_by_angle(const ShearedPlace& w, const ShearedPlace& x) {
    const bool upper = is_in_upper_half(w), other_upper = is_in_upper_half(x);
    return upper != other_upper ? upper : cross(w, x) > 0;
}

}  // namespace

InsideColumns::InsideColumns(const ShearedPlace& p, FacesOfColumn a, FacesOfColumn b, const Rational& lift)
    : place_(p), lift_(lift) {
    for (const ShearedFace* face : a)
        crossings_.push_back({face, 0, face->height(p), {face->side(0, p), face->side(1, p), face->side(2, p)}});
    for (const ShearedFace* face : b)
        crossings_.push_back({face, 1, face->height(p) + lift, {face->side(0, p), face->side(1, p), face->side(2, p)}});
    std::sort(crossings_.begin(), crossings_.end(),
              [](const Crossing& x, const Crossing& y) { return x.height < y.height; });
}

bool InsideColumns::is_generic() const {
    return std::all_of(crossings_.begin(), crossings_.end(), [](const Crossing& crossing) {
        const auto& [x, y, z] = crossing.side;
        return x > 0 && y > 0 && z > 0;
    });
}

/// True if the columns at p + e · w cross the face.
bool InsideColumns::continues(const Crossing& crossing, const ShearedPlace& w) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (crossing.side[k] > 0) continue;
        if (crossing.side[k] < 0) return false;
        const Rational along = cross(crossing.face->edge(k), w);
        if (crossing.face->jump() > 0 ? along <= 0 : along >= 0) return false;
    }
    return true;
}

std::vector<ShearedPlace> InsideColumns::sectors() const {
    std::vector<ShearedPlace> borders{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    const auto add = [&](const ShearedPlace& w) {
        if (w == ShearedPlace{0, 0}) return;
        borders.push_back(w);
        borders.push_back(Rational(-1) * w);
    };
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        const ShearedFace& face = *crossings_[i].face;
        for (std::size_t k = 0; k < 3; ++k)
            if (crossings_[i].side[k] == 0) add(face.edge(k));
        for (std::size_t j = i + 1; j < crossings_.size() && crossings_[j].height == crossings_[i].height; ++j) {
            const ShearedPoint &n = face.normal(), &m = crossings_[j].face->normal();
            add({m.y * n.z - n.y * m.z, n.x * m.z - m.x * n.z});  // faces have equal slopes along this
        }
    }
    std::sort(borders.begin(), borders.end(), is_before_by_angle);
    std::vector<ShearedPlace> sectors;
    for (std::size_t i = 0; i < borders.size(); ++i) {
        const ShearedPlace &from = borders[i], &to = borders[i + 1 == borders.size() ? 0 : i + 1];
        if (cross(from, to) != 0) sectors.push_back(from + to);
    }
    return sectors;
}

bool InsideColumns::overlap_next_to(const ShearedPlace& w) const {
    std::array<int, 2> winding{};
    const auto both_inside = [&] { return winding[0] != 0 && winding[1] != 0; };
    std::vector<std::pair<Rational, const Crossing*>> tied;  // by slope
    for (std::size_t i = 0; i < crossings_.size();) {
        const Rational& height = crossings_[i].height;
        tied.clear();
        const std::size_t begin = i;
        for (; i < crossings_.size() && crossings_[i].height == height; ++i)
            if (continues(crossings_[i], w)) tied.emplace_back(0, &crossings_[i]);
        const bool in_order = i - begin == 1;
        for (auto& [slope, crossing] : tied)
            if (!in_order) slope = crossing->face->slope(w);
        std::sort(tied.begin(), tied.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        for (std::size_t k = 0; k < tied.size(); ++k) {
            winding[tied[k].second->body] += tied[k].second->face->jump();
            const bool is_last_of_plane = k + 1 == tied.size() || tied[k + 1].first != tied[k].first;
            if (is_last_of_plane && both_inside()) return true;
        }
    }
    return false;
}

std::vector<InsideColumns::InsideInterval> InsideColumns::insides(std::size_t body, const ShearedPlace& w) const {
    std::vector<InsideInterval> intervals;
    bool inside = false;
    int winding = 0;
    for (std::size_t i = 0; i < crossings_.size();) {
        const Rational& height = crossings_[i].height;
        const ShearedFace* face = nullptr;
        for (; i < crossings_.size() && crossings_[i].height == height; ++i)
            if (crossings_[i].body == body && continues(crossings_[i], w)) {
                face = crossings_[i].face;
                winding += face->jump();
            }
        if (!face) continue;
        if (inside) intervals.back().high = height, intervals.back().top = face;
        if (winding != 0 && !inside) intervals.push_back({height, height, face, face});
        inside = winding != 0;
    }
    return intervals;
}

std::vector<LiftInterval> InsideColumns::lifts_next_to(const ShearedPlace& w) const {
    std::vector<LiftInterval> lifts;
    const std::vector<InsideInterval> of_b = insides(1, w);
    if (of_b.empty()) return lifts;
    for (const InsideInterval& x : insides(0, w))
        for (const InsideInterval& y : of_b)
            lifts.push_back({x.low - y.high + lift_, x.high - y.low + lift_, x.top, y.bottom});
    return lifts;
}

}  // namespace crumple
