#include "search/nearest_bodies.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "results/nearest_output.h"
#include "scene/world_scene.h"
#include "search/walks/nearest_walk.h"

namespace crumple {
namespace {

// Pairs of bodies per task. A pair takes some microseconds.
constexpr std::size_t body_pairs_of_task = 8;

bool within(const Bounds& box, double most) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(box.low[axis] >= -most && box.high[axis] <= most)) return false;
    return true;
}

// True if the contents of the boxes are certainly farther apart than the radius.
bool beyond(const Bounds& a, const Bounds& b, double radius) {
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double gap = max(0.0, max(a.low[axis] - b.high[axis], b.low[axis] - a.high[axis]));
        squared += gap * gap;
    }
    return squared * (1 - 0x1p-48) > radius * radius + 0x1p-1000;
}

// Returns an upper bound on all distances whose rounded squares are at most that of `distance`.
double with_equals(double distance) { return distance * (1 + 0x1p-50) + 0x1p-500; }

}  // namespace

NearestSearch::NearestSearch(MemoryMeter& meter, Cancellation& cancellation, ShapeTrees& named)
    : meter_(meter),
      cancellation_(cancellation),
      named_(named),
      outline_(&meter),
      rules_(&meter),
      box_(&meter),
      first_row_(&meter),
      kept_(&meter) {}

NearestSearch::~NearestSearch() = default;

void NearestSearch::release() {
    outline_ = WorldOutline(&meter_);
    rules_ = BodyFilter(&meter_);
    trees_.clear();
    of_call_.clear();
    walks_.clear();
    box_.release();
    first_row_.release();
    kept_.release();
}

void NearestSearch::find(ParallelFor& workers, const World& world, const DistanceQuery& query, bool low_memory,
                         Distances& answer) {
    named_.begin();
    radius_ = query.radius;
    outline_.read(world, query.filter);
    rules_.prepare(query.filter);
    clear(answer);
    answer.statistics.triangles = outline_.triangles();
    answer.statistics.backend = "cpu";
    answer.statistics.simd = "scalar";
    read_shapes();
    read_bodies();
    list_pairs(query, answer);
    make_rows(answer);
    const std::size_t rows = answer.bodies.size();
    kept_.assign(rows, 0);
    const bool nearest = query.output == Output::nearest;
    std::atomic<std::int64_t> tests{0}, exact{0}, rational{0};
    const auto make = [&] { return std::make_unique<NearestWalk>(outline_, rules_, cancellation_, &meter_); };
    const auto run = [&](std::size_t task) {
        walks_.with(make, [&](NearestWalk& walk) {
            walk.clear_counts();
            if (nearest) {
                keep_nearest(walk, first_row_[task], first_row_[task + 1], answer);
            } else {
                const std::size_t end = std::min(rows, (task + 1) * body_pairs_of_task);
                for (std::size_t i = task * body_pairs_of_task; i < end; ++i)
                    kept_[i] = walk_row(walk, i, radius_, answer);
            }
            tests += walk.counts().tests, exact += walk.counts().exact, rational += walk.counts().rational;
        });
    };
    const std::size_t tasks =
        nearest ? static_cast<std::size_t>(outline_.worlds()) : (rows + body_pairs_of_task - 1) / body_pairs_of_task;
    if (low_memory || tasks <= 1)
        for (std::size_t task = 0; task < tasks; ++task) run(task);
    else
        workers.parallel_for(tasks, run);
    if (nearest) number_rows(answer);
    keep_rows(answer, kept_);
    answer.statistics.box_overlaps = tests;
    answer.statistics.exact_tests = exact;
    answer.statistics.rational_tests = rational;
    of_call_.clear();
}

// Fills a row. Returns true if its bodies are at most `radius` apart.
bool NearestSearch::walk_row(NearestWalk& walk, std::size_t row, double radius, Distances& answer) {
    cancellation_.check();
    const auto [a, b] = answer.bodies[row];
    NearestRow nearest;
    const bool is_near = walk(a, tree(a), b, tree(b), radius, nearest);
    put_row(answer, row, nearest);
    return is_near;
}

// Sets `kept_` for the nearest of rows [begin, end), the first if several have the same rounded squared distance; for
// none if no row is within the radius. Bounds all distances from above, then runs the walks in the order of these
// bounds, so that most later walks end early.
void NearestSearch::keep_nearest(NearestWalk& walk, std::size_t begin, std::size_t end, Distances& answer) {
    struct BoundedRow {
        double bound;
        std::size_t row;
        auto operator<=>(const BoundedRow&) const = default;
    };
    Array<BoundedRow> near(&meter_);
    double most = radius_;
    const auto certainly_farther = [&](std::size_t row) {
        const auto [a, b] = answer.bodies[row];
        return beyond(box_[a], box_[b], most);
    };
    for (std::size_t row = begin; row < end; ++row) {
        cancellation_.check();
        if (certainly_farther(row)) continue;
        const auto [a, b] = answer.bodies[row];
        const std::optional<double> bound = walk.upper_bound(a, tree(a), b, tree(b), most);
        if (!bound) continue;
        near.push_back({*bound, row});
        most = std::min(most, with_equals(*bound));
    }
    std::sort(near.begin(), near.end());
    std::optional<std::size_t> nearest;
    for (const BoundedRow& next : near) {
        const std::size_t row = next.row;
        if (certainly_farther(row) || !walk_row(walk, row, most, answer)) continue;
        const double squared = answer.squared_distance[row];
        most = std::min(most, with_equals(std::sqrt(squared)));
        const auto comes_before = [&](std::size_t other) {
            return std::pair(squared, row) < std::pair(answer.squared_distance[other], other);
        };
        if (!nearest || comes_before(*nearest)) nearest = row;
    }
    if (nearest) kept_[*nearest] = 1;
}

// Sets `world_rows`: for each world the index of its only row in the result, or -1 if it has none.
void NearestSearch::number_rows(Distances& answer) const {
    std::int64_t rows = 0;
    for (std::int32_t w = 0; w < outline_.worlds(); ++w) {
        const auto begin = kept_.begin() + first_row_[w], end = kept_.begin() + first_row_[w + 1];
        answer.world_rows.push_back(std::find(begin, end, 1) != end ? rows++ : -1);
    }
}

const ShapeTree& NearestSearch::tree(std::int32_t body) const {
    return *trees_[static_cast<std::size_t>(outline_.body(body).shape)];
}

void NearestSearch::read_shapes() {
    const World& world = outline_.world();
    trees_.assign(world.shapes.size(), nullptr);
    of_call_.clear();
    for (const Body& body : world.bodies) {
        const auto s = static_cast<std::size_t>(body.shape);
        if (trees_[s]) continue;
        cancellation_.check();
        if (world.shapes[s].name != 0) {
            trees_[s] = &named_.named(world.shapes[s], s);
            continue;
        }
        of_call_.push_back(std::make_unique<ShapeTree>(&meter_));
        named_.build(*of_call_.back(), world.shapes[s], s);
        trees_[s] = of_call_.back().get();
    }
}

// Computes the boxes of the bodies, and throws Error if a vertex is posed to infinity. Checks vertices one by one only
// if a body has no triangles, or if its box extends beyond the range of its coordinate type.
void NearestSearch::read_bodies() {
    box_.resize_discard(static_cast<std::size_t>(outline_.bodies()));
    for (std::int32_t b = 0; b < outline_.bodies(); ++b) {
        const Shape& shape = outline_.shape(b);
        const ShapeTree& tree = *trees_[static_cast<std::size_t>(outline_.body(b).shape)];
        const double most =
            shape.vertices.type == ScalarType::float32 ? std::numeric_limits<float>::max() : largest_number;
        box_[b] = tree.empty() ? no_bounds : outline_.placement(b)(tree.box());
        if (tree.empty() || !within(box_[b], most)) check_vertices(b);
    }
}

void NearestSearch::check_vertices(std::int32_t b) const {
    const Shape& shape = outline_.shape(b);
    const VertexReader position = reader_of(shape);
    const Placement place = outline_.placement(b);
    for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
        const Vec3d p = place(position(v));
        if (!within({p, p}, largest_number)) fail_body_not_finite(outline_, b);
    }
}

// Bodies are in the order of their worlds, so ascending pairs are in the order of the result.
void NearestSearch::list_pairs(const DistanceQuery& query, Distances& answer) {
    const std::int32_t worlds = outline_.worlds(), shared = outline_.first_body(worlds);
    first_row_.clear();
    for (std::int32_t w = 0; w < worlds; ++w) {
        first_row_.push_back(answer.bodies.size());
        const std::int32_t end = outline_.first_body(w + 1);
        for (std::int32_t a = outline_.first_body(w); a < end; ++a) {
            cancellation_.check();
            add_pairs(a, a + 1, end, answer);
            add_pairs(a, shared, outline_.bodies(), answer);
        }
    }
    first_row_.push_back(answer.bodies.size());
    if (query.output == Output::nearest) return;
    for (std::int32_t a = shared; a < outline_.bodies(); ++a) {
        cancellation_.check();
        add_pairs(a, a + 1, outline_.bodies(), answer);
    }
}

void NearestSearch::add_pairs(std::int32_t a, std::int32_t begin, std::int32_t end, Distances& answer) {
    const auto lacks_triangles = [&](std::int32_t b) { return outline_.shape(b).triangles.rows == 0; };
    if (lacks_triangles(a)) return;
    for (std::int32_t b = begin; b < end; ++b) {
        if (lacks_triangles(b) || !rules_.between(a, b) || beyond(box_[a], box_[b], radius_)) continue;
        const bool grouped = !outline_.shape(a).groups.empty() || !outline_.shape(b).groups.empty();
        if (grouped || rules_.groups(outline_.body(a).group, outline_.body(b).group)) answer.bodies.push_back({a, b});
    }
}

}  // namespace crumple
