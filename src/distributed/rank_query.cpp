#include "distributed/rank_query.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "queries/checks.h"

namespace crumple::distribute {
namespace {

// Kind of a query: the first of the numbers that ranks compare.
enum class Kind : std::uint8_t { intersections, motion, nearness, of_bodies, overlaps, overlap_of_mesh };

// Appends all bits of x as two numbers that can be negated.
void append(double x, std::vector<std::int64_t>& values) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    values.push_back(static_cast<std::int64_t>(bits >> 32));
    values.push_back(static_cast<std::int64_t>(bits & 0xffffffffu));
}

/// Hash of a list of numbers.
struct ListHash {
    std::uint64_t word = 0x9e3779b97f4a7c15ull;

    void add(std::uint64_t number) { word = (word ^ number) * 0xff51afd7ed558ccdull, word ^= word >> 32; }
    /// Returns the hash as a number that can be negated.
    std::int64_t value() const { return static_cast<std::int64_t>(word >> 1); }
};

// Returns a hash of the list.
template <class Pairs>
std::int64_t word_of(const Pairs& pairs) {
    ListHash hash;
    for (const auto& pair : pairs)
        for (const std::int32_t group : {std::min(pair.first, pair.second), std::max(pair.first, pair.second)})
            hash.add(static_cast<std::uint32_t>(group));
    return hash.value();
}
std::int64_t word_of(const std::vector<std::array<double, 3>>& directions) {
    ListHash hash;
    for (const auto& direction : directions)
        for (const double x : direction) hash.add(std::bit_cast<std::uint64_t>(x));
    return hash.value();
}

void append(const PairFilter& rules, bool world, ComparedQuery& compared) {
    check(world || rules.excluded_bodies.empty(), "excluded_bodies must be empty: a local mesh has no bodies");
    compared.values.insert(
        compared.values.end(),
        {static_cast<std::int64_t>(rules.bodies), static_cast<std::int64_t>(rules.groups),
         static_cast<std::int64_t>(rules.excluded_groups.size()), word_of(rules.excluded_groups),
         static_cast<std::int64_t>(rules.excluded_bodies.size()), word_of(rules.excluded_bodies), world});
    compared.between_groups = !world && rules.groups == PairScope::between;
}

constexpr const char* no_containment = "containment must be false: ranks do not support it";

}  // namespace

ComparedQuery request_of_ranks(const IntersectionQuery& query, RankOutput output) {
    check(output != RankOutput::body_pairs, "output must not be body_pairs: a local mesh has no bodies");
    check(!query.containment, no_containment);
    ComparedQuery compared;
    compared.values = {static_cast<std::int64_t>(Kind::intersections),
                       static_cast<std::int64_t>(output),
                       static_cast<std::int64_t>(query.neighbours),
                       static_cast<std::int64_t>(query.kind),
                       query.weld,
                       query.contacts(),
                       static_cast<std::int64_t>(query.filter.groups),
                       static_cast<std::int64_t>(query.filter.excluded_groups.size()),
                       word_of(query.filter.excluded_groups)};
    compared.between_groups = query.filter.groups == PairScope::between;
    return compared;
}

RankOutput output_of(const IntersectionQuery& query) {
    switch (query.output) {
        case Output::any:
        case Output::any_by_world:  // all ranks share one world
            return RankOutput::any;
        case Output::body_pairs:
            return RankOutput::body_pairs;
        case Output::count:
            return RankOutput::count;
        case Output::first:
        case Output::nearest:
        case Output::pairs:
        case Output::contacts:
            break;
    }
    return RankOutput::pairs;
}

ComparedQuery request_of_ranks(const IntersectionQuery& query) {
    check(!query.index, "index must be false: ranks do not support offsets by body");
    check(!query.containment, no_containment);
    ComparedQuery compared;
    compared.values = {static_cast<std::int64_t>(Kind::of_bodies), static_cast<std::int64_t>(query.output),
                       static_cast<std::int64_t>(query.neighbours), static_cast<std::int64_t>(query.kind), query.weld};
    append(query.filter, true, compared);
    return compared;
}

ComparedQuery request_of_ranks(const ImpactQuery& query, bool world) {
    check_query_options(query, false);
    check(!query.triangle_pairs, "triangle_pairs must be false: ranks do not support them");
    check(!query.index, "index must be false: ranks do not support offsets by feature");
    ComparedQuery compared;
    compared.values = {static_cast<std::int64_t>(Kind::motion), static_cast<std::int64_t>(query.output), query.weld,
                       query.approaching_only};
    append(query.min_distance, compared.values);
    append(query.min_distance_share, compared.values);
    compared.features = {true, query.min_distance, query.min_distance_share, query.weld};
    append(query.filter, world, compared);
    return compared;
}

ComparedQuery request_of_ranks(const ProximityQuery& query, bool world) {
    check_query_options(query, false);
    check(query.radii.empty(), "radii must be empty: ranks support only a single radius");
    check(!query.rest.data && query.rest.rows == 0, "rest must be empty: ranks do not support rest shapes");
    check(query.rings == 0, "rings must be 0: ranks do not support rings");
    check(!query.least, "least must be false: ranks do not support least distances");
    check(!query.index, "index must be false: ranks do not support offsets by feature");
    ComparedQuery compared;
    compared.values = {static_cast<std::int64_t>(Kind::nearness), static_cast<std::int64_t>(query.output), query.strict,
                       query.closest, query.weld};
    append(query.radius, compared.values);
    compared.features = {false, query.radius, 0, query.weld};
    append(query.filter, world, compared);
    return compared;
}

ComparedQuery request_of_ranks(const OverlapQuery& query, const World& world) {
    check_query_options(query, world);
    std::int64_t flags = 0;
    for (const bool flag :
         {query.weld, query.self_overlaps, query.gradient, query.curves, query.windings, query.extents, query.depths,
          query.translation, query.solids, query.unions, query.regions, query.first_free})
        flags = 2 * flags + (flag ? 1 : 0);
    ComparedQuery compared;
    compared.values = {static_cast<std::int64_t>(Kind::overlaps),
                       static_cast<std::int64_t>(query.output),
                       static_cast<std::int64_t>(query.open),
                       flags,
                       static_cast<std::int64_t>(query.directions.size()),
                       word_of(query.directions)};
    append(query.min_volume, compared.values);
    append(query.depth_tolerance, compared.values);
    append(query.filter, true, compared);
    return compared;
}

ComparedQuery request_of_ranks(const OverlapQuery& query, const MeshView& mesh) {
    const Shape shapes[] = {Shape(mesh)};
    const Body bodies[] = {Body{}};
    ComparedQuery compared = request_of_ranks(query, World{shapes, bodies, {}});
    compared.values[0] = static_cast<std::int64_t>(Kind::overlap_of_mesh);
    return compared;
}

}  // namespace crumple::distribute
