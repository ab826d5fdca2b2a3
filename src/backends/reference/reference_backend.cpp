// Brute force, the reference for every other backend: decides all pairs that the pair filter keeps and whose boxes
// overlap, in rational arithmetic. Shares no floating-point filter, no predicate and no subdivision with the other
// backends. Shares with them the backend interface, the pair filter, the ownership of public parts, and the assembly of
// results with their contacts. One thread, O(m²) box tests for m triangles, about 20 us for each pair whose boxes
// overlap.

#include <algorithm>

#include "backends/backend.h"
#include "backends/pair_budget.h"
#include "backends/reference/reference_features.h"
#include "base/stopwatch.h"
#include "exact/intersection/exact_intersection.h"
#include "partition/levels.h"
#include "results/intersection_output.h"
#include "scene/scene_filter.h"

namespace crumple {
namespace {

struct TriangleBox {
    Vec3d low, high;

    explicit TriangleBox(const std::array<Vec3d, 3>& p)
        : low(min(p[0], min(p[1], p[2]))), high(max(p[0], max(p[1], p[2]))) {}
};

bool overlap(const TriangleBox& a, const TriangleBox& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
           a.low.z <= b.high.z && b.low.z <= a.high.z;
}

class Reference final : public BackendBase {
   public:
    Reference(MemoryMeter& meter, Cancellation& cancellation)
        : meter_(meter), cancellation_(cancellation), rule_(&meter), boxes_(&meter) {}

    void find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
              Intersections& result) override {
        Statistics& statistics = result.statistics;
        statistics.backend = "reference";
        statistics.simd = "scalar";
        prepare(scene, query, statistics);

        Stopwatch narrow;
        // Under a limit the pairs are counted first, so that they are stored without spare capacity.
        if (meter_.limit > 0) {
            crumple::release(result);
            PairBudget budget(scene, query, meter_);
            result.pairs.resize_discard(static_cast<std::size_t>(count(scene, query, part, &budget)));
        }
        statistics.box_overlaps = 0;
        result.pairs.clear();
        for_each_collision(scene, query, part, statistics.box_overlaps, [&](Pair pair, const RationalIntersection&) {
            result.pairs.push_back(pair);
            return true;
        });
        statistics.edge_tests = statistics.double_tests = statistics.exact_tests = statistics.rational_tests =
            statistics.box_overlaps;
        statistics[Stage::narrow] = narrow.lap();

        Stopwatch output;
        index_pairs(scene, result);
        add_contacts(scene, query, result, statistics);
        statistics[Stage::output] = output.lap();
    }

    void stream(const PreparedScene& scene, const IntersectionQuery& query, PairStream& to,
                Statistics& statistics) override {
        begin(statistics);
        prepare(scene, query, statistics);
        Array<Pair> pairs(&meter_);
        for_each_collision(scene, query, nullptr, statistics.box_overlaps, [&](Pair pair, const RationalIntersection&) {
            pairs.push_back(pair);
            if (pairs.size() == some_rows) to.add(0, pairs);
            return true;
        });
        to.add(0, pairs);
        to.finish(0);
    }

    bool any(const PreparedScene& scene, const IntersectionQuery& query) override {
        Statistics unused;
        prepare(scene, query, unused);
        bool found = false;
        for_each_collision(scene, query, nullptr, unused.box_overlaps, [&](Pair, const RationalIntersection&) {
            found = true;
            return false;
        });
        return found;
    }

    bool by_brute_force() const override { return true; }

    void find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) override {
        result.clear();
        begin(result.statistics);
        Stopwatch watch;
        find_features_by_brute_force(scene, request, cancellation_, result);
        result.statistics[Stage::narrow] = watch.lap();
    }

    void stream(const PreparedScene& scene, const FeatureRequest& request, FeatureStream& to,
                Statistics& statistics) override {
        FeatureResult result(nullptr);
        begin(result.statistics);
        find_features_by_brute_force(scene, request, cancellation_, result, &to);
        to.add(0, result.rows);
        to.finish(0);
        statistics = result.statistics;
    }

    void release() override {
        rule_ = SceneFilter(&meter_);
        boxes_ = Array<TriangleBox>(&meter_);
    }

   private:
    static constexpr std::size_t some_rows = 2048;

    static void begin(Statistics& statistics) {
        statistics = {};
        statistics.backend = "reference";
        statistics.simd = "scalar";
    }

    void prepare(const PreparedScene& scene, const IntersectionQuery& query, Statistics& statistics) {
        rule_.prepare(query.filter, scene.bodies);
        const std::int64_t triangles = scene.triangle_count();

        Stopwatch bounds;
        boxes_.clear();
        boxes_.reserve(static_cast<std::size_t>(triangles));
        for (std::int64_t t = 0; t < triangles; ++t) boxes_.push_back(TriangleBox(scene.triangle(t).point));
        statistics[Stage::bounds] = bounds.lap();
    }

    /// Calls visit(pair, intersection) for each collision, in lexicographic order, until it returns false.
    template <class Visit>
    void for_each_collision(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
                            std::int64_t& box_overlaps, Visit visit) {
        const std::int64_t first_end = scene.between ? scene.triangles[0] : scene.triangle_count();
        const std::int64_t offset = scene.between ? first_end : 0;
        const Levels levels(part);
        for (std::int64_t a = 0; a < first_end; ++a) {
            cancellation_.check();
            const TriangleBox& box_a = box(a);
            for (std::int64_t b = scene.between ? offset : a + 1; b < scene.triangle_count(); ++b) {
                if (!overlap(box_a, box(b))) continue;
                if (!rule_(scene.group(a), scene.group(b))) continue;
                if (!levels.own(a, b)) continue;
                cancellation_.check();
                ++box_overlaps;
                const RationalIntersection intersection = intersect_rationally(scene.triangle(a), scene.triangle(b));
                if (!collide(intersection, query.neighbours, query.kind)) continue;
                const Pair pair{static_cast<std::int32_t>(a), static_cast<std::int32_t>(b - offset)};
                if (!visit(pair, intersection)) return;
            }
        }
    }

    void add_contacts(const PreparedScene& scene, const IntersectionQuery& query, Intersections& result,
                      Statistics& statistics) {
        result.contacts.kinds.clear();
        result.contacts.offsets.clear();
        result.contacts.points.clear();
        if (!query.contacts()) return;
        statistics.rational_contacts += contacts_of_pairs(scene, result, [&](std::size_t n, auto task) {
            for (std::size_t i = 0; i < n; ++i) {
                cancellation_.check();
                task(i);
            }
        });
    }

    std::int64_t count(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
                       PairBudget* budget) {
        std::int64_t overlaps = 0, pairs = 0;
        for_each_collision(scene, query, part, overlaps, [&](Pair, const RationalIntersection&) {
            ++pairs;
            if (budget) budget->add(1);
            return true;
        });
        return pairs;
    }

    const TriangleBox& box(std::int64_t t) const { return boxes_[static_cast<std::size_t>(t)]; }

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    SceneFilter rule_;
    Array<TriangleBox> boxes_;
};

}  // namespace

std::unique_ptr<BackendBase> make_reference_backend(const Options&, MemoryMeter& meter, Cancellation& cancellation) {
    return std::make_unique<Reference>(meter, cancellation);
}

}  // namespace crumple
