#include "exact/impact/polynomial.h"

#include <array>
#include <utility>

namespace crumple {
namespace {

/// Replaces p(u) by p(u + k), by repeated Horner's scheme.
void shift(std::vector<Integer>& coefficients, const Integer& k) {
    const bool by_one = k == 1;  // the usual case, which needs no multiplication
    for (std::size_t done = 0; done + 1 < coefficients.size(); ++done) {
        for (std::size_t i = coefficients.size() - 1; i-- > done;) {
            if (by_one) {
                coefficients[i] += coefficients[i + 1];
            } else {
                coefficients[i] += k * coefficients[i + 1];
            }
        }
    }
}

/// Returns the Bernstein coefficients over [0, 1], last one first, the i-th times binomial(n, i) > 0. They are the
/// coefficients of (1 + s)^n p(1 / (1 + s)), that is, those of p reversed and then shifted by 1.
std::vector<Integer> bernstein(const Polynomial& p) {
    std::vector<Integer> coefficients(p.coefficients().rbegin(), p.coefficients().rend());
    shift(coefficients, 1);
    return coefficients;
}

/// Returns the remainder of the division of p by q, times a nonzero number; q is not 0.
Polynomial pseudo_remainder(const Polynomial& p, const Polynomial& q) {
    std::vector<Integer> rest = p.coefficients();
    const std::vector<Integer>& divisor = q.coefficients();
    while (rest.size() >= divisor.size()) {
        const Integer top = rest.back();
        const std::size_t offset = rest.size() - divisor.size();
        for (Integer& c : rest) c *= divisor.back();
        for (std::size_t i = 0; i < divisor.size(); ++i) rest[offset + i] -= top * divisor[i];
        rest.pop_back();
    }
    return Polynomial(std::move(rest)).primitive();
}

/// Returns p / q for primitive p and q if q divides p. The quotient is then a polynomial over the integers by Gauss's
/// lemma, so each division below has no remainder.
Polynomial quotient(const Polynomial& p, const Polynomial& q) {
    std::vector<Integer> rest = p.coefficients();
    const std::vector<Integer>& divisor = q.coefficients();
    std::vector<Integer> result(rest.size() - divisor.size() + 1);
    for (std::size_t offset = result.size(); offset-- > 0;) {
        result[offset] = rest[offset + divisor.size() - 1] / divisor.back();
        for (std::size_t i = 0; i < divisor.size(); ++i) rest[offset + i] -= result[offset] * divisor[i];
    }
    return Polynomial(std::move(result));
}

}  // namespace

Polynomial::Polynomial(std::vector<Integer> coefficients) : coefficients_(std::move(coefficients)) { trim(); }

void Polynomial::trim() {
    while (!coefficients_.empty() && coefficients_.back() == 0) coefficients_.pop_back();
}

int Polynomial::sign_at(const Dyadic& t) const {
    // Horner's scheme for 2^(j n) p(k / 2^j).
    Integer sum = 0;
    unsigned power = 0;
    for (std::size_t i = coefficients_.size(); i-- > 0; power += t.j) {
        sum *= t.k;
        sum += coefficients_[i] << power;
    }
    return sum.sign();
}

Polynomial Polynomial::zoomed(const Dyadic& t) const {
    std::vector<Integer> coefficients = coefficients_;
    unsigned power = 0;
    for (std::size_t i = coefficients.size(); i-- > 0; power += t.j) coefficients[i] <<= power;
    shift(coefficients, t.k);
    return Polynomial(std::move(coefficients));
}

Polynomial Polynomial::derivative() const {
    std::vector<Integer> coefficients;
    coefficients.reserve(coefficients_.size());
    for (std::size_t i = 1; i < coefficients_.size(); ++i) coefficients.push_back(Integer(i) * coefficients_[i]);
    return Polynomial(std::move(coefficients));
}

Polynomial Polynomial::primitive() const {
    Integer content = 0;
    for (const Integer& c : coefficients_) content = mp::gcd(content, c);
    Polynomial result = *this;
    if (content > 1) {
        for (Integer& c : result.coefficients_) c /= content;
    }
    return result;
}

Polynomial operator+(const Polynomial& p, const Polynomial& q) {
    const bool p_longer = p.degree() > q.degree();
    Polynomial sum = p_longer ? p : q;
    const Polynomial& other = p_longer ? q : p;
    for (std::size_t i = 0; i < other.coefficients_.size(); ++i) sum.coefficients_[i] += other.coefficients_[i];
    sum.trim();
    return sum;
}

Polynomial operator-(const Polynomial& p, const Polynomial& q) {
    Polynomial difference = p;
    if (p.degree() < q.degree()) difference.coefficients_.resize(q.coefficients_.size());
    for (std::size_t i = 0; i < q.coefficients_.size(); ++i) difference.coefficients_[i] -= q.coefficients_[i];
    difference.trim();
    return difference;
}

Polynomial operator*(const Polynomial& p, const Polynomial& q) {
    if (p.zero() || q.zero()) return {};
    Polynomial product;
    product.coefficients_.resize(p.coefficients_.size() + q.coefficients_.size() - 1);
    for (std::size_t i = 0; i < p.coefficients_.size(); ++i) {
        for (std::size_t k = 0; k < q.coefficients_.size(); ++k)
            product.coefficients_[i + k] += p.coefficients_[i] * q.coefficients_[k];
    }
    return product;
}

Polynomial greatest_common_divisor(std::span<const Polynomial> polynomials) {
    // Euclid's algorithm. Remainders are made primitive; otherwise coefficients would double in length at each step.
    Polynomial divisor;
    for (const Polynomial& p : polynomials) {
        Polynomial rest = p.primitive();
        while (!rest.zero()) {
            Polynomial remainder = divisor.zero() ? Polynomial() : pseudo_remainder(divisor, rest);
            divisor = std::exchange(rest, std::move(remainder));
        }
        if (divisor.degree() == 0) break;
    }
    return divisor;
}

Polynomial square_free(const Polynomial& p) {
    // A root of order m of p is one of order m − 1 of its derivative, so of order 1 of p / gcd(p, p').
    return quotient(p.primitive(), greatest_common_divisor(std::array{p, p.derivative()}));
}

int sign_variations(const Polynomial& p) {
    int variations = 0, last = 0;
    for (const Integer& c : bernstein(p)) {
        if (c == 0) continue;
        if (last != 0 && c.sign() != last) ++variations;
        last = c.sign();
    }
    return variations;
}

int sign_on_unit_interval(const Polynomial& p) {
    const std::vector<Integer> coefficients = bernstein(p);
    if (coefficients.empty()) return 0;
    const int sign = coefficients.front().sign();
    for (const Integer& c : coefficients) {
        if (c.sign() != sign) return 0;
    }
    return sign;
}

}  // namespace crumple
