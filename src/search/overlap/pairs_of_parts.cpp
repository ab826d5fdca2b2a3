#include "search/overlap/pairs_of_parts.h"

#include <algorithm>
#include <string>

#include "crumple/error.h"

namespace crumple {
namespace {

void check_that(bool holds, std::size_t result, const char* what) {
    if (holds) return;
    const auto index = static_cast<std::int64_t>(result);
    throw Error(ErrorCode::invalid_argument, "result " + std::to_string(index) + " of combine() " + what,
                Element::option, index);
}

// Returns the pairs of two bodies. The pairs of a part are sorted by bodies.
std::span<const Pair> pairs_of(const Overlaps& part, const BodyPair& bodies) {
    const auto [begin, end] = std::equal_range(part.part_bodies.begin(), part.part_bodies.end(), bodies);
    return {part.part_pairs.data() + (begin - part.part_bodies.begin()), static_cast<std::size_t>(end - begin)};
}

}  // namespace

PairsOfParts::PairsOfParts(std::span<const Overlaps> parts, const World& world, const OverlapQuery& query,
                           MemoryMeter& meter)
    : parts_(parts), meter_(meter) {
    if (parts.empty())
        throw Error(ErrorCode::invalid_argument, "combine() needs the results of all parts of the scene",
                    Element::option);
    for (const Body& body : world.bodies)
        triangles_.push_back(world.shapes[static_cast<std::size_t>(body.shape)].triangles.rows);
    const auto bodies = static_cast<std::int32_t>(triangles_.size());
    std::vector<bool> is_given(parts.size(), false);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const OverlapPart& part = parts[i].part;
        check_that(part.count > 0, i, "is not about a part of the scene");
        check_that(part.index >= 0 && part.index < part.count, i,
                   "has an index of a part that is not below their number");
        check_that(static_cast<std::size_t>(part.count) == parts.size(), i,
                   "is about one of another number of parts: combine() needs one result of each part");
        check_that(!is_given[static_cast<std::size_t>(part.index)], i, "is about the same part as an earlier one");
        is_given[static_cast<std::size_t>(part.index)] = true;
        check_that(part.self_overlaps || !query.self_overlaps, i, "was found without self_overlaps");
        const auto& of = parts[i].part_bodies;
        check_that(of.size() == parts[i].part_pairs.size(), i, "has lists of different lengths");
        check_that(std::is_sorted(of.begin(), of.end()), i, "has pairs that are not sorted by bodies");
        for (std::size_t k = 0; k < of.size(); ++k) {
            const auto [first, second] = of[k];
            const auto [a, b] = parts[i].part_pairs[k];
            check_that(first >= 0 && first <= second && second < bodies, i, "has a mesh that the scene lacks");
            const auto has = [&](std::int32_t body, std::int32_t triangle) {
                return triangle >= 0 && triangle < triangles_[static_cast<std::size_t>(body)];
            };
            check_that(has(first, a) && has(second, b), i, "has a triangle that the scene lacks");
            check_that(first < second || a < b, i, "has a pair within a mesh that is not in ascending order");
        }
    }
}

// Sorts by the first triangle with counters, then the few pairs of each triangle.
void PairsOfParts::append(const BodyPair& bodies, Array<Pair>& to) const {
    const auto triangles = static_cast<std::size_t>(triangles_[static_cast<std::size_t>(bodies.first)]);
    Array<std::int64_t> next(&meter_);
    next.assign(triangles + 1, 0);
    std::size_t count = 0;
    for (const Overlaps& part : parts_)
        for (const Pair& pair : pairs_of(part, bodies)) {
            ++next[pair.a];
            ++count;
        }
    auto place = static_cast<std::int64_t>(to.size());
    for (std::int64_t& n : next) {
        const std::int64_t pairs = n;
        n = place;
        place += pairs;
    }
    std::int64_t begin = static_cast<std::int64_t>(to.size());
    to.grow_by(count);
    to.resize(to.size() + count);
    for (const Overlaps& part : parts_)
        for (const Pair& pair : pairs_of(part, bodies)) to[next[pair.a]++] = pair;
    for (std::size_t t = 0; t < triangles; ++t) {  // next[t] is now the end of the pairs of triangle t
        const auto some = std::span(to.data(), to.size())
                              .subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(next[t] - begin));
        std::sort(some.begin(), some.end());
        if (std::adjacent_find(some.begin(), some.end()) != some.end())
            throw Error(ErrorCode::invalid_argument,
                        "several results of combine() have the same pair: they are about parts of different scenes",
                        Element::triangle, static_cast<std::int64_t>(t));
        begin = next[t];
    }
}

}  // namespace crumple
