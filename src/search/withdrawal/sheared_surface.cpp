#include "search/withdrawal/sheared_surface.h"

#include <algorithm>
#include <utility>

#include "exact/intersection/exact_intersection.h"
#include "exact/withdrawal/exact_withdrawal.h"

namespace crumple {
namespace {

/// Bytes of a node of a hash table besides its element: two pointers, and the bucket.
constexpr std::size_t bytes_of_node = 24;

}  // namespace

RoundedBounds::RoundedBounds(const Rational& x) : low(-rounded_up(-x)), high(rounded_up(x)) {}

const ShearedFace& ShearedSurface::face(std::int32_t face) {
    const auto found = faces_.find(face);
    if (found != faces_.end()) return found->second;
    ShearedFace sheared(surface_.corners(face), shear_, face);
    memory_.add(bytes_of_node + sheared.bytes());
    return faces_.emplace(face, std::move(sheared)).first->second;
}

/// Visits the triangles whose boxes, and those of all nodes above, pass a test.
template <class Test, class Visit>
void ShearedSurface::walk(Test test, Visit visit) {
    std::vector<std::int32_t> stack{ProjectedTree::root};
    while (!stack.empty()) {
        const std::int32_t index = stack.back();
        stack.pop_back();
        const ProjectedTree::Node node = tree_.node(index);
        if (!test(node.box)) continue;
        if (!node.is_leaf()) {
            const std::int32_t child = tree_.first_child(index);
            stack.push_back(child);
            stack.push_back(child + 1);
            continue;
        }
        for (std::int32_t i = node.begin; i < node.end; ++i)
            if (test(tree_.triangle(i).box)) visit(tree_.triangle(i).face);
    }
}

std::vector<const ShearedFace*> ShearedSurface::faces_at(const ShearedPlace& place) {
    const ShearedPlace scaled = Rational(projection_.scale()) * shear_.coordinates_of(place);
    const RoundedBounds u(scaled.u), v(scaled.v);
    std::vector<const ShearedFace*> faces;
    walk(
        [&](const Bounds& box) {
            return box.low.x <= u.high && box.high.x >= u.low && box.low.y <= v.high && box.high.y >= v.low;
        },
        [&](std::int32_t index) {
            const ShearedFace& f = face(index);
            if (!f.is_upright() && f.position(place) >= 0) faces.push_back(&f);
        });
    return faces;
}

std::vector<std::int32_t> ShearedSurface::neighbours(std::int32_t face) {
    const Bounds own = projection_(surface_.corners(face));
    std::vector<std::int32_t> faces;
    walk([&](const Bounds& box) { return overlap(box, own); },
         [&](std::int32_t other) {
             if (other != face) faces.push_back(other);
         });
    return faces;
}

bool ShearedSurface::is_clean(std::int32_t face) {
    const auto found = clean_.find(face);
    if (found != clean_.end()) return found->second;
    const auto triangle = [&](std::int32_t f) {
        const std::int32_t* c = surface_.surface->corners(f);
        return Triangle{surface_.corners(f), {c[0], c[1], c[2]}};
    };
    memory_of_clean_.add(bytes_of_node + sizeof(std::pair<const std::int32_t, bool>));
    const std::vector<std::int32_t> others = neighbours(face);
    return clean_[face] = std::none_of(others.begin(), others.end(), [&](std::int32_t other) {
               return intersect_rationally(triangle(face), triangle(other)).collides;
           });
}

}  // namespace crumple
