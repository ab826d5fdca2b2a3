#include "distributed/overlaps/overlap_messages.h"

#include <algorithm>
#include <cstring>

#include "base/memory_claim.h"
#include "distributed/transport/exchange_lists.h"
#include "results/overlap_arrays.h"
#include "results/overlap_output.h"
#include "results/overlap_rows.h"

namespace crumple::distribute {

// The message has the number of elements of each array, and the elements. It is empty for a result without rows.
std::vector<std::byte> packed_rows(const Overlaps& rows) {
    std::vector<std::byte> message;
    if (rows.bodies.empty()) return message;
    const auto append = [&](const void* from, std::size_t bytes) {
        const auto* first = static_cast<const std::byte*>(from);
        message.insert(message.end(), first, first + bytes);
    };
    for_each_overlap_array([&](const char*, auto array, OverlapLevel) {
        const auto& list = rows.*array;
        const std::size_t size = list.size();
        append(&size, sizeof size);
        append(list.data(), size * sizeof list[0]);
    });
    return message;
}

Overlaps unpacked_rows(std::span<const std::byte> message) {
    Overlaps rows;
    if (message.empty()) return rows;
    const auto take = [&](void* to, std::size_t bytes) {
        if (bytes > 0) std::memcpy(to, message.data(), bytes);
        message = message.subspan(bytes);
    };
    for_each_overlap_array([&](const char*, auto array, OverlapLevel) {
        auto& list = rows.*array;
        std::size_t size = 0;
        take(&size, sizeof size);
        list.resize_discard(size);
        take(list.data(), size * sizeof list[0]);
    });
    return rows;
}

OverlapMessages::OverlapMessages(int ranks, MemoryMeter& meter) : meter_(meter) {
    for_rank_.reserve(static_cast<std::size_t>(ranks));
    for (int r = 0; r < ranks; ++r) for_rank_.push_back(metered_overlaps(&meter));
}

void OverlapMessages::exchange(MessageBatches& batches, CollectiveCheck& agree, Overlaps& result) {
    std::vector<std::vector<std::byte>> leaving;
    MemoryClaim memory_of_leaving(meter_), memory_of_coming(meter_);
    agree(Phase::rows, [&] {
        leaving.resize(for_rank_.size());
        for (std::size_t r = 0; r < leaving.size(); ++r) {
            leaving[r] = packed_rows(for_rank_[r]);
            memory_of_leaving.add(bytes_of(leaving[r]));
            for_rank_[r] = {};
        }
    });
    const Traffic traffic = traffic_of(batches, [&](std::size_t r) { return leaving[r].size(); });
    std::vector<std::byte> coming;
    agree(Phase::rows, [&] {
        memory_of_coming.add(all(traffic.in));
        coming.resize(all(traffic.in));
    });
    exchange_lists(
        batches, traffic, [&](std::size_t r) -> auto& { return leaving[r]; }, coming);
    leaving = {};
    memory_of_leaving.release();
    agree(Phase::output, [&] {
        memory_of_coming.add(all(traffic.in));  // for the unpacked rows
        const std::vector<std::int64_t> first = first_of_each(traffic.in);
        std::vector<Overlaps> rows;
        for (std::size_t r = 0; r < traffic.in.size(); ++r)
            rows.push_back(unpacked_rows(std::span(coming).subspan(static_cast<std::size_t>(first[r]),
                                                                   static_cast<std::size_t>(traffic.in[r]))));
        merge_rows(rows, result);
    });
}

void merge_rows(std::span<const Overlaps> results, Overlaps& merged) {
    struct Place {
        BodyPair bodies;
        std::size_t result, row;
    };
    std::vector<Place> places;
    for (std::size_t r = 0; r < results.size(); ++r)
        for (std::size_t i = 0; i < results[r].bodies.size(); ++i) places.push_back({results[r].bodies[i], r, i});
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.bodies < b.bodies; });
    for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
        const auto [bodies, result, row] = places[begin];
        end = begin + 1;
        while (end < places.size() && places[end].result == result && places[end].row == row + (end - begin)) ++end;
        append_rows(results[result], row, row + (end - begin), merged);
    }
    merged.any = merged.any || !merged.bodies.empty();
    merged.count = static_cast<std::int64_t>(merged.bodies.size());
}

}  // namespace crumple::distribute
