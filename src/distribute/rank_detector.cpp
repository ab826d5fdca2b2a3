#include "distribute/rank_detector.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "base/float_environment.h"
#include "distribute/delivery.h"
#include "engine/output.h"
#include "geometry/position_hash.h"

namespace crumple::distribute {
namespace {

// Integers in the order of the numbers. -0 is +0.
std::int64_t ordered(double x) {
    const auto bits = std::bit_cast<std::int64_t>(x + 0.0);
    return bits >= 0 ? bits : std::numeric_limits<std::int64_t>::min() - bits;
}
double number(std::int64_t ordered) {
    return std::bit_cast<double>(ordered >= 0 ? ordered : std::numeric_limits<std::int64_t>::min() - ordered);
}

/// What ranks have to agree upon, as numbers.
std::vector<std::int64_t> told(const Query& query, int wants, const DistributedOptions& options) {
    std::vector<std::int64_t> told{wants,
                                   static_cast<std::int64_t>(query.neighbours),
                                   static_cast<std::int64_t>(query.intersections),
                                   query.weld,
                                   query.contacts,
                                   static_cast<std::int64_t>(query.wanted),
                                   options.parts,
                                   options.round_bytes,
                                   static_cast<std::int64_t>(query.excluded_groups.size())};
    // A word that differs, all but surely, where the lists do.
    std::uint64_t word = 0x9e3779b97f4a7c15ull;
    for (const GroupPair& pair : query.excluded_groups)
        for (const std::int32_t group : {std::min(pair.first, pair.second), std::max(pair.first, pair.second)})
            word = (word ^ static_cast<std::uint32_t>(group)) * 0xff51afd7ed558ccdull, word ^= word >> 32;
    told.push_back(static_cast<std::int64_t>(word >> 1));
    return told;
}

double time_of_day() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void check(bool holds, const char* message) {
    if (!holds) throw Error(ErrorCode::invalid_argument, message, Element::option);
}

}  // namespace

RankDetector::RankDetector(Transport& transport, const DistributedOptions& options)
    : transport_(transport),
      options_(options),
      rounds_(transport, std::max<std::int64_t>(options.round_bytes, 1024)),
      agree_(transport),
      clock_(time_of_day),
      share_(nullptr) {
    agree_(Phase::question, [&] {
        check(options.parts >= 0 && options.parts <= max_parts, "parts must be 0 (chosen) to 262144");
        check(options.round_bytes >= 1024, "round_bytes must be at least 1024");
        engine_.emplace(options_.detector);
    });
    agree_.before = [&](Phase phase) {
        result_.statistics[phase_] += watch_.lap();
        phase_ = phase;
        if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "the call was cancelled");
        if (hook_) hook_(phase);
    };
}

const DistributedCollisions& RankDetector::find_self(const MeshShare& share, const Query& query, std::stop_token stop) {
    answer(share, query, Wants::pairs, std::move(stop));
    return result_;
}
std::int64_t RankDetector::count(const MeshShare& share, const Query& query, std::stop_token stop) {
    answer(share, query, Wants::count, std::move(stop));
    return result_.total;
}
bool RankDetector::has_collision(const MeshShare& share, const Query& query, std::stop_token stop) {
    answer(share, query, Wants::any, std::move(stop));
    return result_.total > 0;
}

void RankDetector::answer(const MeshShare& share, const Query& query, Wants wants, std::stop_token stop) {
    const FloatEnvironment environment;
    Stopwatch whole;
    watch_.lap();
    stop_ = std::move(stop);
    result_.statistics = {};
    result_.pairs.clear();
    result_.contacts = {};
    rounds_.reset_counts();
    phase_ = Phase::question;
    try {
        ask(share, query, wants);
        read(share);
        settle_ids();
        place();
        list_members();
        deliver();
        search(query, wants);
        finish(query, wants);
    } catch (...) {
        forget();
        throw;
    }
    DistributedStatistics& statistics = result_.statistics;
    statistics[phase_] += watch_.lap();
    statistics.milliseconds = whole.lap();
    statistics.bytes_sent = rounds_.bytes_sent();
    statistics.messages = rounds_.messages();
}

// One reduction for all that ranks have to agree upon, or to know of each other.
void RankDetector::ask(const MeshShare& share, const Query& query, Wants wants) {
    agree_(Phase::question, [&] { Share::check_shape(share); });
    std::vector<std::int64_t> asked = told(query, static_cast<int>(wants), options_);
    const std::size_t n = asked.size();
    for (std::size_t i = 0; i < n; ++i) asked.push_back(-asked[i]);
    asked.push_back(-std::int64_t{!share.triangle_ids.empty()});
    asked.push_back(-std::int64_t{!share.vertex_ids.empty()});
    asked.push_back(-std::int64_t{!share.mesh.groups.empty()});
    // What has no vertices has no precision.
    asked.push_back(-std::int64_t{share.mesh.vertices.type == ScalarType::float64 && share.mesh.vertices.rows > 0});
    reduce(asked, Reduction::min);
    triangle_ids_ = asked[2 * n] != 0, vertex_ids_ = asked[2 * n + 1] != 0, groups_ = asked[2 * n + 2] != 0;
    float32_ = asked[2 * n + 3] == 0;
    counts_.assign(2 * static_cast<std::size_t>(transport_.size()), 0);
    counts_[2 * static_cast<std::size_t>(transport_.rank())] = share.mesh.triangles.rows;
    counts_[2 * static_cast<std::size_t>(transport_.rank()) + 1] = share.mesh.vertices.rows;
    reduce(counts_, Reduction::sum);
    agree_(Phase::question, [&] {
        for (std::size_t i = 0; i < n; ++i)
            check(asked[i] == -asked[n + i], "the ranks ask different questions, or have different options");
        std::int64_t triangles = 0;
        for (std::size_t r = 0; r < counts_.size(); r += 2) triangles += counts_[r];
        check(query.wanted != Wanted::between || groups_ || triangles == 0,
              "wanted between needs groups, and no rank has any: nothing lies between different groups");
    });
}

void RankDetector::read(const MeshShare& share) {
    agree_(Phase::input, [&] {
        share_.number(share, triangle_ids_, vertex_ids_, counts_, transport_.rank());
        share_.read(share, engine_->workers());
    });
    const Scene& scene = share_.scene();
    const bool empty = scene.vertex_count() == 0;
    constexpr double most = std::numeric_limits<double>::max();
    std::array<std::int64_t, 8> least{};
    for (int axis = 0; axis < 3; ++axis) {
        least[static_cast<std::size_t>(axis)] = ordered(empty ? most : scene.low[axis]);
        least[static_cast<std::size_t>(3 + axis)] = ordered(empty ? most : -scene.high[axis]);
    }
    std::int64_t last = -1;
    if (vertex_ids_)
        for (std::int64_t v = 0; v < scene.vertex_count(); ++v)
            last = std::max<std::int64_t>(last, share_.vertices()(v));
    least[6] = -last;
    bool same = false;
    agree_(Phase::input, [&] { same = share_.is_same_as_before(); });
    least[7] = same;
    reduce(least, Reduction::min);
    if (vertex_ids_) share_.set_vertices(-least[6] + 1);
    box_ = {};
    if (least[0] != ordered(most))
        for (int axis = 0; axis < 3; ++axis) {
            box_.low[axis] = number(least[static_cast<std::size_t>(axis)]);
            box_.high[axis] = -number(least[static_cast<std::size_t>(3 + axis)]);
        }
    same_ = least[7] != 0;
}

void RankDetector::settle_ids() {
    if (!same_) {
        if (triangle_ids_) check_each_once(rounds_, agree_, share_.triangles(), share_.scene().triangle_count());
        copies_.learn(rounds_, agree_, share_.vertices(), share_.scene().vertex_count());
    }
    copies_.check(rounds_, agree_, share_, float32_);
}

void RankDetector::place() {
    const int parts = parts_wanted();
    const bool serves = placement_.serves(parts, box_);
    if (same_ && serves && !on_any_rank(members_.stale())) return;
    same_ = false;
    drop_parts();
    if (serves) return;
    owners_.forget();
    expected_work_.clear();
    placement_.make(rounds_, agree_, share_, parts, box_, engine_->workers());
}

void RankDetector::list_members() {
    agree_(Phase::members, [&] { members_.update(share_, placement_, engine_->workers()); });
    give_out();
    agree_(Phase::members, [&] { own_parts(); });
}

// By members for a start, each part to a rank that has many of them; by measured work where that is far from even.
void RankDetector::give_out() {
    if (owners_.known()) return give_out_anew();
    const auto ranks = static_cast<std::size_t>(transport_.size()),
               parts = static_cast<std::size_t>(placement_.parts());
    std::vector<std::int64_t> all(members_.counts().begin(), members_.counts().end()), by_rank;
    reduce(all, Reduction::sum);
    constexpr std::size_t most = std::size_t{1} << 16;  // numbers in one reduction
    if (parts * ranks <= most) {
        by_rank.assign(parts * ranks, 0);
        for (std::size_t k = 0; k < parts; ++k)
            by_rank[k * ranks + static_cast<std::size_t>(transport_.rank())] = members_.counts()[k];
        reduce(by_rank, Reduction::sum);
    }
    owners_.give_out(all, transport_.size(), [&](std::size_t part, std::size_t rank) {
        return by_rank.empty() ? 0 : by_rank[part * ranks + rank];
    });
}

// Parts that change hands begin anew, so few should.
void RankDetector::give_out_anew() {
    if (transport_.size() == 1 || expected_work_.empty()) return;
    const double balance = owners_.balance(expected_work_, transport_.size());
    if (balance < 1.2) return;
    Owners others;
    others.give_out(expected_work_, transport_.size(), [&](std::size_t part, std::size_t rank) {
        return std::int64_t{owners_.all()[part] == static_cast<int>(rank)};
    });
    if (others.balance(expected_work_, transport_.size()) > 0.9 * balance) return;
    for (std::int32_t k = 0; k < placement_.parts(); ++k)
        if (others.of(k) != owners_.of(k)) members_.tell_anew(k);
    owners_ = std::move(others);
    same_ = false;
}

// Those that this rank owned before go on; others begin empty.
void RankDetector::own_parts() {
    std::vector<AssembledPart> mine;
    for (const std::int32_t k : owners_.parts_of(transport_.rank())) {
        const auto at =
            std::find_if(mine_.begin(), mine_.end(), [&](const AssembledPart& part) { return part.index() == k; });
        if (at != mine_.end())
            mine.push_back(std::move(*at));
        else
            mine.emplace_back(k, placement_.parts(), placement_.path(k), float32_, groups_);
    }
    mine_ = std::move(mine);
}

void RankDetector::deliver() {
    const auto depth = static_cast<std::size_t>(placement_.tree().depth);
    Delivery(rounds_, agree_, owners_, members_, share_, copies_, mine_, depth)
        .run({.float32 = float32_}, [&](std::int64_t bytes) {
            MemoryMeter& memory = engine_->memory();
            if (memory.limit == 0) return;
            memory.add(bytes);
            reserved_ += bytes;
        });
    result_.statistics.moved = same_;
}

void RankDetector::search(const Query& query, Wants wants) {
    found_.emplace(transport_.size());
    found_here_ = 0;
    work_.assign(static_cast<std::size_t>(placement_.parts()), 0);
    DistributedStatistics& statistics = result_.statistics;
    agree_(Phase::search, [&] {
        for (std::size_t m = 0; m < mine_.size(); ++m) {
            AssembledPart& part = mine_[m];
            if (part.size() == 0 || (wants == Wants::any && found_here_ > 0)) continue;
            const double begin = clock_();
            if (wants == Wants::any) {
                found_here_ = engine_->any(part.part(), query, part.memory(), stop_);
            } else {
                const Collisions& found = engine_->find(part.part(), query, part.memory(), stop_);
                found_here_ += static_cast<std::int64_t>(found.pairs.size());
                if (wants == Wants::pairs) found_->add(part, found);
                add_pass(found.statistics, statistics.search);
            }
            const double milliseconds = clock_() - begin;
            work_[static_cast<std::size_t>(part.index())] = static_cast<std::int64_t>(1e6 * milliseconds);
            statistics.work_milliseconds += milliseconds;
            statistics.members += part.size();
            ++statistics.parts;
        }
    });
}

void RankDetector::finish(const Query& query, Wants wants) {
    if (wants == Wants::pairs) found_->exchange(rounds_, agree_, query.contacts, result_);
    found_.reset();
    const std::int64_t here = std::accumulate(work_.begin(), work_.end(), std::int64_t{0});
    work_.push_back(found_here_);
    reduce(work_, Reduction::sum);
    result_.total = work_.back();
    work_.pop_back();
    expect_work(wants);
    std::int64_t largest = here;
    reduce({&largest, 1}, Reduction::max);
    result_.statistics.largest_work = 1e-6 * static_cast<double>(largest);
    result_.statistics.mean_work =
        1e-6 * static_cast<double>(std::accumulate(work_.begin(), work_.end(), std::int64_t{0})) / transport_.size();
    result_.statistics.search.pairs = found_here_;
}

// Of the next call: a mean of calls before, for times jitter. A search for any pair is cut short, and tells nothing.
void RankDetector::expect_work(Wants wants) {
    if (wants == Wants::any) return;
    const bool known = expected_work_.size() == work_.size();
    if (!known) expected_work_ = work_;
    for (std::size_t k = 0; known && k < work_.size(); ++k) expected_work_[k] = (expected_work_[k] + work_[k]) / 2;
}

void RankDetector::forget() {
    share_.forget();
    placement_.forget();
    owners_.forget();
    drop_parts();
    expected_work_.clear();
    found_.reset();
    result_ = {};
    engine_->release();
}

void RankDetector::drop_parts() {
    mine_.clear();
    members_.forget();
    if (reserved_ > 0) engine_->memory().add(-std::exchange(reserved_, 0));
}

// Two ranks share evenly as it is. More get several parts each, which even out, as long as these are of some thousand
// triangles: more of them overlap more (benchmark study "ranks").
int RankDetector::parts_wanted() const {
    if (options_.parts > 0) return options_.parts;
    const int ranks = transport_.size();
    if (ranks <= 2) return ranks;
    const std::int64_t triangles = share_.triangles().all / ranks, most = triangles > 100'000 ? 8 : 4;
    return static_cast<int>(
        std::min<std::int64_t>(max_parts, ranks * std::clamp<std::int64_t>(triangles / 2500, 1, most)));
}

bool RankDetector::on_any_rank(bool here) {
    std::int64_t flag = here;
    reduce({&flag, 1}, Reduction::max);
    return flag != 0;
}

}  // namespace crumple::distribute
