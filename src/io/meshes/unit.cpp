// Conversion between units of length. Each unit is an integer multiple of 0.1 micrometres.

#include "io/meshes/unit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/float_environment.h"
#include "crumple/error.h"
#include "io/scenes/pose_product.h"

namespace crumple::io {

namespace {

struct Length {
    Unit unit;
    int tenths_of_micrometres;
    const char *name, *in_3mf, *english;
};

constexpr Length lengths[] = {
    {Unit::micrometre, 10, "um", "micron", "micrometre"},
    {Unit::millimetre, 10'000, "mm", "millimeter", "millimetre"},
    {Unit::centimetre, 100'000, "cm", "centimeter", "centimetre"},
    {Unit::inch, 254'000, "in", "inch", "inch"},
    {Unit::foot, 3'048'000, "ft", "foot", "foot"},
    {Unit::metre, 10'000'000, "m", "meter", "metre"},
};

const Length& length_of(Unit unit) { return lengths[static_cast<std::size_t>(unit) - 1]; }

/// Multiplication by a ratio of integers with a single rounding: fused multiply-add gives the exact remainders of the
/// product and of the quotient, and these correct the rounded quotient.
class Scale {
   public:
    Scale(Unit from, Unit to) {
        const int a = length_of(from).tenths_of_micrometres, b = length_of(to).tenths_of_micrometres;
        const int over = a / std::gcd(a, b), under = b / std::gcd(a, b);
        times_ = over, by_ = under;
    }
    double operator()(double x) const {
        const double product = x * times_, lost = std::fma(x, times_, -product);
        const double quotient = product / by_, left = std::fma(-quotient, by_, product) + lost;
        return quotient + left / by_;
    }

   private:
    double times_, by_;
};

template <class Scalar>
std::vector<Scalar> scaled(const std::vector<Scalar>& xyz, const Scale& scale) {
    std::vector<Scalar> result(xyz.size());
    for (std::size_t i = 0; i < xyz.size(); ++i) {
        result[i] = static_cast<Scalar>(scale(double{xyz[i]}));
        if (!std::isfinite(result[i]))
            throw Error(ErrorCode::invalid_argument,
                        "vertex " + std::to_string(i / 3) + " overflows its precision in the other unit",
                        Element::vertex, static_cast<std::int64_t>(i / 3));
    }
    return result;
}

void check(Unit to) {
    if (to == Unit::unknown) throw Error(ErrorCode::invalid_argument, "cannot convert to an unknown unit");
}

}  // namespace

const char* name_in_3mf(Unit unit) { return length_of(unit == Unit::unknown ? Unit::millimetre : unit).in_3mf; }

std::optional<Unit> unit_in_3mf(std::string_view name) {
    for (const Length& length : lengths)
        if (name == length.in_3mf) return length.unit;
    return std::nullopt;
}

double metres_in(Unit unit) { return Scale(unit, Unit::metre)(1); }

void check_same_unit(Unit a, Unit b) {
    if (a == b || a == Unit::unknown || b == Unit::unknown) return;
    throw Error(ErrorCode::invalid_argument, std::string("the meshes are in different units, ") + name_of(a) + " and " +
                                                 name_of(b) + "; convert one of them");
}

const char* name_of(Unit unit) { return unit == Unit::unknown ? "unknown" : length_of(unit).name; }

Unit unit_named(std::string_view name) {
    for (const Length& length : lengths)
        if (name == length.name || name == length.in_3mf || name == length.english) return length.unit;
    throw Error(ErrorCode::invalid_argument, "'" + std::string(name) + "' is not a unit: use um, mm, cm, in, ft or m",
                Element::option);
}

void convert_unit(TriangleMesh& mesh, Unit to) {
    check(to);
    if (mesh.unit != Unit::unknown && mesh.unit != to) {
        const FloatEnvironment environment;
        std::visit([scale = Scale(mesh.unit, to)](auto& xyz) { xyz = scaled(xyz, scale); }, mesh.vertices);
    }
    mesh.unit = to;
}

void convert_unit(WorldMesh& world, Unit to) {
    check(to);
    if (world.unit != Unit::unknown && world.unit != to) {
        const FloatEnvironment environment;
        const Scale scale(world.unit, to);
        std::vector<TriangleMesh> shapes = world.shapes;
        for (TriangleMesh& shape : shapes) {
            shape.unit = world.unit;
            convert_unit(shape, to);
        }
        std::vector<NamedBody> bodies = world.bodies;
        for (NamedBody& body : bodies)
            for (const std::size_t i : {std::size_t{3}, std::size_t{7}, std::size_t{11}})
                body.pose.rows[i] = scale(body.pose.rows[i]);
        if (!std::all_of(bodies.begin(), bodies.end(), [](const NamedBody& body) { return is_finite(body.pose); }))
            throw Error(ErrorCode::invalid_argument, "a pose overflows in the other unit");
        world.shapes = std::move(shapes), world.bodies = std::move(bodies);
    }
    for (TriangleMesh& shape : world.shapes) shape.unit = to;
    world.unit = to;
}

}  // namespace crumple::io
