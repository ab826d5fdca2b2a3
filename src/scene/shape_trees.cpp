#include "scene/shape_trees.h"

#include <algorithm>
#include <string>
#include <utility>

#include "crumple/error.h"

namespace crumple {

const ShapeTree& ShapeTrees::named(const Shape& shape, std::size_t s) {
    if (const auto known = named_.find(shape.name); known != named_.end()) {
        Named& named = *known->second;
        if (named.vertices != shape.vertices.rows || named.triangles != shape.triangles.rows ||
            named.type != shape.vertices.type)
            throw Error(ErrorCode::invalid_argument,
                        "shape " + std::to_string(s) + ": an earlier shape with the name " +
                            std::to_string(shape.name) + " had " + std::to_string(named.vertices) +
                            (named.type == ScalarType::float32 ? " float32" : " float64") + " vertices and " +
                            std::to_string(named.triangles) + " triangles; a changed shape needs another name",
                        Element::shape, static_cast<std::int64_t>(s));
        named.used = calls_;
        return named.tree;
    }
    auto named = std::make_unique<Named>(&meter_);
    named->vertices = shape.vertices.rows;
    named->triangles = shape.triangles.rows;
    named->type = shape.vertices.type;
    named->used = calls_;
    build(named->tree, shape, s);
    return named_.emplace(shape.name, std::move(named)).first->second->tree;
}

void ShapeTrees::build(ShapeTree& tree, const Shape& shape, std::size_t s) {
    for (;;) {
        try {
            tree.build(shape);
            return;
        } catch (const MemoryMeter::Exceeded&) {
            if (!drop_oldest()) throw;
        } catch (const Error& error) {
            throw Error(error.code, "shape " + std::to_string(s) + ": " + error.what(), error.element, error.index);
        }
    }
}

bool ShapeTrees::drop_oldest() {
    const auto oldest = std::min_element(named_.begin(), named_.end(),
                                         [](const auto& a, const auto& b) { return a.second->used < b.second->used; });
    if (oldest == named_.end() || oldest->second->used == calls_) return false;
    named_.erase(oldest);
    return true;
}

}  // namespace crumple
