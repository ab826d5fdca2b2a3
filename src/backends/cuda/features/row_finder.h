#pragma once

// Base of searches for pairs of features by any criterion: input and result of each slot. Rows lie on the device, or on
// the host if they were found in chunks.

#include <array>
#include <optional>

#include "backends/cuda/engine/finder.h"
#include "backends/cuda/features/feature_input.h"
#include "backends/cuda/features/rows_by_kind.h"
#include "queries/device_result.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// State of one slot, for requests about features; a slot belongs to one launch (engine/finder.h).
struct RowSlot {
    explicit RowSlot(MemoryMeter& meter) : host(&meter) {}

    std::optional<FeatureRequest> request;  ///< refers to the caller's features, pair filter and arrays
    RestShape rest;                         ///< copy of the request's rest shape
    // Set when rows are accepted:
    ListEnds ends;
    bool any = false;
    FirstImpact first;
    FeatureResult host;  ///< lists of rows, if they were found in chunks
};

class RowFinder : public Finder {
   public:
    /// Make a slot current, drop its last rows, and bind the request: for a scene on the host, or for a mesh on the
    /// device with as many triangles, edges and points as the request's features were made from.
    void bring(std::size_t slot, const PreparedScene& scene, const FeatureRequest& request);
    void view(std::size_t slot, const Shape& shape, const FeatureRequest& request, Growth growth = Growth::grows);
    void copy_to(FeatureResult& result);
    /// Returns the rows on the device; uploads them if they lie on the host.
    AnyDeviceResult show();
    /// Returns the result of a replay that has not left the whole result, because a list was too short or the mesh has
    /// changed: no rows, and the number of hits that were counted.
    AnyDeviceResult show_incomplete() const;

    void release() override;

   protected:
    RowFinder(BackendState& state, Pass& pass, FeaturesOnDevice& features);

    /// Binds the request, except for its pair filter, to the scene of the input. `viewed`: true if the arrays of the
    /// request lie on the device.
    virtual void upload_request(const FeatureRequest& request, bool viewed, Growth growth) = 0;
    virtual RowsByKind& rows() = 0;

    RowSlot& found() { return found_[current()]; }
    const RowSlot& found() const { return found_[current()]; }
    const FeatureRequest& request() const { return *found().request; }
    /// Begins a result whose rows are found in chunks and collected on the host.
    void begin_on_host();

    bool is_any_output() const override { return request().extent == Extent::any; }
    void count_tests(const Counters& counters, Statistics& statistics) const override;
    void read_rows(unsigned long long total) override;

    FeaturesOnDevice& features_;

   private:
    void copy_from(const FeatureRequest& request);
    bool valued() const { return request().criterion != Criterion::candidate; }
    void upload();

    std::array<RowSlot, LaunchQueue::slots> found_;
};

}  // namespace crumple::cuda
