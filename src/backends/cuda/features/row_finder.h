#pragma once

// One scene searched for pairs of features, whatever decides about them: input and result of each slot. Rows lie on the
// device, or on the host if they were found in chunks.

#include <array>
#include <optional>

#include "backends/cuda/engine/finder.h"
#include "backends/cuda/features/feature_input.h"
#include "backends/cuda/features/rows_by_kind.h"
#include "queries/device_answer.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// Per-slot state of requests about features.
struct RowSlot {
    explicit RowSlot(MemoryMeter& meter) : host(&meter) {}

    std::optional<FeatureRequest> request;  ///< scene, features and rule are the caller's
    RestShape rest;                         ///< the request's
    // Found when rows were accepted:
    ListEnds ends;
    bool any = false;
    FirstImpact first;
    FeatureResult host;  ///< the lists, if they were found in chunks
};

class RowFinder : public Finder {
   public:
    /// Works on a slot, whose last rows go, and brings the request: of a scene on the host, or of a mesh on the device
    /// whose counts are those of the features.
    void bring(std::size_t slot, const PreparedScene& scene, const FeatureRequest& request);
    void view(std::size_t slot, const Shape& shape, const FeatureRequest& request, Room room = Room::grows);
    void copy_to(FeatureResult& result);
    /// Where the rows lie on the device; brings them there if they do not.
    DeviceAnswer show();
    /// Result of an incomplete replay.
    DeviceAnswer show_incomplete() const;

    void release() override;

   protected:
    RowFinder(BackendState& state, Pass& pass, FeaturesOnDevice& features);

    /// Brings all of the request but its features, for the scene of the input. `viewed`: true if arrays lie on the
    /// device.
    virtual void bring_request(const FeatureRequest& request, bool viewed, Room room) = 0;
    virtual RowsByKind& rows() = 0;

    RowSlot& found() { return found_[current()]; }
    const RowSlot& found() const { return found_[current()]; }
    const FeatureRequest& request() const { return *found().request; }
    /// Begins a result that is found in chunks.
    void begin_on_host();

    bool wants_any() const override { return request().extent == Extent::any; }
    void count_tests(const Counters& counters, Statistics& statistics) const override;
    void read_rows(unsigned long long total) override;

    FeaturesOnDevice& features_;

   private:
    void adopt(const FeatureRequest& request);
    bool valued() const { return request().criterion != Criterion::candidate; }
    void upload();

    std::array<RowSlot, Flights::slots> found_;
};

}  // namespace crumple::cuda
