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

std::pair<ShearedPlace, ShearedPlace> InsideColumns::sides(const Crossing& crossing) {
    ShearedPlace from{1, 0}, to{1, 0};
    const bool forward = crossing.face->jump() > 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (crossing.side[k] != 0) continue;
        const ShearedPlace along = crossing.face->edge(k), back = Rational(-1) * along;
        const bool starts = crossing.side[(k + 2) % 3] == 0, ends = crossing.side[(k + 1) % 3] == 0;
        // An edge that starts at p is only one side of the sector, and so is one that ends at p.
        if (!ends) (forward ? from : to) = along;
        if (!starts) (forward ? to : from) = back;
    }
    return {from, to};
}

std::vector<InsideColumns::Sector> InsideColumns::sectors() const {
    std::vector<ShearedPlace> borders{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    std::vector<std::pair<ShearedPlace, ShearedPlace>> of_faces;
    for (const Crossing& crossing : crossings_) {
        of_faces.push_back(sides(crossing));
        for (const ShearedPlace& w : {of_faces.back().first, of_faces.back().second}) borders.push_back(w);
    }
    std::sort(borders.begin(), borders.end(), is_before_by_angle);
    const auto is_parallel = [](const ShearedPlace& w, const ShearedPlace& x) {
        return !is_before_by_angle(w, x) && !is_before_by_angle(x, w);
    };
    borders.erase(std::unique(borders.begin(), borders.end(), is_parallel), borders.end());
    std::vector<Sector> sectors(borders.size());
    for (std::size_t i = 0; i < borders.size(); ++i)
        sectors[i].from = borders[i], sectors[i].to = borders[i + 1 == borders.size() ? 0 : i + 1];
    const auto index = [&](const ShearedPlace& w) {
        return static_cast<std::size_t>(std::lower_bound(borders.begin(), borders.end(), w, is_before_by_angle) -
                                        borders.begin());
    };
    for (std::size_t c = 0; c < crossings_.size(); ++c) {
        const std::size_t begin = index(of_faces[c].first), end = index(of_faces[c].second);
        std::size_t i = begin;
        do {
            sectors[i].crossings.push_back(c);
            i = i + 1 == sectors.size() ? 0 : i + 1;
        } while (i != end);
    }
    return sectors;
}

// Divides the sector where two faces that meet at p change their order.
std::optional<ShearedPlace> InsideColumns::overlap_in(const Sector& sector) const {
    std::vector<ShearedPlace> borders{sector.from, sector.to};
    for (std::size_t i = 0; i < sector.crossings.size(); ++i)
        for (std::size_t j = i + 1; j < sector.crossings.size(); ++j) {
            const Crossing &x = crossings_[sector.crossings[i]], &y = crossings_[sector.crossings[j]];
            if (x.height != y.height) break;
            const ShearedPoint &n = x.face->normal(), &m = y.face->normal();
            const ShearedPlace w{m.y * n.z - n.y * m.z, n.x * m.z - m.x * n.z};
            for (const ShearedPlace& along : {w, Rational(-1) * w})
                if (cross(sector.from, along) > 0 && cross(along, sector.to) > 0) borders.push_back(along);
        }
    std::sort(borders.begin(), borders.end(),
              [](const ShearedPlace& w, const ShearedPlace& x) { return cross(w, x) > 0; });
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
        const ShearedPlace w = borders[i] + borders[i + 1];
        if (cross(borders[i], borders[i + 1]) != 0 && overlap_next_to(sector, w)) return w;
    }
    return std::nullopt;
}

bool InsideColumns::overlap_next_to(const Sector& sector, const ShearedPlace& w) const {
    std::array<int, 2> winding{};
    std::vector<std::pair<Rational, const Crossing*>> tied;  // by slope
    for (std::size_t i = 0; i < sector.crossings.size();) {
        const Rational& height = crossings_[sector.crossings[i]].height;
        tied.clear();
        for (; i < sector.crossings.size() && crossings_[sector.crossings[i]].height == height; ++i)
            tied.emplace_back(0, &crossings_[sector.crossings[i]]);
        for (auto& [slope, crossing] : tied)
            if (tied.size() > 1) slope = crossing->face->slope(w);
        std::sort(tied.begin(), tied.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
        for (std::size_t k = 0; k < tied.size(); ++k) {
            winding[tied[k].second->body] += tied[k].second->face->jump();
            const bool is_last_of_plane = k + 1 == tied.size() || tied[k + 1].first != tied[k].first;
            if (is_last_of_plane && winding[0] != 0 && winding[1] != 0) return true;
        }
    }
    return false;
}

std::vector<InsideColumns::InsideInterval> InsideColumns::insides(std::size_t body, const Sector& sector) const {
    std::vector<InsideInterval> intervals;
    bool inside = false;
    int winding = 0;
    for (std::size_t i = 0; i < sector.crossings.size();) {
        const Rational& height = crossings_[sector.crossings[i]].height;
        const ShearedFace* face = nullptr;
        for (; i < sector.crossings.size() && crossings_[sector.crossings[i]].height == height; ++i)
            if (const Crossing& crossing = crossings_[sector.crossings[i]]; crossing.body == body) {
                face = crossing.face;
                winding += face->jump();
            }
        if (!face) continue;
        if (inside) intervals.back().high = height, intervals.back().top = face;
        if (winding != 0 && !inside) intervals.push_back({height, height, face, face});
        inside = winding != 0;
    }
    return intervals;
}

std::vector<LiftInterval> InsideColumns::lifts_in(const Sector& sector) const {
    std::vector<LiftInterval> lifts;
    const std::vector<InsideInterval> of_b = insides(1, sector);
    if (of_b.empty()) return lifts;
    for (const InsideInterval& x : insides(0, sector))
        for (const InsideInterval& y : of_b)
            lifts.push_back({x.low - y.high + lift_, x.high - y.low + lift_, x.top, y.bottom});
    return lifts;
}

std::vector<LiftInterval> InsideColumns::lifts() const {
    Sector all;
    for (std::size_t c = 0; c < crossings_.size(); ++c) all.crossings.push_back(c);
    return lifts_in(all);
}

}  // namespace crumple
