#pragma once

// What a search about features remembers of a launch, and what the launch's graph is known by (finder.h).

#include <algorithm>
#include <cstdint>

#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/input/device_input.h"
#include "backends/cuda/stages/plan.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// What a launch about features has for itself, since another one may be in flight.
struct FinderSlot {
    FinderSlot(const Device& device, cudaStream_t, MemoryMeter& meter, Input& given)
        : input(given), counters(device), room(meter) {}

    Input& input;
    Pinned<Counters> counters;
    Block room;                  ///< of the answer
    Plan plan;                   ///< of its pass
    std::uint64_t revision = 0;  ///< of the features it was given
    bool frugal = false;         ///< FeatureRequest::frugal
    bool on_host = false;        ///< the answer is there: it was found in chunks
    bool lost = true;            ///< there is no pass, or its answer had to go
    Statistics statistics;
};

/// What the keys of the graphs have in common: everything that the commands of a guided pass were made of. `Asked`:
/// what the kernels of the question are told.
template <class Asked, class Firsts>
struct FinderKey {
    PreparedScene scene;
    WantedPairs wanted;
    Plan plan;
    Input::Work input;
    Asked asked;
    VertexReader rest;  ///< where the caller has the shape at rest
    Firsts firsts;
    Extent extent;
    bool all_kinds;
    const void *work, *room, *guides, *counters;
    friend bool operator==(const FinderKey&, const FinderKey&) = default;

    /// The same without places and lengths of lists. Which kernels there are follows from it.
    FinderKey shape() const {
        FinderKey shape = *this;
        forget_place(shape.scene.reader[0].data);
        forget_place(shape.scene.end.data);
        forget_place(shape.rest.data);
        forget_place(shape.scene.corners);
        forget_place(shape.scene.groups);
        forget_place(shape.input.triangles[0].data);
        for (const void*& of : shape.input.lists) forget_place(of);
        forget_place(shape.wanted.groups.excluded);
        shape.asked.forget_places();
        shape.input.known = {};
        shape.input.block = shape.work = shape.room = shape.guides = shape.counters = nullptr;
        shape.firsts = {};
        shape.plan = {};
        std::ranges::copy(plan.fan_out, shape.plan.fan_out);
        return shape;
    }
};

}  // namespace crumple::cuda
