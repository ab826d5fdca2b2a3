#include "distributed/rank_detector.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/float_environment.h"
#include "distributed/delivery.h"
#include "queries/checks.h"

namespace crumple::distribute {
namespace {

// Converts a number to an integer, so that integers sort like the numbers. -0 becomes +0.
std::int64_t ordered(double x) {
    const auto bits = std::bit_cast<std::int64_t>(x + 0.0);
    return bits >= 0 ? bits : std::numeric_limits<std::int64_t>::min() - bits;
}
double number(std::int64_t ordered) {
    return std::bit_cast<double>(ordered >= 0 ? ordered : std::numeric_limits<std::int64_t>::min() - ordered);
}

double time_of_day() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

RankDetector::RankDetector(Transport& transport, const DistributedOptions& options)
    : transport_(transport),
      options_(options),
      batches_(transport, std::max<std::int64_t>(options.batch_bytes, 1024)),
      check_(transport),
      clock_(time_of_day),
      local_(nullptr) {
    check_(Phase::query, [&] {
        check(options.parts >= 0 && options.parts <= max_parts, "parts must be 0 (automatic) to 262144");
        check(options.batch_bytes >= 1024, "batch_bytes must be at least 1024");
        check(options.detector.devices.empty(), "devices must be empty: a rank has one device");
        check(options.detector.method.membership == Membership::ball,
              "the membership rule must be ball: results of ranks could not say that pairs may be missing");
        engine_.emplace(options_.detector);
        batches_.reserve();
    });
    check_.before = [&](Phase phase) {
        statistics_[phase_] += watch_.lap();
        phase_ = phase;
        if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "the call was cancelled");
        if (hook_) hook_(phase);
        show_phase(phase);
    };
}

RankDetector::~RankDetector() = default;

void RankDetector::set_poll(std::function<void()> poll) { engine_->set_poll(std::move(poll)); }

// Shows each phase once: a phase has many collective error checks, and if deltas are sent in groups, Phase::members and
// Phase::memory alternate.
void RankDetector::show_phase(Phase phase) {
    if (shown_ && phase <= *shown_) return;
    shown_ = phase;
    if (show_ && phase != Phase::search) show_({phase});
}

void RankDetector::guard(std::stop_token stop, FunctionRef<void()> phases) {
    const FloatEnvironment environment;
    Stopwatch whole;
    watch_.lap();
    stop_ = std::move(stop);
    statistics_ = {};
    batches_.reset_counts();
    phase_ = Phase::query;
    shown_.reset();
    try {
        phases();
    } catch (...) {
        forget();
        throw;
    }
    statistics_[phase_] += watch_.lap();
    statistics_.milliseconds = whole.lap();
    statistics_.bytes_sent = batches_.bytes_sent();
    statistics_.messages = batches_.messages();
}

void RankDetector::run(const LocalMesh& local, const VertexView* end, FunctionRef<ComparedQuery()> make_query,
                       FunctionRef<void()> prepare, std::stop_token stop, FunctionRef<void()> work) {
    guard(std::move(stop), [&] {
        check_(Phase::query, [&] {
            compared_ = make_query();
            RankMesh::check_shape(local);
        });
        check_query_of_ranks(local, end);
        prepare();
        read(local, end);
        check_ids();
        place();
        list_members();
        deliver();
        work();
    });
}

// One reduction compares what must be equal on all ranks (minima of x and -x) and combines flags; another one exchanges
// counts.
void RankDetector::check_query_of_ranks(const LocalMesh& local, const VertexView* end) {
    std::vector<std::int64_t> values = compared_.values;
    values.push_back(options_.parts);
    values.push_back(options_.batch_bytes);
    // Different queries may have different numbers of values.
    constexpr std::size_t n = 20;
    if (values.size() > n) throw std::logic_error("RankDetector: a query has more numbers than ranks compare");
    values.resize(n, 0);
    for (std::size_t i = 0; i < n; ++i) values.push_back(-values[i]);
    const auto is_float64 = [](const VertexView& view) { return view.type == ScalarType::float64 && view.rows > 0; };
    values.push_back(-std::int64_t{!local.triangle_ids.empty()});
    values.push_back(-std::int64_t{!local.vertex_ids.empty()});
    values.push_back(-std::int64_t{!local.mesh.groups.empty()});
    // A mesh without vertices has no precision.
    values.push_back(-std::int64_t{is_float64(local.mesh.vertices) || (end && is_float64(*end))});
    reduce(values, Reduction::min);
    triangle_ids_ = values[2 * n] != 0, vertex_ids_ = values[2 * n + 1] != 0, groups_ = values[2 * n + 2] != 0;
    float32_ = values[2 * n + 3] == 0;
    counts_.assign(2 * static_cast<std::size_t>(transport_.size()), 0);
    counts_[2 * static_cast<std::size_t>(transport_.rank())] = local.mesh.triangles.rows;
    counts_[2 * static_cast<std::size_t>(transport_.rank()) + 1] = local.mesh.vertices.rows;
    reduce(counts_, Reduction::sum);
    check_(Phase::query, [&] {
        for (std::size_t i = 0; i < n; ++i)
            check(values[i] == -values[n + i], "the query and the options must be the same on all ranks");
        std::int64_t triangles = 0;
        for (std::size_t r = 0; r < counts_.size(); r += 2) triangles += counts_[r];
        check(!compared_.between_groups || groups_ || triangles == 0,
              "filter.groups = between needs groups, and no rank has any: nothing lies between different groups");
    });
}

void RankDetector::read(const LocalMesh& local, const VertexView* end) {
    check_(Phase::input, [&] {
        local_.number(local, triangle_ids_, vertex_ids_, counts_, transport_.rank());
        if (local.mesh.memory == MemorySpace::host) {
            local_.read(local, engine_->workers());
            if (end) local_.read_end(*end, engine_->workers());
            return;
        }
        DeviceShape there{Shape(local.mesh), local.mesh.stream};
        if (end) there.shape.end = *end;
        engine_->copy_to_host(there, staged_);
        LocalMesh here = local;
        here.mesh = MeshView(staged_.shape.vertices, staged_.shape.triangles, staged_.shape.groups);
        local_.read(here, engine_->workers());
        if (end) local_.read_end(staged_.shape.end, engine_->workers());
    });
    const PreparedScene& scene = local_.scene();
    const bool empty = scene.vertex_count() == 0;
    constexpr double most = std::numeric_limits<double>::max();
    std::array<std::int64_t, 8> least{};
    for (int axis = 0; axis < 3; ++axis) {
        least[static_cast<std::size_t>(axis)] = ordered(empty ? most : scene.low[axis]);
        least[3 + static_cast<std::size_t>(axis)] = ordered(empty ? most : -scene.high[axis]);
    }
    std::int64_t last = -1;
    if (vertex_ids_)
        for (std::int64_t v = 0; v < scene.vertex_count(); ++v)
            last = std::max<std::int64_t>(last, local_.vertices()(v));
    least[6] = -last;
    bool same = false;
    check_(Phase::input, [&] { same = local_.is_same_as_before(); });
    least[7] = same;
    reduce(least, Reduction::min);
    if (vertex_ids_) {
        // Checks that the largest id is less than the number of vertices of all ranks, before any rank allocates arrays
        // of that size.
        check_(Phase::input, [&] {
            std::int64_t brought = 0;
            for (std::size_t r = 1; r < counts_.size(); r += 2) brought += counts_[r];
            if (-least[6] < brought) return;
            throw Error(ErrorCode::invalid_argument,
                        "there is a vertex with the id " + std::to_string(-least[6]) +
                            ", but all ranks together have " + std::to_string(brought) +
                            " vertices: some ids are missing",
                        Element::vertex, -least[6]);
        });
        local_.set_vertices(-least[6] + 1);
    }
    box_ = {};
    if (least[0] != ordered(most))
        for (int axis = 0; axis < 3; ++axis) {
            box_.low[axis] = number(least[static_cast<std::size_t>(axis)]);
            box_.high[axis] = -number(least[3 + static_cast<std::size_t>(axis)]);
        }
    same_ = least[7] != 0;
}

void RankDetector::check_ids() {
    if (!same_) {
        if (triangle_ids_) check_each_once(batches_, check_, local_.triangles(), local_.scene().triangle_count());
        copies_.learn(batches_, check_, local_.vertices(), local_.scene().vertex_count());
        features_.forget();
        bodies_.forget_edges();
    }
    copies_.check(batches_, check_, local_.scene().reader[0], float32_, "");
    if (!compared_.features) return;
    if (compared_.features->moving) copies_.check(batches_, check_, local_.scene().end, float32_, " at the end");
    if (!features_.known()) features_.learn(batches_, check_, local_, copies_);
}

void RankDetector::place() {
    const int parts = requested_parts();
    const bool serves = layout_.serves(parts, box_);
    if (same_ && serves && compared_.features == demand_ && !on_any_rank(members_.stale())) return;
    same_ = false;
    drop_parts();
    demand_ = compared_.features;
    if (serves) return;
    owners_.forget();
    expected_work_.clear();
    layout_.make(batches_, check_, local_, parts, box_, engine_->workers());
}

void RankDetector::list_members() {
    check_(Phase::members, [&] {
        if (demand_) {
            const FeaturePartDemand query{demand_->moving, demand_->distance, demand_->share};
            layout_.widen(&query);
        } else {
            layout_.widen(nullptr);
        }
        members_.set_features(demand_ ? &features_ : nullptr);
        members_.update(local_, layout_, engine_->workers());
    });
    give_out();
    check_(Phase::members, [&] { own_parts(); });
}

// At first assigns parts by their number of members, each to a rank that has many of these; later by measured work, if
// it is unbalanced.
void RankDetector::give_out() {
    if (owners_.known()) return give_out_anew();
    std::vector<std::int64_t> all(members_.counts().begin(), members_.counts().end());
    reduce(all, Reduction::sum);
    const std::vector<std::vector<int>> near = ranks_near_parts();
    owners_.give_out(all, transport_.size(), [&](std::size_t part) { return std::span<const int>(near[part]); });
}

// Returns up to four ranks for each part, those with most of its members. With many ranks, a table of all would be too
// large.
std::vector<std::vector<int>> RankDetector::ranks_near_parts() {
    const std::span<const std::int64_t> mine = members_.counts();
    const std::int64_t ranks = transport_.size(), rank = transport_.rank();
    std::vector<std::vector<int>> near(mine.size());
    std::vector<std::int64_t> next(mine.size());
    for (int round = 0; round < std::min<std::int64_t>(4, ranks); ++round) {
        // Packs the number of members and the rank into one number, so that one reduction finds the rank with the most
        // members.
        for (std::size_t k = 0; k < mine.size(); ++k) {
            const bool is_informed = std::find(near[k].begin(), near[k].end(), rank) != near[k].end();
            next[k] = is_informed || mine[k] == 0 ? -1 : (mine[k] << 32) + (ranks - 1 - rank);
        }
        reduce(next, Reduction::max);
        for (std::size_t k = 0; k < mine.size(); ++k)
            if (next[k] >= 0) near[k].push_back(static_cast<int>(ranks - 1 - (next[k] & 0xffffffff)));
    }
    return near;
}

// A part must be sent as a whole to a new owner, so few parts should change owners.
void RankDetector::give_out_anew() {
    if (transport_.size() == 1 || expected_work_.empty()) return;
    const double balance = owners_.balance(expected_work_, transport_.size());
    if (balance < 1.1) return;
    Owners others;
    others.give_out(expected_work_, transport_.size(),
                    [&](std::size_t part) { return owners_.all().subspan(part, 1); });
    if (others.balance(expected_work_, transport_.size()) > 0.93 * balance) return;
    for (std::int32_t k = 0; k < layout_.parts(); ++k)
        if (others.of(k) != owners_.of(k)) members_.send_again(k);
    owners_ = std::move(others);
    same_ = false;
}

// Keeps parts that this rank owned before; others begin empty.
void RankDetector::own_parts() {
    std::vector<AssembledPart> mine;
    for (const std::int32_t k : owners_.parts_of(transport_.rank())) {
        const auto at =
            std::find_if(mine_.begin(), mine_.end(), [&](const AssembledPart& part) { return part.index() == k; });
        if (at != mine_.end()) {
            mine.push_back(std::move(*at));
            continue;
        }
        mine.emplace_back(k, layout_.parts(), layout_.path(k), float32_, groups_);
        if (demand_) mine.back().set_feature_demand(demand_->moving);
        assemblies_.erase(k);
    }
    mine_ = std::move(mine);
}

void RankDetector::deliver() {
    const auto depth = static_cast<std::size_t>(layout_.tree().depth);
    const bool features = demand_.has_value();
    Delivery(batches_, check_, owners_, members_, local_, copies_, mine_, depth)
        .run({.float32 = float32_, .features = features, .moving = features && demand_->moving},
             [&](std::int64_t bytes) {
                 MemoryMeter& memory = engine_->memory();
                 if (memory.limit == 0) return;
                 memory.add(bytes);
                 reserved_ += bytes;
             });
    // Releases what was reserved for triangles that have left and for parts that have moved to other ranks.
    std::int64_t kept = 0;
    for (const AssembledPart& part : mine_) kept += part.bytes();
    if (kept < reserved_) engine_->memory().add(kept - std::exchange(reserved_, kept));
    statistics_.moved = same_;
}

void RankDetector::search(FunctionRef<void(AssembledPart&)> each, FunctionRef<bool()> done) {
    work_.assign(static_cast<std::size_t>(layout_.parts()), 0);
    check_(Phase::search, [&] {
        DistributedProgress progress{Phase::search};
        progress.parts = static_cast<int>(
            std::count_if(mine_.begin(), mine_.end(), [](const AssembledPart& part) { return part.size() > 0; }));
        if (show_) show_(progress);
        for (AssembledPart& part : mine_) {
            if (part.size() == 0 || done()) continue;
            const double begin = clock_();
            each(part);
            const double milliseconds = clock_() - begin;
            work_[static_cast<std::size_t>(part.index())] = static_cast<std::int64_t>(1e6 * milliseconds);
            statistics_.work_milliseconds += milliseconds;
            statistics_.members += part.size();
            ++statistics_.parts;
            ++progress.parts_done;
            if (show_) show_(progress);
        }
    });
}

void RankDetector::forget() {
    local_.forget();
    layout_.forget();
    owners_.forget();
    drop_parts();
    expected_work_.clear();
    features_.forget();
    bodies_.forget();
    result_ = {}, world_result_ = {}, impacts_ = {}, nearby_ = {}, overlaps_ = {};
    engine_->release();
}

void RankDetector::drop_parts() {
    mine_.clear();
    assemblies_.clear();
    members_.forget();
    if (reserved_ > 0) engine_->memory().add(-std::exchange(reserved_, 0));
}

// Two ranks are balanced with one part each. More ranks get several parts each, whose work averages out, as long as
// parts have some thousand triangles: more parts overlap more (benchmark study "ranks").
int RankDetector::requested_parts() const {
    if (options_.parts > 0) return options_.parts;
    const int ranks = transport_.size();
    if (ranks <= 2) return ranks;
    const std::int64_t triangles = local_.triangles().all / ranks, most = triangles > 100'000 ? 8 : 4;
    return static_cast<int>(
        std::min<std::int64_t>(max_parts, ranks * std::clamp<std::int64_t>(triangles / 2500, 1, most)));
}

bool RankDetector::on_any_rank(bool here) {
    std::int64_t flag = here;
    reduce({&flag, 1}, Reduction::max);
    return flag != 0;
}

}  // namespace crumple::distribute
