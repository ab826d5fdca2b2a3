#include "scenes/drape.h"

#include <algorithm>
#include <cmath>

#include "scenes/arithmetic.h"

namespace crumple::scenes {
namespace {

constexpr int steps = 2048;
constexpr double reach = 1.5 * Drape::half_width;  // arc length of the profile; beyond the sheet's corners
constexpr double contact = 0.3;                    // angle at which the sheet leaves the ball, in turns from the top
constexpr double bend = 1.2;                       // radius of the bend at the floor
constexpr double folds = 9, fold_drift = 0.04;     // number of folds; change of phase per unit of distance, in turns
constexpr double twist = 0.15;                     // rotation of the middle of the sheet by the ball, in turns

/// Returns the Bessel function of the first kind at w, by its power series, for 0 <= w <= 3.
double bessel(int order, double w) {
    double term = 1, sum = 0;
    for (int i = 1; i <= order; ++i) term *= w / (2 * i);
    for (int i = 1; i < 16; ++i) {
        sum += term;
        term *= -w * w / (4.0 * i * (i + order));
    }
    return sum;
}

}  // namespace

Drape::Drape(double folded, double clearance, std::uint64_t seed) : stations_(steps + 1), folded_(folded), seed_(seed) {
    const double step = reach / steps, turn = step / (2 * pi), ball = ball_radius + clearance;
    double slope = 0, radius = 0, height = ball_centre.z + ball, w = 0;
    for (int i = 0; i <= steps; ++i) {
        const double shortening = i > 0 ? radius / (i * step) : 1;
        for (int k = 0; k < 20; ++k) {  // Newton's method for J0(w) = shortening; J0' = -J1
            w = std::clamp(w + (bessel(0, w) - shortening) / std::max(0.2, bessel(1, w)), 0.0, 2.2);
        }
        stations_[static_cast<std::size_t>(i)] = {radius, height, slope, bessel(1, w), bessel(2, w)};
        if (height - floor < bend * (1 - cosine(slope))) {
            slope = std::max(0.0, slope - turn / bend);
        } else if (slope < contact * folded) {
            slope += turn / ball;
        }
        radius += step * cosine(slope);
        height -= step * sine(slope);
    }
}

Drape::Station Drape::at(double distance) const {
    const double x = distance / reach * steps;
    const int i = std::min(static_cast<int>(x), steps - 1);
    const Station *const a = &stations_[static_cast<std::size_t>(i)], *const b = a + 1;
    const auto blend = [&](double p, double q) { return p + (x - i) * (q - p); };
    return {blend(a->radius, b->radius), blend(a->height, b->height), blend(a->slope, b->slope),
            blend(a->rise, b->rise), blend(a->swing, b->swing)};
}

Vec3d Drape::operator()(double u, double v) const {
    const double distance = std::sqrt(u * u + v * v), around = angle(v, u);
    const Station s = at(distance);
    // One turn of the phase is one fold. Noise along the circle makes the folds differ.
    const double uneven = 0.35 * noise(seed_, 2 * cosine(around), 2 * sine(around));
    const double phase = folds * around + uneven + fold_drift * distance;
    const double unit = folded_ * distance / (2 * pi * folds);
    const double lift = 2 * unit * s.rise * (1 - cosine(phase));
    const double shift = unit * s.swing * sine(2 * phase) / std::max(s.radius, 0.1);
    const double radius = s.radius + lift * sine(s.slope), height = s.height + lift * cosine(s.slope);
    const double turned = around + shift + folded_ * twist * (1 - smooth_step(4, 14, distance));
    return {radius * cosine(turned), radius * sine(turned), height};
}

}  // namespace crumple::scenes
