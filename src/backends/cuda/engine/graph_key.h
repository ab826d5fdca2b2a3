#pragma once

// Key of the CUDA graph of a pass.

#include <algorithm>
#include <variant>

#include "backends/cuda/candidates/candidate_narrow.h"
#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/features/feature_input.h"
#include "backends/cuda/input/device_input.h"
#include "backends/cuda/intersections/intersection_narrow.h"
#include "backends/cuda/stages/plan.h"

namespace crumple::cuda {

/// Parameters of a query's own kernels. Each kind has operator== and forget_places(), which reduces addresses and
/// lengths to what the choice of kernels depends on.
using KernelParameters = std::variant<IntersectionParameters, FeatureParameters, CandidateParameters>;

/// Everything that the commands of a warm-started pass depend on: equal keys mean equal commands.
struct GraphKey {
    PreparedScene scene;
    PairSelection wanted;
    Plan plan;
    Input::Work input;
    KernelParameters parameters;
    const void *work = nullptr, *rows = nullptr, *warm_starts = nullptr, *counters = nullptr;
    friend bool operator==(const GraphKey&, const GraphKey&) = default;

    /// Returns the key reduced to what determines which kernels are launched: without the capacities of lists, and with
    /// addresses reduced by forget_place() or set to null.
    GraphKey shape() const {
        GraphKey shape = *this;
        for (VertexReader& reader : shape.scene.reader) forget_place(reader.data);
        forget_place(shape.scene.end.data);
        forget_place(shape.scene.corners);
        forget_place(shape.scene.groups);
        for (TriangleView& view : shape.input.triangles) forget_place(view.data);
        for (const void*& groups : shape.input.groups) forget_place(groups);
        for (const void*& list : shape.input.lists) forget_place(list);
        forget_place(shape.input.poses);
        forget_place(shape.wanted.groups.excluded);
        forget_place(shape.wanted.bodies.excluded);
        forget_place(shape.wanted.classes);
        std::visit([](auto& kernels) { kernels.forget_places(); }, shape.parameters);
        shape.input.known = {};
        shape.input.block = shape.work = shape.rows = shape.warm_starts = shape.counters = nullptr;
        shape.plan = {};
        shape.plan.worlds = plan.worlds;
        std::ranges::copy(plan.fan_out, shape.plan.fan_out);
        return shape;
    }
};

}  // namespace crumple::cuda
