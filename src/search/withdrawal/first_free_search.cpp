#include "search/withdrawal/first_free_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "exact/withdrawal/exact_withdrawal.h"
#include "exact/withdrawal/filtered_withdrawal.h"
#include "exact/withdrawal/inside_column.h"
#include "search/withdrawal/projected_tree.h"
#include "search/withdrawal/sheared_surface.h"

namespace crumple {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::int32_t samples_of_surface = 48;

/// Returns a number that is at least x − y and exceeds it by little.
double least_above_difference(double x, double y) { return std::nextafter(x - y, infinite); }

int common_exponent_of(const PlacedSurface& a, const PlacedSurface& b) {
    int exponent = std::numeric_limits<int>::max();
    for (const PlacedSurface* surface : {&a, &b})
        for (std::int32_t face = 0; face < surface->surface->face_count(); ++face)
            for (const Vec3d& p : surface->corners(face))
                if (p != Vec3d{}) exponent = std::min(exponent, common_exponent(std::array{p}));
    return exponent == std::numeric_limits<int>::max() ? 0 : exponent;
}

double largest_coordinate_of(const Bounds& box) { return max(largest(abs(box.low)), largest(abs(box.high))); }

/// Bounds on the t of two faces that one float64 filter gives; see enclose_withdrawal().
class PairFilterAlong {
   public:
    PairFilterAlong(const Vec3d& direction, int axis) : direction_(direction), axis_(axis) {}

    /// Returns bounds on the greatest t at which p and q + t · direction meet.
    WithdrawalBounds last(const FaceCorners& p, const FaceCorners& q) const {
        for (const FaceCorners* corners : {&p, &q})
            for (const Vec3d& corner : *corners)
                if (!in_double_word_range(corner)) return {-infinite, infinite};
        if (!in_double_word_range(direction_)) return {-infinite, infinite};
        return enclose_withdrawal(p, q, direction_, axis_);
    }
    /// Returns bounds on the least such t, in the same order.
    WithdrawalBounds first(const FaceCorners& p, const FaceCorners& q) const {
        const WithdrawalBounds bounds = PairFilterAlong(Vec3d{} - direction_, axis_).last(p, q);
        return {-bounds.upper, -bounds.lower};
    }

   private:
    const Vec3d direction_;
    const int axis_;
};

class FirstFreeSearch {
   public:
    FirstFreeSearch(const PlacedSurface& a, const PlacedSurface& b, const Vec3d& direction, ParallelFor& workers,
                    Cancellation& cancellation, MemoryMeter& meter, FirstFreeCounts& counts)
        : projection_(direction, max(largest_coordinate_of(a.box), largest_coordinate_of(b.box))),
          shear_(direction, projection_.axis(), common_exponent_of(a, b)),
          a_(a, projection_, shear_, workers, cancellation, meter),
          b_(b, projection_, shear_, workers, cancellation, meter),
          filter_(direction, projection_.axis()),
          cancellation_(cancellation),
          meter_(meter),
          counts_(counts) {}

    double find();

   private:
    struct NodePair {
        double difference;  ///< greatest difference of heights
        std::int32_t a, b;
        friend auto operator<=>(const NodePair&, const NodePair&) = default;
    };
    /// Lift up to which the insides of two faces cross, and a place where they do.
    struct PairEnd {
        Rational high;
        ShearedPlace place;
    };
    ShearedSurface& surface(std::size_t side) { return side == 0 ? a_ : b_; }

    void add_sample(const ShearedPlace& place);
    void add_samples(std::size_t side);
    std::optional<ShearedPlace> place_within(std::size_t side, std::int32_t face);
    /// Returns the columns at a place, at the current lift.
    InsideColumns columns_at(const ShearedPlace& place);
    bool advance_by_samples();

    template <class Keep, class Visit>
    void walk_pairs(Keep may_matter, Visit visit);
    bool may_touch(const Bounds& p, const Bounds& q) const;
    bool advance_by_pairs();
    std::optional<PairEnd> end_of_pair(std::int32_t f, std::int32_t g);

    bool advance_by_contacts();
    bool advance_at(const ShearedPlace& place);
    Rational followed(const ShearedPlace& place, const ShearedPlace& w);
    std::optional<Rational> followed_from(const ShearedPlace& place);
    bool cut_where_faces_cross(std::size_t side, const ShearedFace& face, const ShearedPlace& place,
                               PlacePolygon& polygon);
    bool advance_by_components();

    void set_lift(const Rational& lift);

    ProjectionAlong projection_;
    Shear shear_;
    ShearedSurface a_, b_;
    PairFilterAlong filter_;
    Cancellation& cancellation_;
    MemoryMeter& meter_;
    FirstFreeCounts& counts_;
    Rational lift_ = 0;                            ///< the insides overlap at all smaller lifts
    RoundedBounds lift_in_coordinates_{0}, t_{0};  ///< bounds on lift_, in the unit of coordinates and of the direction
    std::vector<LiftInterval> samples_;
    bool has_components_ = false;  ///< true if samples_ has a column through each component
};

void FirstFreeSearch::set_lift(const Rational& lift) {
    lift_ = lift;
    lift_in_coordinates_ = RoundedBounds(shear_.coordinate_of(lift));
    t_ = RoundedBounds(shear_.parameter_of(lift));
}

InsideColumns FirstFreeSearch::columns_at(const ShearedPlace& place) {
    return {place, a_.faces_at(place), b_.faces_at(place), lift_};
}

// Adds the intervals of a column, unless it meets an edge.
void FirstFreeSearch::add_sample(const ShearedPlace& place) {
    const InsideColumns columns = columns_at(place);
    if (!columns.is_generic()) return;
    for (const LiftInterval& lifts : columns.lifts()) samples_.push_back(lifts);
}

// Returns a place inside a face and inside no edge's projection. The places tried are on a curve that no line meets
// more than twice, so one of them is good. Returns nothing for an upright face.
std::optional<ShearedPlace> FirstFreeSearch::place_within(std::size_t side, std::int32_t face) {
    const ShearedFace f = surface(side).face(face);
    if (f.is_upright()) return std::nullopt;
    for (int k = 1;; ++k) {
        cancellation_.check();
        const int total = 10 + 3 * k + k * k;
        const Rational x(10, total), y(3 * k, total);
        const ShearedPlace place = f.place(0) + x * (f.place(1) - f.place(0)) + y * (f.place(2) - f.place(0));
        if (columns_at(place).is_generic()) return place;
    }
}

void FirstFreeSearch::add_samples(std::size_t side) {
    const std::int32_t count = surface(side).surface().surface->face_count();
    const std::int32_t step = std::max(1, count / samples_of_surface);
    for (std::int32_t face = 0; face < count; face += step) {
        cancellation_.check();
        if (const ShearedFace& f = surface(side).face(face); !f.is_upright())
            add_sample(Rational(1, 3) * (f.place(0) + f.place(1) + f.place(2)));
    }
}

bool FirstFreeSearch::advance_by_samples() {
    Rational lift = lift_;
    bool found = false;
    do {
        found = false;
        for (const LiftInterval& lifts : samples_)
            if (lifts.low < lift && lift < lifts.high) lift = lifts.high, found = true;
    } while (found);
    if (lift == lift_) return false;
    ++counts_.samples;
    set_lift(lift);
    return true;
}

// True if the faces of two boxes may touch at the current lift.
bool FirstFreeSearch::may_touch(const Bounds& p, const Bounds& q) const {
    if (p.low.x > q.high.x || q.low.x > p.high.x || p.low.y > q.high.y || q.low.y > p.high.y) return false;
    return least_above_difference(p.high.z, q.low.z) >= lift_in_coordinates_.low &&
           -least_above_difference(q.high.z, p.low.z) <= lift_in_coordinates_.high;
}

/// Visits the pairs of faces that may touch at the current lift, those with the greatest difference of heights first.
/// may_matter(difference): false for pairs that need not be visited.
template <class Keep, class Visit>
void FirstFreeSearch::walk_pairs(Keep may_matter, Visit visit) {
    ProjectedTree &a = a_.tree(), &b = b_.tree();
    std::priority_queue<NodePair> queue;
    const auto add = [&](std::int32_t i, std::int32_t j) {
        const ProjectedTree::Node &p = a.node(i), &q = b.node(j);
        const double difference = least_above_difference(p.box.high.z, q.box.low.z);
        if (!may_touch(p.box, q.box) || !may_matter(difference)) return;
        if (!are_apart(p.rectangle, q.rectangle, projection_.margin())) queue.push({difference, i, j});
    };
    add(ProjectedTree::root, ProjectedTree::root);
    for (std::int64_t visited = 0; !queue.empty() && may_matter(queue.top().difference); ++visited) {
        if (visited % 256 == 0) cancellation_.check();
        const NodePair pair = queue.top();
        queue.pop();
        const ProjectedTree::Node p = a.node(pair.a), q = b.node(pair.b);
        if (!p.is_leaf() || !q.is_leaf()) {
            const bool split_a = !p.is_leaf() && (q.is_leaf() || p.size() >= q.size());
            const std::int32_t child = split_a ? a.first_child(pair.a) : b.first_child(pair.b);
            for (const std::int32_t c : {child, child + 1}) split_a ? add(c, pair.b) : add(pair.a, c);
            continue;
        }
        for (std::int32_t i = p.begin; i < p.end; ++i)
            for (std::int32_t j = q.begin; j < q.end; ++j) {
                const ProjectedTriangle &f = a.triangle(i), &g = b.triangle(j);
                const double difference = least_above_difference(f.box.high.z, g.box.low.z);
                if (!may_touch(f.box, g.box) || !may_matter(difference)) continue;
                if (!are_apart(a.places(f), b.places(g), projection_.margin())) visit(f.face, g.face);
            }
    }
}

// Returns the end of the interval of lifts at which the insides of two faces cross, if it contains the current lift.
std::optional<FirstFreeSearch::PairEnd> FirstFreeSearch::end_of_pair(std::int32_t f, std::int32_t g) {
    const ShearedFace &p = a_.face(f), &q = b_.face(g);
    if (p.is_upright() || q.is_upright()) return std::nullopt;
    const PlacePolygon polygon(p, q);
    if (polygon.is_empty()) return std::nullopt;
    const auto [low, high] = polygon.lifts(p, q);
    if (low >= lift_ || high <= lift_ || !a_.is_clean(f) || !b_.is_clean(g)) return std::nullopt;
    return PairEnd{high, polygon.middle()};
}

bool FirstFreeSearch::advance_by_pairs() {
    std::optional<PairEnd> best;
    double t = t_.high;  // of `best`, rounded up
    double least_difference = lift_in_coordinates_.low;
    walk_pairs([&](double difference) { return difference > least_difference; },
               [&](std::int32_t f, std::int32_t g) {
                   const FaceCorners p = a_.surface().corners(f), q = b_.surface().corners(g);
                   if (filter_.last(p, q).upper < t || filter_.first(p, q).lower > t_.high) return;
                   const std::optional<PairEnd> end = end_of_pair(f, g);
                   if (!end || (best && end->high <= best->high)) return;
                   best = end;
                   t = rounded_up(shear_.parameter_of(end->high));
                   least_difference = RoundedBounds(shear_.coordinate_of(end->high)).low;
               });
    if (!best) return false;
    ++counts_.pairs;
    set_lift(best->high);
    add_sample(best->place);
    return true;
}

// Advances if the insides overlap at the current lift next to a place where faces touch.
bool FirstFreeSearch::advance_by_contacts() {
    constexpr std::size_t bytes_of_node = 32;  // of a set, besides its element
    PlaceSet places, of_pair;
    MemoryClaim memory(meter_);
    walk_pairs([](double) { return true; },
               [&](std::int32_t f, std::int32_t g) {
                   const FaceCorners p = a_.surface().corners(f), q = b_.surface().corners(g);
                   if (filter_.last(p, q).upper < t_.low || filter_.first(p, q).lower > t_.high) return;
                   cancellation_.check();
                   a_.forget_faces();
                   b_.forget_faces();
                   add_contact_places(a_.face(f), b_.face(g), lift_, of_pair);
                   while (!of_pair.empty()) {
                       const auto [at, is_new, old] = places.insert(of_pair.extract(of_pair.begin()));
                       if (is_new) memory.add(bytes_of_node + bytes_of(*at));
                   }
               });
    for (const ShearedPlace& place : places) {
        cancellation_.check();
        a_.forget_faces();
        b_.forget_faces();
        if (advance_at(place)) return true;
    }
    return false;
}

bool FirstFreeSearch::advance_at(const ShearedPlace& place) {
    const InsideColumns columns = columns_at(place);
    const std::vector<InsideColumns::Sector> sectors = columns.sectors();
    std::optional<ShearedPlace> overlapping;
    auto sector = sectors.begin();
    for (; sector != sectors.end() && !overlapping; ++sector) overlapping = columns.overlap_in(*sector);
    if (!overlapping) return false;
    ++counts_.contacts;
    // Places of contact depend on the lift, so intervals at such places might end at ever closer lifts. The last
    // contact of two faces is one of finitely many lifts.
    Rational lift = followed(place, *overlapping);
    for (--sector; sector != sectors.end(); ++sector)
        for (const LiftInterval& lifts : columns.lifts_in(*sector))
            if (lifts.low <= lift_ && lifts.high > lift) lift = lifts.high;
    set_lift(lift);
    return true;
}

// Returns a lift such that the insides overlap at all lifts from the current one to that. They do so at the current one
// next to the place, in direction w.
Rational FirstFreeSearch::followed(const ShearedPlace& place, const ShearedPlace& w) {
    // No line contains more than two of these places.
    for (Rational e(1, 4);; e /= 16) {
        cancellation_.check();
        const ShearedPlace near = place + e * w + (e * e) * ShearedPlace{-w.v, w.u};
        if (const std::optional<Rational> lift = followed_from(near)) return *lift;
    }
}

// The same, from a place at which the overlap has a length. Returns nothing if there is no overlap or if the place is
// on a line in which faces of one surface meet.
std::optional<Rational> FirstFreeSearch::followed_from(const ShearedPlace& place) {
    const InsideColumns columns = columns_at(place);
    if (!columns.is_generic()) return std::nullopt;
    for (const LiftInterval& lifts : columns.lifts()) {
        if (lifts.low >= lift_ || lifts.high <= lift_) continue;
        PlacePolygon polygon(*lifts.top_of_a, *lifts.bottom_of_b);
        // As far as the two faces meet no other face of their surfaces, a is inside below its face, and b above its
        // face. So their insides overlap at lifts that are a little less than the difference of heights.
        if (!cut_where_faces_cross(0, *lifts.top_of_a, place, polygon) ||
            !cut_where_faces_cross(1, *lifts.bottom_of_b, place, polygon))
            return std::nullopt;
        return polygon.lifts(*lifts.top_of_a, *lifts.bottom_of_b).second;
    }
    return std::nullopt;
}

// Cuts a polygon along the lines in which a face meets the planes of others, so that the part with the place remains.
// Returns false if the place is on such a line.
bool FirstFreeSearch::cut_where_faces_cross(std::size_t side, const ShearedFace& face, const ShearedPlace& place,
                                            PlacePolygon& polygon) {
    bool ok = true;
    const auto cut = [&](const ShearedPlace& p, const ShearedPlace& w) {
        const Rational at = cross(w, place - p);
        ok = ok && at != 0;
        polygon.cut(p, at > 0 ? w : Rational(-1) * w);
    };
    for (const std::int32_t f : surface(side).neighbours(face.index())) {
        const ShearedFace& other = surface(side).face(f);
        if (other.is_degenerate()) continue;
        if (other.is_upright()) {
            for (std::size_t k = 0; k < 3; ++k)
                if (const ShearedPlace w = other.edge(k); !(w == ShearedPlace{0, 0})) {
                    cut(other.place(k), w);
                    break;
                }
            continue;
        }
        const ShearedPoint &n = face.normal(), &m = other.normal();
        const ShearedPlace gradient{n.x * m.z - m.x * n.z, n.y * m.z - m.y * n.z}, w{-gradient.v, gradient.u};
        const ShearedPlace& from = face.place(0);
        const Rational above = other.height(from) - face.height(from);
        if (w == ShearedPlace{0, 0}) {
            for (std::size_t k = 0; k < 3 && above == 0; ++k) cut(other.place(k), other.edge(k));
            continue;
        }
        // The heights are equal where above + slope · s = 0, at from + s · gradient.
        const Rational slope = other.slope(gradient) - face.slope(gradient);
        cut(from + (-above / slope) * gradient, w);
    }
    return ok;
}

bool FirstFreeSearch::advance_by_components() {
    if (std::exchange(has_components_, true)) return false;
    for (std::size_t side = 0; side < 2; ++side) {
        const ClosedSurface& closed = *surface(side).surface().surface;
        const Array<std::int32_t>& ends = closed.components();
        for (std::size_t c = 0; c + 1 < ends.size(); ++c)
            for (const std::int32_t face : closed.faces(ends[c], ends[c + 1])) {
                const std::optional<ShearedPlace> place = place_within(side, face);
                if (!place) continue;
                add_sample(*place);
                break;
            }
    }
    return advance_by_samples();
}

double FirstFreeSearch::find() {
    for (std::size_t side = 0; side < 2; ++side) add_samples(side);
    while (advance_by_samples() || advance_by_pairs() || advance_by_contacts() || advance_by_components()) {
        cancellation_.check();
        a_.forget_faces();
        b_.forget_faces();
    }
    return rounded_up(shear_.parameter_of(lift_));
}

}  // namespace

double find_first_free(const PlacedSurface& a, const PlacedSurface& b, const Vec3d& direction, ParallelFor& workers,
                       Cancellation& cancellation, MemoryMeter& meter, FirstFreeCounts& counts) {
    if (a.surface->face_count() == 0 || b.surface->face_count() == 0) return 0;
    return FirstFreeSearch(a, b, direction, workers, cancellation, meter, counts).find();
}

}  // namespace crumple
