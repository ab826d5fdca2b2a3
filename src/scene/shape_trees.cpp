#include "scene/shape_trees.h"

#include <algorithm>
#include <string>
#include <utility>

#include "crumple/error.h"

namespace crumple {

const ShapeTree& ShapeTrees::named(const Shape& shape, std::size_t s, TreeElements elements) {
    const bool lists = elements == TreeElements::all && (shape.edges || shape.points);
    const auto count = [&](const auto& list) { return lists && list ? static_cast<std::int64_t>(list->size()) : 0; };
    const Size size{shape.vertices.rows, shape.triangles.rows, count(shape.edges), count(shape.points),
                    shape.vertices.type};
    const Key key{shape.name, lists};
    check_unchanged(shape.name, s, size);
    if (const auto cached = named_.find(key); cached != named_.end()) {
        Named& named = *cached->second;
        named.used = calls_;
        return named.tree;
    }
    auto named = std::make_unique<Named>(&meter_);
    named->size = size;
    named->used = calls_;
    build(named->tree, shape, s, lists ? TreeElements::all : TreeElements::triangles);
    return named_.emplace(key, std::move(named)).first->second->tree;
}

const Array<Edge>& ShapeTrees::edges(const Shape& shape) {
    Array<Edge>& edges = named_.find({shape.name, shape.edges || shape.points})->second->edges;
    if (edges.empty()) find_edges(shape, edges);
    return edges;
}

void ShapeTrees::find_edges(const Shape& shape, Array<Edge>& edges) {
    const std::int64_t n = shape.triangles.rows;
    edges.reserve(static_cast<std::size_t>(3 * n));
    with_corner_reader(shape, [&](auto corner) {
        for (std::int64_t t = 0; t < n; ++t)
            for (int k = 0; k < 3; ++k) {
                const auto a = static_cast<std::int32_t>(corner(t, k)),
                           b = static_cast<std::int32_t>(corner(t, (k + 1) % 3));
                if (a != b) edges.push_back({std::min(a, b), std::max(a, b)});
            }
    });
    std::sort(edges.begin(), edges.end());
    edges.resize(static_cast<std::size_t>(std::unique(edges.begin(), edges.end()) - edges.begin()));
}

// Throws Error if a shape with this name, with or without its lists, had another size.
void ShapeTrees::check_unchanged(std::uint64_t name, std::size_t s, const Size& size) const {
    for (const bool lists : {false, true}) {
        const auto cached = named_.find({name, lists});
        if (cached == named_.end()) continue;
        const Size& had = cached->second->size;
        const bool same_lists =
            !lists || (size.edges == 0 && size.points == 0) || (had.edges == size.edges && had.points == size.points);
        if (had.vertices == size.vertices && had.triangles == size.triangles && had.type == size.type && same_lists)
            continue;
        std::string sizes = std::to_string(had.vertices) + (had.type == ScalarType::float32 ? " float32" : " float64") +
                            " vertices and " + std::to_string(had.triangles) + " triangles";
        if (had.edges > 0) sizes += " and " + std::to_string(had.edges) + " edges";
        if (had.points > 0) sizes += " and " + std::to_string(had.points) + " points";
        throw Error(ErrorCode::invalid_argument,
                    "shape " + std::to_string(s) + ": an earlier shape with the name " + std::to_string(name) +
                        " had " + sizes + "; a changed shape needs another name",
                    Element::shape, static_cast<std::int64_t>(s));
    }
}

void ShapeTrees::build(ShapeTree& tree, const Shape& shape, std::size_t s, TreeElements elements) {
    for (;;) {
        try {
            tree.build(shape, elements);
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
