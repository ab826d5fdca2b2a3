#pragma once

// The order of the stages: [MZ] Algorithm 1. The same for every question.

#include "backends/cpu/buffers.h"
#include "backends/cpu/leaf_question.h"
#include "backends/cpu/pair_range.h"
#include "backends/cpu/parallel.h"
#include "partition/levels.h"
#include "scene/rules.h"

namespace crumple::cpu {

/// What is asked, and who answers.
struct Call {
    const PreparedScene& scene;
    const GroupRule& rule;
    Levels levels;  ///< above the scene
    const Options& options;
    const StageKernels& kernels;
    Workers& workers;
    ParallelFor& parallel;  ///< the same workers, for the model
    Cancellation& cancellation;
    MemoryMeter& meter;
    Buffers& buffers;
    Statistics& statistics;
    LeafQuestion& question;

    bool frugal = false;               ///< one cluster after another, on one worker
    const PairRange* range = nullptr;  ///< only pairs of these ids; null: all
    Inflation inflation = {};          ///< of every triangle

    /// The normalised vertices, once they are there.
    PointRows points() const {
        return scene.float32 ? PointRows{buffers.points.f.data(), nullptr}
                             : PointRows{nullptr, buffers.points.d.data()};
    }
};

/// Stage `bounds`, once a call.
void measure(const Call& call);

/// From `subdivide` to `narrow`, on a scene that was measured. The question keeps what it finds.
void search(const Call& call);

}  // namespace crumple::cpu
