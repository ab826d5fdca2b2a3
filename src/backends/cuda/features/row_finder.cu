#include "backends/cuda/features/row_finder.h"

namespace crumple::cuda {

RowFinder::RowFinder(BackendState& state, Pass& pass, FeaturesOnDevice& features)
    : Finder(state, pass), features_(features), found_{RowSlot(meter_), RowSlot(meter_)} {}

void RowFinder::release() {
    Finder::release();
    for (RowSlot& slot : found_) slot.host = FeatureResult(&meter_);
}

void RowFinder::bring(std::size_t to, const PreparedScene& scene, const FeatureRequest& request) {
    claim_slot(to, [&] {
        input().bring(scene);
        input().want(request.rule);
        upload_request(request, false, Growth::grows);
    });
    copy_from(request);
}

void RowFinder::view(std::size_t to, const Shape& shape, const FeatureRequest& request, Growth growth) {
    claim_slot(to, [&] {
        features_.bring(request.features, shape.vertices.rows, growth);
        input().view(shape, features_.known(), growth);
        input().want(request.rule, growth);
        upload_request(request, true, growth);
    });
    copy_from(request);
}

// Stores what is needed of the request when its result is accepted, and binds the slot.
void RowFinder::copy_from(const FeatureRequest& request) {
    RowSlot& found = this->found();
    found.request.emplace(request);
    if (request.rest) {
        found.rest = *request.rest;
        found.request->rest = &found.rest;
    }
    slot().low_memory = request.low_memory;
    slot().revision = request.features.revision();
    bind();
}

void RowFinder::count_tests(const Counters& c, Statistics& s) const {
    s.edge_tests += static_cast<std::int64_t>(c.listed);
    for (const unsigned long long tests : c.tests) {
        s.double_tests += static_cast<std::int64_t>(tests);
        s.exact_tests += static_cast<std::int64_t>(tests);
    }
}

void RowFinder::read_rows(unsigned long long total) {
    RowSlot& found = this->found();
    found.any = total > 0;
    found.first = {};
    found.ends = {};
    if (request().extent == Extent::all) found.ends.read(stream_, rows());
}

void RowFinder::copy_to(FeatureResult& result) {
    RowSlot& found = this->found();
    if (slot().on_host) {
        result = std::move(found.host);
        found.host = FeatureResult(&meter_);
        slot().lost = true;
    } else {
        for (std::size_t k = 0; k < candidate_kinds; ++k) {
            const std::size_t begin = found.ends.begin(k), count = found.ends.count(k);
            const auto copy = [&](auto& array, const auto* device) {
                copy_now(stream_, array.resize_discard(count), device + begin, count, cudaMemcpyDeviceToHost);
            };
            if (count == 0) continue;
            copy(result.rows.lists[k].pairs, rows().pairs);
            if (!valued()) continue;
            copy(result.rows.lists[k].value, rows().value);
            copy(result.rows.lists[k].flag, rows().flag);
        }
    }
    result.any = found.any;
    result.first = found.first;
    result.statistics = statistics();
}

void RowFinder::begin_on_host() {
    slot().on_host = true;
    found().host.clear();
    found().any = false;
    found().first = {};
}

// Uploads lists that were found in chunks to where a single pass would have left them.
void RowFinder::upload() {
    RowSlot& found = this->found();
    found.ends = {};
    for (std::size_t k = 0; k < candidate_kinds; ++k) found.ends.append(k, found.host.rows.lists[k].size());
    place_arrays(slot().rows, [&](ArenaLayout& c) { rows().place_row_lists(c, found.ends.all(), valued()); });
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        const auto& host = found.host.rows.lists[k];
        const auto copy = [&](auto* device, const auto& array) {
            copy_now(stream_, device + found.ends.begin(k), array.data(), array.size(), cudaMemcpyHostToDevice);
        };
        if (host.size() == 0) continue;
        copy(rows().pairs, host.pairs);
        if (!valued()) continue;
        copy(rows().value, host.value);
        copy(rows().flag, host.flag);
    }
    found.host = FeatureResult(&meter_);
    slot().on_host = false;
}

AnyDeviceResult RowFinder::show() {
    if (slot().on_host) upload();
    const RowSlot& found = this->found();
    AnyDeviceResult shown;
    shown.rows_needed = shown.count = static_cast<std::int64_t>(found.ends.all());
    shown.edges = features_.known().edges;
    shown.edge_count = features_.known().edge_count;
    shown.statistics = statistics();
    shown.any = found.any;
    shown.first = found.first;
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        const std::size_t begin = found.ends.begin(k), count = found.ends.count(k);
        if (count == 0) continue;
        DeviceRows& list = shown.rows[k];
        list = {static_cast<std::int64_t>(count), rows().pairs + begin};
        if (valued()) list.value = rows().value + begin, list.flag = rows().flag + begin;
    }
    return shown;
}

AnyDeviceResult RowFinder::show_incomplete() const {
    const Counters& counters = *slot().counters;
    AnyDeviceResult shown;
    shown.complete = false;
    shown.rows_needed = static_cast<std::int64_t>(counters.hits);
    shown.statistics.backend = "cuda";
    return shown;
}

}  // namespace crumple::cuda
