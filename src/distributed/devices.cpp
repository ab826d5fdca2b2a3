#include "distributed/devices.h"

#include <algorithm>
#include <array>
#include <exception>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>

#include "distributed/transport/merge_runs.h"
#include "results/intersection_output.h"

namespace crumple::distribute {
namespace {

Options of_one_device(const Options& options, std::size_t which) {
    Options own = options;
    own.backend = Backend::cuda;
    own.device = options.devices[which];
    own.devices = {};
    return own;
}

/// Returns the error without its rank, which is an internal detail. Device errors name the device instead.
Error without_rank(const Error& error, const std::vector<int>& devices) {
    std::string message = error.what();
    if (error.code == ErrorCode::device && error.rank >= 0)
        message = "device " + std::to_string(devices[static_cast<std::size_t>(error.rank)]) + ": " + message;
    return Error(error.code, message, error.element, error.index, error.bytes_needed, error.system_error);
}

/// Rethrows the first error that is not merely a consequence of another rank's failure (ErrorCode::communication).
[[noreturn]] void rethrow_cause(const std::vector<std::exception_ptr>& failed, const std::vector<int>& devices) {
    std::optional<Error> left_alone;
    for (const std::exception_ptr& one : failed) {
        if (!one) continue;
        try {
            std::rethrow_exception(one);
        } catch (const Error& error) {
            if (error.code != ErrorCode::communication) throw without_rank(error, devices);
            left_alone = error;
        }
    }
    throw Error(*left_alone);
}

template <class T>
void append(Array<T>& all, const Array<T>& some) {
    const std::size_t before = all.size();
    all.resize(before + some.size());
    std::copy(some.begin(), some.end(), all.begin() + before);
}

// Appends the rows of one rank; call in the order of the ranks. Blocks of triangles are in this order, so their rows
// are, too.
void append(Intersections& all, const DistributedIntersections& rows, bool contacts) {
    append(all.pairs, rows.pairs);
    add_pass(rows.statistics.search, all.statistics);
    if (!contacts) return;
    append(all.contacts.kinds, rows.contacts.kinds);
    const auto points = static_cast<std::int64_t>(all.contacts.points.size());
    for (std::size_t i = 1; i < rows.contacts.offsets.size(); ++i)
        all.contacts.offsets.push_back(points + rows.contacts.offsets[i]);
    append(all.contacts.points, rows.contacts.points);
}

PairFilter filter_of_groups(const GroupSelection& groups) {
    PairFilter rules;
    rules.groups = groups.between ? PairScope::between : groups.within ? PairScope::within : PairScope::both;
    for (std::int64_t i = 0; i < groups.excluded_count; ++i) {
        const std::uint64_t key = groups.excluded[i];
        rules.excluded_groups.push_back({static_cast<std::int32_t>(key >> 32), static_cast<std::int32_t>(key)});
    }
    return rules;
}

ImpactQuery motion_of(const FeatureRequest& request) {
    constexpr std::array wants{Output::any, Output::first, Output::pairs};
    ImpactQuery query;
    query.output = wants[static_cast<std::size_t>(request.extent)];
    query.min_distance = request.distance, query.min_distance_share = request.share;
    query.approaching_only = request.approaching_only;
    query.filter = filter_of_groups(request.rule.of_groups());
    return query;
}

ProximityQuery near_of(const FeatureRequest& request) {
    ProximityQuery query;
    query.output = request.extent == Extent::all ? Output::pairs : Output::any;
    query.radius = request.distance, query.strict = request.strict;
    query.filter = filter_of_groups(request.rule.of_groups());
    return query;
}

const Array<double>& values_of(const ImpactList& list) { return list.toi; }
const Array<double>& values_of(const ProximityList& list) { return list.squared_distance; }
const Array<std::uint8_t>& flags_of(const ImpactList& list) { return list.start; }
const Array<std::uint8_t>& flags_of(const ProximityList& list) { return list.touching; }

// Merges the lists of one kind from all ranks into sorted rows.
template <class Found>
void merge(const std::vector<const Found*>& of_ranks, std::size_t kind, FeatureRows& rows) {
    std::vector<FeatureHit> hits;
    for (const Found* found : of_ranks) {
        const auto& list = found->lists[kind];
        for (std::size_t i = 0; i < list.pairs.size(); ++i)
            hits.push_back({list.pairs[i], values_of(list)[i], flags_of(list)[i]});
    }
    merge_runs(hits, [](const FeatureHit& hit) { return hit.pair; });
    rows.resize_discard(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) rows.set(i, hits[i]);
}

}  // namespace

Devices::Rank::Rank(std::shared_ptr<Hub> hub, int rank, const Options& options)
    : transport(std::move(hub), rank), detector(transport, {.detector = options}), block(rank, transport.size()) {}

void Devices::Rank::set_poll(Cancellation& cancellation) {
    detector.set_poll([&cancellation] { cancellation.check(); });
    detector.set_hook([&cancellation](Phase) { cancellation.check(); });
}

Devices::Devices(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
    : ForwardingBackend(make_cuda_backend(of_one_device(options, 0), meter, cancellation)),
      options_(options),
      cancellation_(cancellation) {
    make_ranks();
}

void Devices::release() {
    ranks_.clear();
    ForwardingBackend::release();
}

// True if all devices share the search: for queries about a whole single mesh, without a memory limit. Such a limit
// applies to everything that the detector owns, and a search on one device needs less.
bool Devices::is_for_all(const PreparedScene& scene) const {
    return options_.memory_limit == 0 && !scene.between && !scene.bodies && !scene.first_of_world;
}

bool Devices::is_for_all(const PreparedScene& scene, const FeatureRequest& query) const {
    const SceneFeatures& features = query.features;
    return is_for_all(scene) && query.criterion != Criterion::candidate && !query.part && !query.rings && !query.rest &&
           query.radii.empty() && !features.lists_edges() && !features.lists_points() && features.plain() &&
           !features.is_welded();
}

void Devices::make_ranks() {
    const std::size_t n = options_.devices.size();
    hub_ = std::make_shared<Hub>(static_cast<int>(n));
    ranks_.resize(n);
    // Constructing a RankDetector is collective, since ranks check their options together.
    on_each({});
}

void Devices::on_each(const std::function<void(Rank&)>& work) {
    if (work && ranks_.empty()) make_ranks();
    std::vector<std::exception_ptr> failed(ranks_.size());
    const auto run = [&](std::size_t r) {
        try {
            if (!ranks_[r]) {
                ranks_[r] = std::make_unique<Rank>(hub_, static_cast<int>(r), of_one_device(options_, r));
                if (r == 0) ranks_[r]->set_poll(cancellation_);
            }
            if (work) work(*ranks_[r]);
        } catch (...) {
            failed[r] = std::current_exception();
            hub_->leave();
        }
    };
    {
        std::vector<std::jthread> others;
        try {
            for (std::size_t r = 1; r < ranks_.size(); ++r) others.emplace_back(run, r);
        } catch (...) {
            failed[0] = std::current_exception();
            hub_->leave();
        }
        if (!failed[0]) run(0);
    }
    if (std::all_of(failed.begin(), failed.end(), [](const auto& error) { return !error; })) return;
    ranks_.clear();
    rethrow_cause(failed, options_.devices);
}

void Devices::find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
                   Intersections& result) {
    if (part || !is_for_all(scene)) return ForwardingBackend::find(scene, query, part, result);
    IntersectionQuery welded = query;
    welded.weld = false;  // the corners of the scene are welded already
    std::vector<const DistributedIntersections*> rows(options_.devices.size());
    on_each([&](Rank& rank) {
        rows[static_cast<std::size_t>(rank.transport.rank())] = &rank.detector.find(rank.block.take(scene), welded);
    });
    result.pairs.clear();
    result.contacts.kinds.clear();
    result.contacts.offsets.clear();
    result.contacts.points.clear();
    if (query.contacts()) result.contacts.offsets.push_back(0);
    for (const DistributedIntersections* some : rows) append(result, *some, query.contacts());
    index_pairs(scene, result);
}

bool Devices::any(const PreparedScene& scene, const IntersectionQuery& query) {
    if (!is_for_all(scene)) return ForwardingBackend::any(scene, query);
    IntersectionQuery welded = query;
    welded.weld = false;
    welded.output = Output::any;
    bool found = false;
    on_each([&](Rank& rank) {
        const bool any = rank.detector.find(rank.block.take(scene), welded).any;
        if (rank.transport.rank() == 0) found = any;
    });
    return found;
}

// Runs find(rank, local) on each rank and merges the results. Returns the result of rank 0.
template <class Find>
const auto& Devices::find_on_devices(const PreparedScene& scene, FeatureResult& result, bool listed, Find find) {
    using Found = std::remove_cvref_t<std::invoke_result_t<Find, Rank&, const LocalMesh&>>;
    std::vector<const Found*> found(options_.devices.size());
    on_each([&](Rank& rank) {
        found[static_cast<std::size_t>(rank.transport.rank())] = &find(rank, rank.block.take(scene));
    });
    result.clear();
    for (const Found* some : found) add_pass(some->statistics.search, result.statistics);
    result.any = found[0]->any;
    for (std::size_t k = 0; listed && k < feature_kinds; ++k) merge(found, k, result.rows[static_cast<FeatureKind>(k)]);
    return *found[0];
}

void Devices::find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) {
    if (!is_for_all(scene, request)) return ForwardingBackend::find(scene, request, result);
    const bool listed = request.extent == Extent::all;
    if (request.criterion == Criterion::impact) {
        const ImpactQuery query = motion_of(request);
        result.first = find_on_devices(
                           scene, result, listed,
                           [&](Rank & rank, const LocalMesh& local) -> auto& {
                               LocalMesh moving = local;
                               moving.mesh.end = rank.block.end();
                               return rank.detector.find(moving, query);
                           })
                           .first;
    } else {
        const ProximityQuery query = near_of(request);
        find_on_devices(
            scene, result,
            listed, [&](Rank & rank, const LocalMesh& local) -> auto& { return rank.detector.find(local, query); });
    }
}

}  // namespace crumple::distribute

namespace crumple {

std::unique_ptr<BackendBase> make_devices_backend(const Options& options, MemoryMeter& meter,
                                                  Cancellation& cancellation) {
    return std::make_unique<distribute::Devices>(options, meter, cancellation);
}

}  // namespace crumple
