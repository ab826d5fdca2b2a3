#include "exact/impact/roots.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <utility>

namespace crumple {
namespace {

/// Returns the middle of [k, k + 1] / 2^j.
Dyadic middle(const Dyadic& from) { return {2 * from.k + 1, from.j + 1}; }

/// Returns the largest float64 not above t, which is in [0, 1].
double round_down(const Dyadic& t) {
    if (t.k == 0) return 0;
    constexpr int precision = 53, least_unit = -1074;
    const int j = static_cast<int>(t.j);
    const int unit = std::max(static_cast<int>(msb(t.k)) + 1 - precision - j, least_unit);
    const Integer places = unit > -j ? t.k >> (unit + j) : t.k;
    return std::ldexp(static_cast<double>(static_cast<std::int64_t>(places)), unit > -j ? unit : -j);
}

/// Appends the roots of p in [0, 1] in ascending order. Returns false, with only some of them appended, if intervals of
/// length 2^-deepest would have to be halved. A square-free p needs no such limit.
bool isolate(const Polynomial& p, unsigned deepest, std::vector<Root>& roots) {
    // Halve [0, 1] until each open interval has either no root, or one root and none at its ends. Where roots are
    // simple, variations fall to 0 or 1 on short intervals. Intervals without variations are dropped at once, so the
    // stack has at most one entry for each root, however deep the halving goes.
    const Dyadic zero{0, 0}, one{1, 0};
    struct Part {
        Polynomial zoomed;  ///< the polynomial with the part mapped to [0, 1]; 0 if the part is a single number
        Dyadic from;
        int variations = 0;
    };
    std::vector<Part> parts;
    const auto push = [&](Part part) {
        part.variations = sign_variations(part.zoomed);
        if (part.variations > 0) parts.push_back(std::move(part));
    };
    if (p.sign_at(zero) == 0) roots.emplace_back(zero);
    push({p, zero});
    while (!parts.empty()) {
        const Part part = std::move(parts.back());
        parts.pop_back();
        if (part.zoomed.zero()) {
            roots.emplace_back(part.from);
            continue;
        }
        if (part.variations == 1 && part.zoomed.sign_at(zero) != 0 && part.zoomed.sign_at(one) != 0) {
            roots.emplace_back(p, part.from);
            continue;
        }
        if (part.from.j >= deepest) return false;
        const Dyadic half = middle(part.from);
        // Last in, first out: push from right to left.
        push({part.zoomed.zoomed({1, 1}), half});
        if (part.zoomed.sign_at({1, 1}) == 0) parts.push_back({Polynomial(), half});
        push({part.zoomed.zoomed({0, 1}), {2 * part.from.k, part.from.j + 1}});
    }
    if (p.sign_at(one) == 0) roots.emplace_back(one);
    return true;
}

}  // namespace

void Root::halve() {
    Dyadic half = middle(at_);
    const int sign = polynomial_.sign_at(half);
    if (sign == 0) {
        *this = Root(std::move(half));
    } else {
        // The root is simple and alone, so the sign changes there and nowhere else.
        at_ = sign == below_ ? std::move(half) : Dyadic{2 * at_.k, at_.j + 1};
    }
}

int Root::sign(const Polynomial& q) {
    // Most signs are nonzero, and a short interval proves it. Otherwise q is 0 at the root iff the greatest common
    // divisor of both polynomials is, which can have no root in the interval but this simple one. If q is not 0 there,
    // the interval has no root of q once it is short enough.
    constexpr unsigned short_interval = 16;
    bool zero_ruled_out = false;
    for (;; halve()) {
        if (exact()) return q.sign_at(at_);
        const int sign = sign_on_unit_interval(q.zoomed(at_));
        if (sign != 0 || q.zero()) return sign;
        if (at_.j < short_interval || zero_ruled_out) continue;
        const Polynomial common = greatest_common_divisor(std::array{polynomial_, q});
        if (common.sign_at(at_) != common.sign_at({at_.k + 1, at_.j})) return 0;
        zero_ruled_out = true;
    }
}

double Root::rounded_down() {
    // Once k has 53 bits, or the interval is as short as the least subnormal number, k / 2^j and (k + 1) / 2^j are
    // adjacent float64 numbers or closer. Then no float64 is between them, and the lower end of the interval, rounded
    // down, is the root, rounded down.
    const auto fine = [&] { return at_.j >= 1074 || (at_.k != 0 && msb(at_.k) >= 52); };
    while (!exact() && !fine()) halve();
    return round_down(at_);
}

std::vector<Root> roots_in_unit_interval(const Polynomial& p) {
    std::vector<Root> roots;
    if (p.sign_at({0, 0}) != 0 && p.sign_at({1, 0}) != 0 && sign_variations(p) == 0) return roots;  // the usual case
    // Multiple roots are rare, and dividing them out costs as much as about a hundred halvings.
    constexpr unsigned deep = 32;
    if (isolate(p, deep, roots)) return roots;
    roots.clear();
    isolate(square_free(p), UINT_MAX, roots);
    return roots;
}

}  // namespace crumple
