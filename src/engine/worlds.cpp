#include "engine/worlds.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "crumple/error.h"
#include "engine/first_hit.h"
#include "engine/output.h"

namespace crumple {
namespace {

// Worlds that are decided in one task: some microseconds each.
constexpr std::int32_t worlds_a_task = 16;

bool is_flag(Wants wants) { return wants <= Wants::body_pairs; }

bool finite(const Bounds& box, double most) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(box.low[axis] >= -most && box.high[axis] <= most)) return false;
    return true;
}

}  // namespace

WorldSearch::WorldSearch(MemoryMeter& meter, Cancellation& cancellation, ShapeTrees& named)
    : meter_(meter),
      cancellation_(cancellation),
      named_(named),
      outline_(&meter),
      rules_(&meter),
      box_(&meter),
      rest_(&meter),
      marks_(&meter),
      groups_(&meter),
      whole_(&meter),
      scene_(&meter),
      found_(metered(&meter)) {}

void WorldSearch::release() {
    trees_.clear();
    of_call_.clear();
    outline_ = WorldOutline(&meter_);
    rules_ = BodyRules(&meter_);
    box_.release();
    rest_.release();
    marks_.release();
    groups_.release();
    whole_.release();
    scene_ = WorldScene(&meter_);
    found_ = metered(&meter_);
}

void WorldSearch::find(BackendBase& backend, const World& world, const Intersect& question, WorldCollisions& result,
                       const WorldBlocks* blocks) {
    named_.begin();
    question_ = question;
    blocks_ = blocks;
    outline_.read(world, question.rules);
    rules_.prepare(question.rules);
    clear(result, outline_, question);
    read_shapes();
    read_bodies();
    if (is_flag(question.wants) && boxes_) search_directly(backend, result);
    for (std::int32_t pass = 0; pass < passes(); ++pass) {
        cancellation_.check();
        if (question.wants == Wants::any && result.any) break;
        if (question.wants == Wants::any_by_world && known(pass, result)) continue;
        search_scene(backend, pass, result);
    }
    if (blocks)
        blocks->pass_on(result, true);
    else
        finish(outline_, question, result);
    of_call_.clear();
}

// Trees: of named shapes, and of those that are in all of several worlds.
void WorldSearch::read_shapes() {
    const World& world = outline_.world();
    float32_ = std::all_of(world.shapes.begin(), world.shapes.end(),
                           [](const Shape& s) { return s.vertices.type == ScalarType::float32; });
    trees_.assign(world.shapes.size(), nullptr);
    of_call_.clear();
    for (std::size_t s = 0; s < world.shapes.size(); ++s)
        if (world.shapes[s].name != 0) trees_[s] = &named_.named(world.shapes[s], s);
    if (outline_.worlds() < 2) return;
    for (std::int32_t b = outline_.first_body(outline_.worlds()); b < outline_.bodies(); ++b) {
        const auto s = static_cast<std::size_t>(outline_.body(b).shape);
        if (trees_[s]) continue;
        of_call_.push_back(std::make_unique<ShapeTree>(&meter_));
        named_.build(*of_call_.back(), world.shapes[s], s);
        trees_[s] = of_call_.back().get();
    }
}

// Boxes, where bodies can be left out by them: not where all must be searched anyway.
void WorldSearch::read_bodies() {
    boxes_ = outline_.worlds() > 1 || std::any_of(trees_.begin(), trees_.end(), [](auto* tree) { return tree; });
    if (!boxes_) return;
    box_.resize_discard(static_cast<std::size_t>(outline_.bodies()));
    for (std::int32_t b = 0; b < outline_.bodies(); ++b) box_[b] = read_box(b);

    const std::int32_t first = outline_.first_body(outline_.worlds());
    rest_.resize_discard(static_cast<std::size_t>(outline_.bodies() - first));
    for (std::int32_t b = first; b < outline_.bodies(); ++b) rest_[b - first] = {b, box_[b].low.x, 0};
    std::sort(rest_.begin(), rest_.end(), [](const Rest& a, const Rest& b) { return a.low < b.low; });
    double reach = -largest_number;
    for (Rest& r : rest_) r.reach = reach = std::max(reach, box_[r.body].high.x);
}

// Holds all posed vertices of body b, which are finite, or Error is thrown. A body without triangles meets nothing.
Bounds WorldSearch::read_box(std::int32_t b) const {
    const Shape& shape = outline_.shape(b);
    const Placement place = outline_.placement(b);
    const double most = shape.vertices.type == ScalarType::float32 ? std::numeric_limits<float>::max() : largest_number;
    if (const ShapeTree* known = tree(b)) {
        if (known->empty()) return no_bounds;
        Bounds box = place(known->box());
        if (finite(box, most)) return box;
    }
    cancellation_.check();
    const VertexReader position = reader_of(shape);
    Bounds box = no_bounds;
    for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
        const Vec3d p = place(position(v));
        if (!finite({p, p}, largest_number)) fail_body_not_finite(outline_, b);
        box.widen(p);
    }
    return shape.triangles.rows > 0 ? box : no_bounds;
}

std::int32_t WorldSearch::end_of(std::int32_t pass) const {
    return pass < outline_.worlds() ? outline_.first_body(pass + 1) : outline_.bodies();
}

// By boxes and rules; of triangles nothing is known yet.
bool WorldSearch::may_meet(std::int32_t a, std::int32_t b) const {
    if (!overlap(box_[a], box_[b]) || !rules_.between(a, b)) return false;
    const bool grouped = !outline_.shape(a).groups.empty() || !outline_.shape(b).groups.empty();
    return grouped || rules_.groups(outline_.body(a).group, outline_.body(b).group);
}

// Pairs a < b that may meet, in no order. Ends when visit(a, b) returns false.
template <class Visit>
void WorldSearch::for_each_body_pair(std::int32_t pass, Visit visit) const {
    const std::int32_t begin = begin_of(pass), end = end_of(pass);
    constexpr std::int32_t few = 32;
    std::vector<std::int32_t> order;
    if (end - begin > few) {
        order.resize(static_cast<std::size_t>(end - begin));
        std::iota(order.begin(), order.end(), begin);
        std::sort(order.begin(), order.end(), [&](auto a, auto b) { return box_[a].low.x < box_[b].low.x; });
    }
    for (std::int32_t i = 0; i < end - begin; ++i) {
        const std::int32_t a = order.empty() ? begin + i : order[static_cast<std::size_t>(i)];
        for (std::int32_t j = i + 1; j < end - begin; ++j) {
            const std::int32_t b = order.empty() ? begin + j : order[static_cast<std::size_t>(j)];
            if (!order.empty() && box_[b].low.x > box_[a].high.x) break;
            if (may_meet(a, b) && !visit(std::min(a, b), std::max(a, b))) return;
        }
        if (pass == outline_.worlds()) continue;
        auto r =
            std::partition_point(rest_.begin(), rest_.end(), [&](const Rest& x) { return x.reach < box_[a].low.x; });
        for (; r != rest_.end() && r->low <= box_[a].high.x; ++r)
            if (may_meet(a, r->body) && !visit(a, r->body)) return;
    }
}

// Pairs of bodies that both have trees, where only flags are wanted. Worlds are independent.
void WorldSearch::search_directly(BackendBase& backend, WorldCollisions& result) {
    const auto tasks = static_cast<std::size_t>((passes() + worlds_a_task - 1) / worlds_a_task);
    std::vector<std::vector<BodyPair>> meet(tasks);
    std::atomic<bool> any{false};
    std::atomic<std::int64_t> decided{0};
    backend.parallel_for(tasks, [&](std::size_t task) {
        const auto first = static_cast<std::int32_t>(task) * worlds_a_task;
        std::int64_t tests = 0;
        cancellation_.check();
        for (std::int32_t pass = first; pass < std::min(passes(), first + worlds_a_task); ++pass) {
            if (question_.wants == Wants::any && any.load(std::memory_order_relaxed)) break;
            for_each_body_pair(pass, [&](std::int32_t a, std::int32_t b) {
                if (!direct(a, b)) return true;
                cancellation_.check();
                if (!bodies_meet(outline_, question_, rules_, a, *tree(a), b, *tree(b), tests)) return true;
                any.store(true, std::memory_order_relaxed);
                if (pass < outline_.worlds() && !result.world_hit.empty()) result.world_hit[pass] = 1;
                if (question_.wants != Wants::body_pairs) return false;
                meet[task].push_back({a, b});
                return true;
            });
        }
        decided.fetch_add(tests, std::memory_order_relaxed);
    });
    result.any = any;
    result.statistics.box_overlaps += decided;
    for (const auto& pairs : meet)
        for (const BodyPair& pair : pairs) result.bodies.push_back(pair);
}

// What of the pass's bodies has to be searched as a scene; false: nothing.
bool WorldSearch::gather(BackendBase& backend, std::int32_t pass) {
    const std::int32_t worlds = outline_.worlds();
    scene_.begin(float32_, rules_);
    marks_.clear();
    whole_.clear();
    if (!boxes_) {
        for (std::int32_t b = begin_of(pass); b < end_of(pass); ++b) whole_.push_back(b);
        if (pass < worlds)
            for (std::int32_t b = outline_.first_body(worlds); b < outline_.bodies(); ++b) whole_.push_back(b);
    } else {
        for (std::int32_t b = begin_of(pass); b < end_of(pass); ++b)
            if (rules_.within(b, outline_.body(b).self)) whole_.push_back(b);
        for_each_body_pair(pass, [&](std::int32_t a, std::int32_t b) {
            cancellation_.check();
            if (!(is_flag(question_.wants) && direct(a, b))) mark(a, b);
            return true;
        });
        std::sort(whole_.begin(), whole_.end());
        whole_.resize(static_cast<std::size_t>(std::unique(whole_.begin(), whole_.end()) - whole_.begin()));
        std::sort(marks_.begin(), marks_.end());
        marks_.resize(static_cast<std::size_t>(std::unique(marks_.begin(), marks_.end()) - marks_.begin()));
    }
    const std::int32_t* w = whole_.begin();
    const Mark* m = marks_.begin();
    while (w != whole_.end() || m != marks_.end()) {
        const std::int32_t b = m == marks_.end() || (w != whole_.end() && *w <= m->body) ? *w : m->body;
        const bool everywhere = pass < worlds && b >= outline_.first_body(worlds);
        groups_.clear();
        for (; m != marks_.end() && m->body == b; ++m) groups_.push_back(m->group);
        if (w != whole_.end() && *w == b) {
            scene_.add(outline_, b, everywhere, backend);
            ++w;
        } else {
            scene_.add(outline_, b, everywhere, *tree(b), groups_.span());
        }
    }
    return scene_.triangles() > 1;
}

// Groups of triangles by which a and b may meet; a body without a tree is searched as a whole.
void WorldSearch::mark(std::int32_t a, std::int32_t b) {
    const ShapeTree *tree_a = tree(a), *tree_b = tree(b);
    const Placement place_a = outline_.placement(a), place_b = outline_.placement(b);
    if (tree_a && tree_b) {
        std::int32_t last_a = -1, last_b = -1;  // many pairs in a row have a group in common
        for_each_overlap(*tree_a, place_a, *tree_b, place_b, [&](std::int32_t group_a, std::int32_t group_b) {
            if (group_a != last_a) marks_.push_back({a, last_a = group_a});
            if (group_b != last_b) marks_.push_back({b, last_b = group_b});
            return true;
        });
        return;
    }
    const auto by_box = [&](std::int32_t body, const ShapeTree* known, const Placement& place, const Bounds& box) {
        if (known)
            for_each_overlap(*known, place, box, [&](std::int32_t group) { marks_.push_back({body, group}); });
        else
            whole_.push_back(body);
    };
    by_box(a, tree_a, place_a, box_[b]);
    by_box(b, tree_b, place_b, box_[a]);
}

void WorldSearch::search_scene(BackendBase& backend, std::int32_t pass, WorldCollisions& result) {
    if (!gather(backend, pass)) return;
    Query query;
    query.neighbours = question_.neighbours;
    query.intersections = question_.intersections;
    query.weld = question_.weld;
    query.contacts = question_.wants == Wants::contacts;
    const Scene scene = scene_.scene(outline_, question_.weld, backend);
    if (question_.wants <= Wants::any_by_world && backend.heeds_bodies()) {
        if (backend.any(scene, query)) hit(pass, outline_, result);
        return;
    }
    found_.statistics = {};
    if (blocks_) {
        const auto take = [&](const Collisions& block) { append(block, pass, true, result); };
        backend.stream(scene, query, blocks_->how, take, found_.statistics);
    } else {
        backend.find(scene, query, nullptr, found_);
    }
    add_pass(found_.statistics, result.statistics);
    if (!blocks_) append(found_, pass, backend.heeds_bodies(), result);
}

void WorldSearch::append(const Collisions& found, std::int32_t pass, bool only_wanted, WorldCollisions& result) {
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
        const Pair& pair = found.pairs[i];
        const std::int32_t a = scene_.body(pair.a), b = scene_.body(pair.b);
        if (!only_wanted && !rules_(scene_.group(pair.a), scene_.group(pair.b))) continue;
        const Contacts& c = found.contacts;
        add_pair(outline_, question_, pass, {a, b}, {scene_.triangle(pair.a), scene_.triangle(pair.b)}, result);
        if (question_.wants == Wants::contacts)
            add_contact(c.kinds[i], {c.points.data() + c.offsets[i], c.points.data() + c.offsets[i + 1]}, result);
        if (blocks_) blocks_->pass_on(result);
    }
}

}  // namespace crumple
