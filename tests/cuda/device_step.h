#pragma once

// Moving mesh whose arrays are in device memory, and comparison of feature results in device memory with host results.

#include <gtest/gtest.h>

#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "candidates/compare_candidates.h"
#include "cuda/device_mesh.h"
#include "features/compare_features.h"
#include "features/moving_soups.h"

namespace crumple::test {

/// Array in device memory.
template <class T>
class DeviceArray {
   public:
    DeviceArray() = default;
    explicit DeviceArray(std::span<const T> host) : bytes_(bytes(host)), size_(host.size()) {}
    /// Replaces the contents; their number must not change.
    void set(std::span<const T> host) { bytes_.set(bytes(host)); }
    std::span<const T> span() const { return {static_cast<const T*>(bytes_.data()), size_}; }

   private:
    static std::vector<std::byte> bytes(std::span<const T> host) {
        std::vector<std::byte> out(host.size_bytes());
        if (!out.empty()) std::memcpy(out.data(), host.data(), out.size());
        return out;
    }
    DeviceBytes bytes_;
    std::size_t size_ = 0;
};

template <class Scalar>
class DeviceStep {
   public:
    explicit DeviceStep(const MovingSoup<Scalar>& soup)
        : mesh_(soup.view()), end_(std::span<const PointOf<Scalar>>(soup.end)), view_(mesh_.view()) {
        if (soup.edges) {
            edges_ = DeviceArray<Edge>(*soup.edges);
            view_.edges = edges_.span();
        }
        if (soup.points) {
            points_ = DeviceArray<std::int32_t>(*soup.points);
            view_.points = points_.span();
        }
    }
    MeshView view(cudaStream_t stream = nullptr) const {
        MeshView view = view_;
        view.stream = stream;
        return view;
    }
    VertexView end() const {
        const auto rows = static_cast<std::int64_t>(end_.span().size());
        return rows_of_three(rows == 0 ? nullptr : end_.span()[0].data(), rows);
    }
    /// Replaces all positions; the number of vertices must not change.
    void move(const MovingSoup<Scalar>& soup) {
        mesh_.set_vertices(soup.view());
        end_.set(soup.end);
    }

   private:
    DeviceMesh mesh_;
    DeviceArray<PointOf<Scalar>> end_;
    DeviceArray<Edge> edges_;
    DeviceArray<std::int32_t> points_;
    MeshView view_;
};

/// Compares an array on the device with the expected one.
template <class T>
testing::AssertionResult same_on_device(const T* found, const Array<T>& expected, const char* what) {
    const std::vector<T> host = to_host(found, static_cast<std::int64_t>(expected.size()));
    return std::equal(host.begin(), host.end(), expected.begin(), expected.end())
               ? testing::AssertionSuccess()
               : testing::AssertionFailure() << what << " differ";
}
inline testing::AssertionResult same_list(const DeviceImpactList& found, const ImpactList& expected) {
    auto same = same_on_device(found.toi, expected.toi, "times");
    return same ? same_on_device(found.start, expected.start, "starts") : same;
}
inline testing::AssertionResult same_list(const DeviceProximityList& found, const ProximityList& expected) {
    auto same = same_on_device(found.squared_distance, expected.squared_distance, "distances");
    return same ? same_on_device(found.touching, expected.touching, "touching") : same;
}
inline testing::AssertionResult same_list(const DeviceCandidateList&, const CandidateList&) {
    return testing::AssertionSuccess();
}

/// Compares counts, lists and edges on the device with the expected result. Edges are compared if the expected result
/// has any offsets of edges (first_edge).
template <class Found, class Result>
testing::AssertionResult shows_features(const Found& found, const Result& expected) {
    if (!found.complete) return testing::AssertionFailure() << "the answer is not complete";
    if (found.count != expected.count || found.rows_needed != expected.count)
        return testing::AssertionFailure() << found.count << " rows, not " << expected.count;
    if (expected.first_edge.size() > 1) {
        if (found.edge_count != static_cast<std::int64_t>(expected.edges.size()))
            return testing::AssertionFailure() << found.edge_count << " edges, not " << expected.edges.size();
        if (auto same = same_on_device(found.edges, expected.edges, "edges"); !same) return same;
    }
    for (std::size_t k = 0; k < expected.lists.size(); ++k) {
        const auto& list = expected.lists[k];
        if (found.lists[k].count != static_cast<std::int64_t>(list.pairs.size()))
            return testing::AssertionFailure() << "list " << k << ": " << found.lists[k].count << " rows";
        auto same = same_on_device(found.lists[k].pairs, list.pairs, "pairs");
        if (same) same = same_list(found.lists[k], list);
        if (!same) return same << " in list " << k;
    }
    return testing::AssertionSuccess();
}
inline testing::AssertionResult shows(const DeviceImpacts& found, const Impacts& expected) {
    if (found.any != expected.any) return testing::AssertionFailure() << "any: " << found.any;
    if (auto same = same_first(found.first, expected.first); !same) return same;
    return shows_features(found, expected);
}
inline testing::AssertionResult shows(const DeviceProximities& found, const Proximities& expected) {
    if (found.any != expected.any) return testing::AssertionFailure() << "any: " << found.any;
    return shows_features(found, expected);
}
inline testing::AssertionResult shows(const DeviceCandidates& found, const Candidates& expected) {
    return shows_features(found, expected);
}

}  // namespace crumple::test
