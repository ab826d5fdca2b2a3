#include "search/world_search.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "crumple/error.h"
#include "results/intersection_output.h"
#include "search/first_hit.h"
#include "search/pair_stream.h"

namespace crumple {
namespace {

// Worlds per task. A world takes some microseconds.
constexpr std::int32_t worlds_a_task = 16;

// Limits of worlds side by side in one scene. Worlds are joined only while they are small, and up to a total at which
// the launches of a device cost little compared to its work; more would only cost memory. A larger world fills the
// device alone, and would cause small ones beside it to be cut into clusters that they do not need.
constexpr std::int64_t most_of_a_joined_world = 1 << 16, most_of_joined_worlds = 1 << 24;
constexpr std::size_t few_worlds = 64;

bool is_flag(Output wants) { return wants <= Output::body_pairs; }

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
      near_(&meter),
      marks_(&meter),
      near_pairs_(&meter),
      groups_(&meter),
      whole_(&meter),
      scene_(&meter),
      found_(metered(&meter)),
      flags_(&meter),
      most_joined_(most_of_joined_worlds) {}

void WorldSearch::release() {
    trees_.clear();
    of_call_.clear();
    outline_ = WorldOutline(&meter_);
    rules_ = BodyFilter(&meter_);
    near_ = NearBodies(&meter_);
    marks_.release();
    near_pairs_.release();
    groups_.release();
    whole_.release();
    scene_ = WorldScene(&meter_);
    found_ = metered(&meter_);
    flags_.release();
    most_joined_ = most_of_joined_worlds;
}

void WorldSearch::find(BackendBase& backend, const World& world, const IntersectionQuery& query, Intersections& result,
                       const WorldBlocks* blocks) {
    named_.begin();
    query_ = query;
    blocks_ = blocks;
    outline_.read(world, query.filter);
    rules_.prepare(query.filter);
    clear(result, outline_, query);
    read_shapes();
    read_bodies();
    if (is_flag(query.output) && boxes_) search_directly(backend, result);
    search_scenes(backend, result);
    if (blocks)
        blocks->deliver_if_full(result, true);
    else
        finish(outline_, query, result);
    of_call_.clear();
}

// Builds or looks up the trees of named shapes and, if there are several worlds, of the shapes of bodies that are in
// all of them.
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

// Computes the boxes of bodies, unless all bodies must be searched anyway.
void WorldSearch::read_bodies() {
    boxes_ = outline_.worlds() > 1 || std::any_of(trees_.begin(), trees_.end(), [](auto* tree) { return tree; });
    for (std::int32_t b = 0; b < outline_.bodies() && !boxes_; ++b) boxes_ = !rules_.within(b, outline_.body(b).self);
    if (!boxes_) return;
    near_.prepare(outline_, [&](std::int32_t b) { return read_box(b); });
}

// Returns a box that contains all posed vertices of body b. Throws Error if one is not finite. A body without triangles
// has an empty box.
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
    bool good = true;
    if (place.identity()) {
        const ChunkCheck check = check_vertices(shape.vertices, position, 0, shape.vertices.rows);
        box = {check.low, check.high};
        good = check.good;
    } else {
        for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
            const Vec3d p = place(position(v));
            good = good && finite({p, p}, largest_number);
            box.widen(p);
        }
    }
    if (!good) fail_body_not_finite(outline_, b);
    return shape.triangles.rows > 0 ? box : no_bounds;
}

std::int32_t WorldSearch::end_of(std::int32_t pass) const {
    return pass < outline_.worlds() ? outline_.first_body(pass + 1) : outline_.bodies();
}

// True if the filter may select pairs of triangles of two different bodies. If a shape has groups, the groups are not
// compared.
bool WorldSearch::may_meet(std::int32_t a, std::int32_t b) const {
    if (!rules_.between(a, b)) return false;
    const bool grouped = !outline_.shape(a).groups.empty() || !outline_.shape(b).groups.empty();
    return grouped || rules_.groups(outline_.body(a).group, outline_.body(b).group);
}

// Decides pairs of bodies that both have trees, if no pairs of triangles are requested. Worlds are independent of each
// other; a task has `worlds_a_task` of them.
void WorldSearch::search_directly(BackendBase& backend, Intersections& result) {
    const auto tasks = static_cast<std::size_t>((passes() + worlds_a_task - 1) / worlds_a_task);
    std::vector<std::vector<BodyPair>> meet(tasks);
    std::atomic<bool> any{false};
    std::atomic<std::int64_t> decided{0};
    backend.parallel_for(tasks, [&](std::size_t task) {
        const auto first = static_cast<std::int32_t>(task) * worlds_a_task;
        std::int64_t tests = 0;
        cancellation_.check();
        for (std::int32_t pass = first; pass < std::min(passes(), first + worlds_a_task); ++pass) {
            if (query_.output == Output::any && any.load(std::memory_order_relaxed)) break;
            near_.for_each_pair(pass, [&](std::int32_t a, std::int32_t b) {
                if (!may_meet(a, b) || !both_have_trees(a, b)) return true;
                cancellation_.check();
                if (!bodies_meet(outline_, query_, rules_, a, *tree(a), b, *tree(b), tests)) return true;
                any.store(true, std::memory_order_relaxed);
                if (pass < outline_.worlds() && !result.world_hit.empty()) result.world_hit[pass] = 1;
                if (query_.output != Output::body_pairs) return false;
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

// Searches the worlds that need a scene, as many side by side as possible.
void WorldSearch::search_scenes(BackendBase& backend, Intersections& result) {
    const auto at_once = static_cast<std::size_t>(blocks_ ? 1 : backend.worlds_at_once());
    // If the first hit ends the search, starts with few worlds: this costs only a handful of additional searches, and
    // may skip most worlds.
    std::size_t most = query_.output == Output::any ? std::min(few_worlds, at_once) : at_once;
    joined_.clear();
    for (std::int32_t pass = 0; pass < passes() && !is_over(result); ++pass) {
        cancellation_.check();
        if (query_.output == Output::any_by_world && is_hit(pass, result)) continue;
        collect(pass);
        const SceneSize extent = collected();
        if (extent.triangles < 2) continue;
        if (!joined_.empty() && !joins(extent)) {
            search_joined(backend, true, result);
            if (is_over(result)) break;
            collect(pass);  // the search may have overwritten what was collected
        }
        if (joined_.empty()) scene_.begin(float32_, rules_);
        joined_.push_back(pass);
        const bool gathered = fits([&] { gather(backend, pass); });
        if (gathered && joined_.size() < most && extent.triangles <= most_of_a_joined_world) continue;
        search_joined(backend, gathered, result);
        most = std::min(8 * most, at_once);
    }
    if (!joined_.empty()) search_joined(backend, true, result);
}

// Collects what has to be searched as a scene for world `pass`: whole bodies, or groups of their triangles.
void WorldSearch::collect(std::int32_t pass) {
    const std::int32_t worlds = outline_.worlds();
    marks_.clear();
    near_pairs_.clear();
    whole_.clear();
    if (!boxes_) {
        for (std::int32_t b = begin_of(pass); b < end_of(pass); ++b) whole_.push_back(b);
        if (pass < worlds)
            for (std::int32_t b = outline_.first_body(worlds); b < outline_.bodies(); ++b) whole_.push_back(b);
        return;
    }
    for (std::int32_t b = begin_of(pass); b < end_of(pass); ++b)
        if (rules_.within(b, outline_.body(b).self)) whole_.push_back(b);
    near_.for_each_pair(pass, [&](std::int32_t a, std::int32_t b) {
        cancellation_.check();
        if (may_meet(a, b) && !(is_flag(query_.output) && both_have_trees(a, b))) mark(a, b);
        return true;
    });
    std::sort(whole_.begin(), whole_.end());
    whole_.resize(static_cast<std::size_t>(std::unique(whole_.begin(), whole_.end()) - whole_.begin()));
    std::sort(near_pairs_.begin(), near_pairs_.end());
    std::sort(marks_.begin(), marks_.end());
    marks_.resize(static_cast<std::size_t>(std::unique(marks_.begin(), marks_.end()) - marks_.begin()));
}

// Calls whole(body) or some(body, groups of its tree), in the order of bodies.
template <class Whole, class Some>
void WorldSearch::for_each_collected(Whole whole, Some some) {
    const std::int32_t* w = whole_.begin();
    const Mark* m = marks_.begin();
    while (w != whole_.end() || m != marks_.end()) {
        const std::int32_t b = m == marks_.end() || (w != whole_.end() && *w <= m->body) ? *w : m->body;
        groups_.clear();
        for (; m != marks_.end() && m->body == b; ++m) groups_.push_back(m->group);
        if (w != whole_.end() && *w == b) {
            whole(b);
            ++w;
        } else {
            some(b, groups_.span());
        }
    }
}

WorldSearch::SceneSize WorldSearch::collected() {
    SceneSize extent;
    for_each_collected(
        [&](std::int32_t b) {
            extent.triangles += outline_.shape(b).triangles.rows;
            extent.vertices += outline_.shape(b).vertices.rows;
        },
        [&](std::int32_t b, std::span<const std::int32_t> groups) {
            for (const std::int32_t g : groups) {
                extent.triangles += tree(b)->group(g).count;
                extent.vertices += tree(b)->group(g).vertices;
            }
        });
    return extent;
}

// True if the collected world may join the worlds that are already in the scene.
bool WorldSearch::joins(const SceneSize& extent) const {
    return extent.triangles <= most_of_a_joined_world && scene_.triangles() + extent.triangles <= most_joined_ &&
           scene_.vertices() + extent.vertices <= std::numeric_limits<std::int32_t>::max();
}

// Adds the collected bodies to the scene, as a world of its own.
void WorldSearch::gather(BackendBase& backend, std::int32_t pass) {
    const auto everywhere = [&](std::int32_t b) {
        return pass < outline_.worlds() && b >= outline_.first_body(outline_.worlds());
    };
    const auto near = [&](std::int32_t b) {
        near_boxes_.clear();
        const auto first = std::lower_bound(near_pairs_.begin(), near_pairs_.end(), BodyPair{b, -1});
        for (auto n = first; n != near_pairs_.end() && n->first == b; ++n) near_boxes_.push_back(near_.box(n->second));
        return std::span<const Bounds>(near_boxes_);
    };
    const auto add_whole = [&](std::int32_t b) {
        const bool complete = !boxes_ || rules_.within(b, outline_.body(b).self);
        scene_.add(outline_, b, everywhere(b), backend, complete ? std::span<const Bounds>() : near(b));
    };
    for_each_collected(add_whole, [&](std::int32_t b, std::span<const std::int32_t> groups) {
        scene_.add(outline_, b, everywhere(b), *tree(b), groups, near(b));
    });
    scene_.end_world();
}

// Marks the groups of triangles by which a and b may meet; marks a body without a tree as whole, whose triangles are
// then tested one by one.
void WorldSearch::mark(std::int32_t a, std::int32_t b) {
    const ShapeTree *tree_a = tree(a), *tree_b = tree(b);
    const Placement place_a = outline_.placement(a), place_b = outline_.placement(b);
    near_pairs_.push_back({a, b});
    near_pairs_.push_back({b, a});
    if (tree_a && tree_b) {
        std::int32_t last_a = -1, last_b = -1;  // consecutive pairs often have a common group
        for_each_overlap(*tree_a, place_a, *tree_b, place_b, [&](std::int32_t group_a, std::int32_t group_b) {
            if (group_a != last_a) marks_.push_back({a, last_a = group_a});
            if (group_b != last_b) marks_.push_back({b, last_b = group_b});
            return true;
        });
        return;
    }
    const auto by_box = [&](std::int32_t body, const ShapeTree* known, const Placement& place, std::int32_t other) {
        if (known)
            for_each_overlap(*known, place, near_.box(other), [&](std::int32_t group) {
                marks_.push_back({body, group});
            });
        else
            whole_.push_back(body);
    };
    by_box(a, tree_a, place_a, b);
    by_box(b, tree_b, place_b, a);
}

// Runs work() on the joined worlds. Returns false if it exceeds the memory limit; if there is only one joined world,
// rethrows the exception.
template <class Work>
bool WorldSearch::fits(Work work) const {
    try {
        work();
        return true;
    } catch (const MemoryMeter::Exceeded&) {
        if (joined_.size() < 2) throw;
    }
    return false;
}

void WorldSearch::search_joined(BackendBase& backend, bool gathered, Intersections& result) {
    if (gathered && fits([&] { search_scene(backend, result); }))
        add_found(result);
    else
        search_halves(backend, result);
    joined_.clear();
}

// Searches one half of the joined worlds, then the other, each gathered anew. First frees all memory that was cached
// for the whole, so that a world that remains alone has as much memory as if it had always been alone.
void WorldSearch::search_halves(BackendBase& backend, Intersections& result) {
    const std::vector<std::int32_t> all = std::exchange(joined_, {});
    most_joined_ = std::min(most_joined_, scene_.triangles()) / 2;
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    for (const bool second : {false, true}) {
        if (is_over(result)) return;
        scene_ = WorldScene(&meter_);
        found_ = metered(&meter_);
        backend.release();
        joined_.assign(second ? middle : all.begin(), second ? all.end() : middle);
        const bool gathered = fits([&] {
            scene_.begin(float32_, rules_);
            for (const std::int32_t pass : joined_) {
                cancellation_.check();
                collect(pass);
                gather(backend, pass);
            }
        });
        search_joined(backend, gathered, result);
    }
}

// Runs the query on the scene.
void WorldSearch::search_scene(BackendBase& backend, Intersections& result) {
    IntersectionQuery query;
    query.neighbours = query_.neighbours;
    query.kind = query_.kind;
    query.weld = query_.weld;
    query.output = query_.contacts() ? Output::contacts : Output::pairs;
    const PreparedScene scene = scene_.scene(outline_, query_.weld, backend);
    flags_.assign(joined_.size(), 0);
    found_.statistics = {};
    if (query_.output == Output::any) {
        flags_[0] = backend.any(scene, query);
    } else if (query_.output == Output::any_by_world) {
        backend.any_by_world(scene, query, flags_.span(), found_.statistics);
    } else if (blocks_) {
        const auto append_block = [&](const Intersections& block) { append(block, result); };
        stream_pairs(backend, scene, query, blocks_->most, meter_, cancellation_, append_block, found_.statistics);
    } else {
        backend.find(scene, query, nullptr, found_);
    }
}

// Adds what search_scene() has found to the result.
void WorldSearch::add_found(Intersections& result) {
    for (std::size_t w = 0; w < flags_.size(); ++w)
        if (flags_[w]) hit(joined_[w], outline_, result);
    if (query_.output != Output::any) add_pass(found_.statistics, result.statistics);
    if (query_.output > Output::any_by_world && !blocks_) append(found_, result);
}

// Appends pairs of the scene to the result. They are sorted by world.
void WorldSearch::append(const Intersections& found, Intersections& result) {
    std::size_t world = 0;
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
        const Pair& pair = found.pairs[i];
        while (pair.a >= scene_.first_of_world(world + 1)) ++world;
        const std::int32_t a = scene_.body(pair.a), b = scene_.body(pair.b);
        const Contacts& c = found.contacts;
        add_pair(outline_, query_, joined_[world], {a, b}, {scene_.triangle(pair.a), scene_.triangle(pair.b)}, result);
        if (query_.contacts())
            add_contact(c.kinds[i], {c.points.data() + c.offsets[i], c.points.data() + c.offsets[i + 1]}, result);
        if (blocks_) blocks_->deliver_if_full(result);
    }
}

}  // namespace crumple
