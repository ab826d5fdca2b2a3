#include "backends/cpu/candidates/candidate_leaves.h"

#include <algorithm>
#include <bit>

#include "backends/cpu/order.h"
#include "backends/cpu/stages/sweep.h"
#include "base/float_environment.h"
#include "base/stopwatch.h"
#include "results/intersection_output.h"

namespace crumple::cpu {
namespace {

// Number of candidates for whose pairs memory is reserved at once.
constexpr std::int64_t batch = CandidateKernels::most;

const CandidateRecord& dummy_record() {
    static const CandidateRecord dummy = [] {
        CandidateRecord record{};
        for (int axis = 0; axis < 3; ++axis)
            for (int lane = 0; lane < candidate_lanes; ++lane)
                record.low[axis][lane] = beyond, record.high[axis][lane] = -beyond;
        std::fill_n(record.id, candidate_lanes, -1);
        std::fill_n(record.name, 4, -1);
        return record;
    }();
    return dummy;
}

}  // namespace

CandidateLeaves::Worker::Worker(MemoryMeter* m) : built(m), sorted(m), candidates(m), unsure(m), found(m) {}

CandidateLeaves::CandidateLeaves(MemoryMeter* meter, int workers, const CandidateKernels& kernels) : kernels_(kernels) {
    for (int w = 0; w < workers; ++w) {
        worker_.push_back(std::make_unique<Worker>(meter));
        for (std::size_t kind = 0; kind < candidate_kinds; ++kind)
            found_[kind].push_back(&worker_.back()->found.lists[kind].pairs);
    }
}

void CandidateLeaves::ask(const FeatureRequest& query) {
    query_ = &query;
    stream_ = nullptr;
    rounds_ = LaneSteps(query.kinds, query.neighbours);
}

void CandidateLeaves::begin(const Call& call) {
    call_ = &call;
    normaliser_ = Normaliser(call.scene.low, call.scene.high);
    for (const auto& worker : worker_) {
        worker->found.clear();
        worker->statistics = {};
    }
}

bool CandidateLeaves::stop() const {
    call_->cancellation.check();
    return false;
}

CandidateLeaves::InflatedBox CandidateLeaves::write_member(std::int32_t triangle, const CandidateKey& key,
                                                           CandidateRecord& record) const {
    const SceneFeatures& features = query_->features;
    const std::int32_t* corner = call_->scene.corners + 3 * std::int64_t{triangle};
    const TriangleEdges& edges = features.edges_of(triangle);
    const double r = query_->distance;
    record = dummy_record();
    record.owned = owned_lanes(triangle);
    record.id[6] = triangle;
    Vec3f low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        record.vertex[k] = corner[k];
        record.name[k] = features.name(corner[k]);
        record.id[k] = features.point_of(triangle, k);
        record.id[3 + k] = edges[static_cast<std::size_t>(k)];
        const FeatureBox box = swept_box(call_->scene, corner + k, 1);
        low[k] = key(box.low - Vec3d{r, r, r});
        high[k] = key(box.high + Vec3d{r, r, r});
    }
    const auto write = [&](int lane, const Vec3f& from, const Vec3f& to) {
        if (!(record.owned >> lane & 1)) return;
        for (int axis = 0; axis < 3; ++axis) record.low[axis][lane] = from[axis], record.high[axis][lane] = to[axis];
    };
    for (int k = 0; k < 3; ++k) {
        write(k, low[k], high[k]);
        write(3 + k, min(low[k], low[(k + 1) % 3]), max(high[k], high[(k + 1) % 3]));
    }
    const InflatedBox box{min(low[0], min(low[1], low[2])), max(high[0], max(high[1], high[2]))};
    write(6, box.low, box.high);
    return box;
}

unsigned CandidateLeaves::owned_lanes(std::int32_t triangle) const {
    return crumple::owned_lanes(query_->features.owned(triangle), triangle < query_->features.faces());
}

// Writes boxes with the sweep direction first: the coordinate axis that is nearest to the leaf's own first axis. Runs
// without flush to zero, because keys (rounded coordinates of inflated boxes) are computed from numbers that may be
// subnormal.
void CandidateLeaves::build(const BuildInput& input, LeafMembers& members, std::size_t w) {
    const FloatEnvironment environment;
    Worker& worker = *worker_[w];
    worker.built.resize_discard(static_cast<std::size_t>(input.members + padding));
    const LeafFrame& frame = input.frame;
    const Vec3f along = abs(frame.axis[0]);
    const int first = along.x == largest(along) ? 0 : along.y == largest(along) ? 1 : 2;
    const CandidateKey key{normaliser_, {frame.origin.x, frame.origin.y, frame.origin.z}};
    LeafBounds& bounds = members.bounds;
    bounds = {};
    // Members are scattered in memory: prefetches the vertices of later members, and the indices of still later ones.
    const PreparedScene& scene = call_->scene;
    const auto fetch = [](const VertexReader& reader, std::int64_t vertex) {
        __builtin_prefetch(reader.data + vertex * reader.row_stride);
    };
    for (std::int64_t i = 0; i < input.members; ++i) {
        __builtin_prefetch(scene.corners + 3 * std::int64_t{input.triangle[i + 24]});
        __builtin_prefetch(&query_->features.edges_of(input.triangle[i + 24]));
        const std::int32_t* ahead = scene.corners + 3 * std::int64_t{input.triangle[i + 12]};
        for (int k = 0; k < 3; ++k) {
            fetch(scene.reader[0], ahead[k]);
            if (scene.moving) fetch(scene.end, ahead[k]);
        }
        const InflatedBox box = write_member(input.triangle[i], key, worker.built[i]);
        Vec3f low, high;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = box.low[(first + axis) % 3];
            high[axis] = box.high[(first + axis) % 3];
        }
        members.boxes.low[i] = {low.x, low.y, low.z, 0};
        members.boxes.high[i] = {high.x, high.y, high.z, 0};
        const float reach = max(largest(abs(low)), largest(abs(high)));
        const bool big = reach > frame.big;
        bounds.reach = max(bounds.reach, big ? big_share * reach : reach);
        bounds.big += big;
        if (big) continue;
        bounds.low = min(bounds.low, low);
        bounds.high = max(bounds.high, high);
    }
}

void CandidateLeaves::place(const SortedLeaf& leaf, std::size_t w) {
    Worker& worker = *worker_[w];
    worker.sorted.resize_discard(static_cast<std::size_t>(leaf.rows + padding));
    for_each_dummy(leaf, [&](std::int64_t row) { worker.sorted[row] = dummy_record(); });
    for (std::int64_t i = 0; i < leaf.members; ++i) worker.sorted[leaf.position[i]] = worker.built[i];
}

void CandidateLeaves::sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
                            std::size_t builder, std::size_t w) {
    Worker& worker = *worker_[w];
    Statistics& statistics = worker.statistics;
    Stopwatch watch;
    const auto should_stop = [&] {
        watch.lap();
        return stop();
    };
    sweep_chunks(call_->kernels, leaf, first, last, worker.candidates, should_stop, [&] {
        statistics[Stage::sweep] += watch.lap();
        if (worker.candidates.pairs == 0) return;
        statistics.box_overlaps += worker.candidates.pairs;
        if (!ownership.complete() || !call_->rule.trivial()) drop_foreign(leaf, ownership, worker);
        narrow(*worker_[builder], worker);
        statistics[Stage::narrow] += watch.lap();
    });
}

// Turns candidates that another leaf owns, or that the pair filter excludes, into padding.
void CandidateLeaves::drop_foreign(const SortedLeaf& leaf, const Ownership& ownership, Worker& worker) const {
    const PreparedScene& scene = call_->scene;
    const SceneFilter& rule = call_->rule;
    CandidateChunk& candidates = worker.candidates;
    for (std::int64_t k = 0; k < candidates.count; ++k) {
        if (candidates.column[k] == candidates.dummy) continue;
        const std::int64_t row = candidates.rows + candidates.row[k],
                           column = candidates.columns + candidates.column[k];
        const std::int32_t a = leaf.link[row].triangle, b = leaf.link[column].triangle;
        const bool ours = (ownership.complete() || ownership.owns(a, leaf.member[row], b, leaf.member[column])) &&
                          (rule.trivial() || rule(scene.group(a), scene.group(b)));
        if (!ours) candidates.column[k] = candidates.dummy;
    }
}

// Tests candidates batch by batch. Pairs are written past the ends of their lists, where memory is reserved for the
// most that a batch can find.
void CandidateLeaves::narrow(const Worker& builder, Worker& worker) const {
    constexpr std::size_t most[candidate_kinds] = {6, 9, 6, 1, 18, 9};
    const CandidateChunk& candidates = worker.candidates;
    const CandidateRecord* record = builder.sorted.data();
    worker.unsure.resize_discard(batch + 1);
    for (std::int64_t begin = 0; begin < candidates.count; begin += batch) {
        const std::int64_t end = std::min(candidates.count, begin + batch);
        PairEnds next{};
        for (std::size_t k = 0; k < candidate_kinds; ++k) {
            if (!query_->kinds[k]) continue;
            Array<Pair>& pairs = worker.found.lists[k].pairs;
            pairs.grow_by(most[k] * batch + candidate_lanes);
            next[k] = pairs.end();
        }
        const std::size_t unsure = kernels_.find(record, candidates, begin, end, rounds_, next, worker.unsure.data());
        for (std::size_t h = 0; h < unsure; ++h) {
            const UncertainTests& hit = worker.unsure[h];
            list(hit, record[candidates.rows + hit.row], record[candidates.columns + hit.column], next);
        }
        for (std::size_t k = 0; k < candidate_kinds; ++k) {
            Array<Pair>& pairs = worker.found.lists[k].pairs;
            if (query_->kinds[k]) pairs.resize(static_cast<std::size_t>(next[k] - pairs.data()));
        }
        pass_on(worker);
    }
}

// Delivers the pairs found so far to the stream, if they are many.
void CandidateLeaves::pass_on(Worker& worker) const {
    constexpr std::size_t rows_of_piece = 2048;
    if (stream_ && worker.found.size() >= rows_of_piece) stream_->add(worker.unit, worker.found);
}

// Decides uncertain pairs in exact arithmetic, and lists those whose inflated boxes overlap.
void CandidateLeaves::list(const UncertainTests& hit, const CandidateRecord& a, const CandidateRecord& b,
                           PairEnds& next) const {
    std::uint64_t overlaps = 0;
    for (std::uint64_t bits = hit.bits; bits; bits &= bits - 1) {
        const int bit = std::countr_zero(bits);
        const LaneSteps::Listed& lanes = rounds_.listed[bit];
        if (inflated_boxes_overlap(box(a, lanes.row), box(b, lanes.column), query_->distance))
            overlaps |= std::uint64_t{1} << bit;
    }
    list_pairs(overlaps, rounds_, a, b, next);
}

FeatureBox CandidateLeaves::box(const CandidateRecord& record, int lane) const {
    std::int32_t vertex[3] = {};
    int count = 0;
    for (unsigned corners = corners_of(lane); corners; corners &= corners - 1)
        vertex[count++] = record.vertex[std::countr_zero(corners)];
    return swept_box(call_->scene, vertex, count);
}

void CandidateLeaves::search_within(std::int64_t begin, std::int64_t end, std::size_t w) {
    const CandidateKey key{normaliser_, {}};
    Worker& worker = *worker_[w];
    // `a` is the lane before `b`, so its type is the one that the kind names first, or the same.
    const auto list = [&](const CandidateRecord& record, int a, int b) {
        Pair pair{record.id[a], record.id[b]};
        if (type_of(a) == type_of(b) && pair.b < pair.a) std::swap(pair.a, pair.b);
        worker.found[kind_of(a, b)].pairs.push_back(pair);
    };
    // Without neighbours, only two vertices, or a vertex and the opposite edge, are left.
    const int first_lanes = query_->neighbours ? 6 : 3, lanes = query_->neighbours ? 7 : 6;
    for (std::int64_t t = begin; t < end; ++t) {
        const unsigned owned = owned_lanes(static_cast<std::int32_t>(t));
        if ((owned & ((1u << first_lanes) - 1)) == 0 || !call_->rule(call_->scene.group(t), call_->scene.group(t)))
            continue;
        CandidateRecord record;
        write_member(static_cast<std::int32_t>(t), key, record);
        const SharedCorners shared(record, record);
        for (int a = 0; a < first_lanes; ++a) {
            if (!(owned >> a & 1)) continue;
            for (int b = a + 1; b < lanes; ++b) {
                if (!(owned >> b & 1) || !query_->lists(kind_of(a, b))) continue;
                if (!query_->neighbours && shared.incident(a, b)) continue;
                if (inflated_boxes_overlap(box(record, a), box(record, b), query_->distance)) list(record, a, b);
            }
        }
        pass_on(worker);
    }
}

void CandidateLeaves::finish(Statistics& statistics) {
    for (const auto& worker : worker_) add(worker->statistics, statistics);
}

}  // namespace crumple::cpu
