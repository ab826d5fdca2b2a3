#include "queries/proximity_input.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "crumple/error.h"
#include "scene/outline.h"

namespace crumple {
namespace {

/// Error prefix: "shape 2: " for worlds, empty for a single mesh.
std::string name_of(std::size_t shape, bool bodies) { return bodies ? "shape " + std::to_string(shape) + ": " : ""; }

void check_count(const std::string& which, const char* what, std::int64_t given, std::int64_t vertices) {
    if (given != vertices)
        throw Error(ErrorCode::invalid_argument, which + "there are " + std::to_string(given) + what + " for " +
                                                     std::to_string(vertices) + " vertices");
}

}  // namespace

void check_radii(const std::string& which, std::span<const double> radii) {
    const auto wrong =
        std::find_if_not(radii.begin(), radii.end(), [](double r) { return r >= 0 && std::isfinite(r); });
    if (wrong == radii.end()) return;
    fail_radius(which, wrong - radii.begin());
}

namespace {

VertexReader static_reader(const Shape& shape) {
    return {static_cast<const std::byte*>(shape.rest.data), shape.rest.row_stride, shape.rest.column_stride,
            shape.rest.type == ScalarType::float32};
}

bool has_rest(const Shape& shape) { return shape.rest.data || shape.rest.rows > 0; }

void check_rest(const std::string& which, const Shape& shape) {
    check_count(which, " vertices in the rest shape", shape.rest.rows, shape.vertices.rows);
    if (const char* fault = fault_of(shape.rest))
        throw Error(ErrorCode::invalid_argument, which + "the vertices of the rest shape" + fault);
}

}  // namespace

void ProximityInput::release() {
    given_radii_.release();
    points_.release();
    body_.release();
    rings_.release();
}

void ProximityInput::begin(const WorldOutline& outline, const ProximityQuery& query, bool bodies, bool here,
                           ParallelFor& workers, SceneBuffers& buffers) {
    any_radii_ = any_rest_ = false;
    ring_count_ = query.rings;
    rest_.radius = query.rest_radius;
    bool any_vertices = false;
    const auto& shapes = outline.world().shapes;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        const Shape& shape = shapes[s];
        if (!shape.radii.empty()) {
            check_count(name_of(s, bodies), " radii", static_cast<std::int64_t>(shape.radii.size()),
                        shape.vertices.rows);
            if (here) check_radii(name_of(s, bodies), shape.radii);
        }
        if (has_rest(shape)) check_rest(name_of(s, bodies), shape);
        if (has_rest(shape) && here) check_finite(shape.rest, name_of(s, bodies) + "rest shape: ", workers, buffers);
        any_radii_ = any_radii_ || !shape.radii.empty();
        any_rest_ = any_rest_ || has_rest(shape);
        any_vertices = any_vertices || shape.vertices.rows > 0;
    }
    if (any_radii_ && query.radius > 0)
        throw Error(ErrorCode::invalid_argument, "radius must be 0 if radii are given", Element::option);
    if (any_vertices && !any_rest_ && query.rest_radius > 0)
        throw Error(ErrorCode::invalid_argument, "rest_radius needs a rest shape", Element::option);
}

void ProximityInput::place(const Shape& only) {
    radii_ = only.radii;
    rest_.position = static_reader(only);
    rest_.body = nullptr;
}

void ProximityInput::place(const WorldOutline& outline, const WorldScene& scene) {
    const auto vertices = [&](std::size_t i) { return outline.shape(scene.added_body(i)).vertices.rows; };
    const std::size_t last = scene.added() - 1;
    const auto all = static_cast<std::size_t>(scene.first_vertex(last) + vertices(last));
    if (any_radii_) given_radii_.assign(all, 0);
    if (any_rest_) {
        points_.resize_discard(3 * all);
        body_.assign(all, -1);
    }
    for (std::size_t i = 0; i < scene.added(); ++i) {
        const Shape& shape = outline.shape(scene.added_body(i));
        const std::int64_t first = scene.first_vertex(i);
        if (any_radii_) std::copy(shape.radii.begin(), shape.radii.end(), given_radii_.begin() + first);
        if (!shape.rest.data) continue;
        const VertexReader position = static_reader(shape);
        for (std::int64_t v = 0; v < shape.rest.rows; ++v) {
            const Vec3d p = position(v);
            for (int axis = 0; axis < 3; ++axis) points_[3 * (first + v) + axis] = p[axis];
            body_[first + v] = static_cast<std::int32_t>(i);
        }
    }
    radii_ = any_radii_ ? given_radii_.span() : std::span<double>();
    rest_.position = {reinterpret_cast<const std::byte*>(points_.data()), 3 * sizeof(double), sizeof(double), false};
    rest_.body = body_.data();
}

void ProximityInput::tell(std::int64_t vertices, ParallelFor& workers, Cancellation& cancellation,
                          FeatureRequest& query) {
    query.radii = radii_;
    if (any_rest_) query.rest = &rest_;
    if (ring_count_ == 0) return;
    rings_.prepare(query.features, vertices, ring_count_, workers, cancellation);
    query.rings = &rings_;
}

}  // namespace crumple
