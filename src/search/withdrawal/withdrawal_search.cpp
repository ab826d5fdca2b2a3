#include "search/withdrawal/withdrawal_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include "crumple/error.h"
#include "exact/withdrawal/exact_withdrawal.h"
#include "exact/withdrawal/filtered_withdrawal.h"
#include "geometry/expansion.h"
#include "search/withdrawal/projected_tree.h"

namespace crumple {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Returns x − y, rounded up.
double difference_above(double x, double y) {
    const TwoTerms sum = two_sum(x, -y);
    return sum.low > 0 || std::isinf(sum.high) ? std::nextafter(sum.high, infinity) : sum.high;
}

bool places_overlap(const Bounds& a, const Bounds& b) {
    const bool u = (a.low.x > b.high.x) | (b.low.x > a.high.x), v = (a.low.y > b.high.y) | (b.low.y > a.high.y);
    return !(u | v);
}

/// Returns the greatest difference of heights of two boxes, rounded up.
double height_difference(const Bounds& a, const Bounds& b) { return difference_above(a.high.z, b.low.z); }

/// Greatest t of the pairs tested so far. Collects pairs of triangles that may exceed it, and decides these exactly
/// when there are many, or at the end.
class GreatestWithdrawal {
   public:
    GreatestWithdrawal(const PlacedSurface& a, const PlacedSurface& b, const Vec3d& direction, int axis,
                       Cancellation& cancellation, WithdrawalCounts& counts)
        : a_(a),
          b_(b),
          direction_(direction),
          axis_(axis),
          in_range_(in_double_word_range(direction)),
          cancellation_(cancellation),
          counts_(counts) {}

    /// True if a pair whose heights differ by at most `difference` may matter.
    bool may_exceed(double difference) const { return difference > least_difference_; }
    /// Tests two triangles whose heights differ by at most `difference`.
    void test(std::int32_t face_a, std::int32_t face_b, double difference);
    /// Returns the greatest t, rounded up.
    double decide();

   private:
    /// Pair of triangles whose t may exceed `lower_bound_`.
    struct Undecided {
        double upper;
        std::int32_t a, b;
        friend bool operator<(const Undecided& x, const Undecided& y) {
            return std::tuple(-x.upper, x.a, x.b) < std::tuple(-y.upper, y.a, y.b);
        }
    };
    static constexpr std::size_t most_undecided = 32;

    WithdrawalBounds bounds(const FaceCorners& p, const FaceCorners& q, double difference) const;
    void raise(double lower_bound);
    void decide(const Undecided& pair);

    const PlacedSurface &a_, &b_;
    const Vec3d& direction_;
    const int axis_;
    const bool in_range_;
    Cancellation& cancellation_;
    WithdrawalCounts& counts_;
    std::vector<Undecided> undecided_;
    std::optional<Rational> greatest_;  ///< greatest t > 0 that was decided exactly
    double result_ = 0;                 ///< it, rounded up
    double lower_bound_ = 0;            ///< the result is at least this: result_, or a lower bound of an undecided pair
    double least_difference_ = 0;       ///< the difference of heights at lower_bound_, rounded down
};

WithdrawalBounds GreatestWithdrawal::bounds(const FaceCorners& p, const FaceCorners& q, double difference) const {
    const auto in_range = [](const FaceCorners& c) {
        return in_double_word_range(c[0]) && in_double_word_range(c[1]) && in_double_word_range(c[2]);
    };
    if (in_range_ && (a_.in_range || in_range(p)) && (b_.in_range || in_range(q)))
        return enclose_withdrawal(p, q, direction_, axis_);
    return {-infinity, std::nextafter(difference / std::abs(direction_[axis_]), infinity)};
}

void GreatestWithdrawal::test(std::int32_t face_a, std::int32_t face_b, double difference) {
    ++counts_.box_overlaps;
    const WithdrawalBounds t = bounds(a_.corners(face_a), b_.corners(face_b), difference);
    if (!(t.upper > lower_bound_)) return;
    undecided_.push_back({t.upper, face_a, face_b});
    if (t.lower > lower_bound_) raise(t.lower);
    if (undecided_.size() == most_undecided) decide();
}

void GreatestWithdrawal::raise(double lower_bound) {
    lower_bound_ = lower_bound;
    // The product rounded to nearest, and then down. If parts of it underflow, the number below it is low enough.
    const double step = std::abs(direction_[axis_]), product = lower_bound * step;
    least_difference_ = product;
    const bool is_plain = product >= 0x1p-900 && product <= 0x1p900 && lower_bound <= 0x1p900 && step <= 0x1p900;
    if (!is_plain || two_product(lower_bound, step).low < 0) least_difference_ = std::nextafter(product, -infinity);
}

void GreatestWithdrawal::decide(const Undecided& pair) {
    cancellation_.check();
    ++counts_.rational_tests;
    const std::optional<Rational> t = withdrawal_rationally(a_.corners(pair.a), b_.corners(pair.b), direction_);
    if (!t || *t <= 0 || (greatest_ && *t <= *greatest_)) return;
    greatest_ = t;
    result_ = rounded_up(*t);
    if (result_ > lower_bound_) raise(result_);
}

double GreatestWithdrawal::decide() {
    std::sort(undecided_.begin(), undecided_.end());
    for (const Undecided& pair : undecided_)
        if (pair.upper > result_) decide(pair);
    undecided_.clear();
    return result_;
}

/// Visits pairs of nodes of two trees, those with the greatest difference of heights first.
class WithdrawalWalk {
   public:
    WithdrawalWalk(ProjectedTree& a, ProjectedTree& b, double margin, GreatestWithdrawal& greatest,
                   Cancellation& cancellation, WithdrawalCounts& counts)
        : a_(a), b_(b), margin_(margin), greatest_(greatest), cancellation_(cancellation), counts_(counts) {}

    void walk();

   private:
    struct NodePair {
        double difference;
        std::int32_t a, b;
        friend auto operator<=>(const NodePair&, const NodePair&) = default;
    };

    void add(std::int32_t a, std::int32_t b);
    void visit(const NodePair& pair);
    void test_leaves(const ProjectedTree::Node& a, const ProjectedTree::Node& b);

    ProjectedTree &a_, &b_;
    const double margin_;  ///< margin of the projection
    GreatestWithdrawal& greatest_;
    Cancellation& cancellation_;
    WithdrawalCounts& counts_;
    std::priority_queue<NodePair> queue_;
};

void WithdrawalWalk::add(std::int32_t a, std::int32_t b) {
    const ProjectedTree::Node &p = a_.node(a), &q = b_.node(b);
    const double difference = height_difference(p.box, q.box);
    if (!places_overlap(p.box, q.box) || !greatest_.may_exceed(difference)) return;
    if (!are_apart(p.rectangle, q.rectangle, margin_)) queue_.push({difference, a, b});
}

void WithdrawalWalk::walk() {
    add(ProjectedTree::root, ProjectedTree::root);
    while (!queue_.empty() && greatest_.may_exceed(queue_.top().difference)) {
        if (counts_.node_pairs++ % 256 == 0) cancellation_.check();
        const NodePair pair = queue_.top();
        queue_.pop();
        visit(pair);
    }
}

void WithdrawalWalk::visit(const NodePair& pair) {
    const ProjectedTree::Node &a = a_.node(pair.a), &b = b_.node(pair.b);
    if (a.is_leaf() && b.is_leaf()) return test_leaves(a, b);
    const bool split_a = !a.is_leaf() && (b.is_leaf() || a.size() >= b.size());
    const std::int32_t child = split_a ? a_.first_child(pair.a) : b_.first_child(pair.b);
    for (const std::int32_t c : {child, child + 1}) split_a ? add(c, pair.b) : add(pair.a, c);
}

void WithdrawalWalk::test_leaves(const ProjectedTree::Node& a, const ProjectedTree::Node& b) {
    for (std::int32_t i = a.begin; i < a.end; ++i)
        for (std::int32_t j = b.begin; j < b.end; ++j) {
            const ProjectedTriangle &p = a_.triangle(i), &q = b_.triangle(j);
            const double difference = height_difference(p.box, q.box);
            if (!places_overlap(p.box, q.box) || !greatest_.may_exceed(difference)) continue;
            if (!are_apart(a_.places(p), b_.places(q), margin_)) greatest_.test(p.face, q.face, difference);
        }
}

double largest_coordinate(const Bounds& box) { return max(largest(abs(box.low)), largest(abs(box.high))); }

}  // namespace

double find_withdrawal(const PlacedSurface& a, const PlacedSurface& b, const Vec3d& direction, ParallelFor& workers,
                       Cancellation& cancellation, WithdrawalCounts& counts) {
    if (!all_finite(direction)) throw Error(ErrorCode::invalid_argument, "the direction of a withdrawal is not finite");
    if (direction == Vec3d{}) throw Error(ErrorCode::invalid_argument, "the direction of a withdrawal is 0");
    if (a.surface->face_count() == 0 || b.surface->face_count() == 0) return 0;
    const ProjectionAlong projection(direction, max(largest_coordinate(a.box), largest_coordinate(b.box)));
    ProjectedTree tree_a(a, projection, workers, cancellation), tree_b(b, projection, workers, cancellation);
    GreatestWithdrawal greatest(a, b, direction, projection.axis(), cancellation, counts);
    WithdrawalWalk(tree_a, tree_b, projection.margin(), greatest, cancellation, counts).walk();
    return greatest.decide();
}

}  // namespace crumple
