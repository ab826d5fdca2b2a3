#pragma once

#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/intersections/intersection_kernels.h"
#include "backends/cpu/stages/kernels.h"

namespace crumple::test {

/// Tables of kernels of one instruction set.
struct Tables {
    const char* name;
    const cpu::StageKernels& stages;
    const cpu::IntersectKernels& intersect;
    const cpu::FeatureTables& features;
};

/// Returns the tables of every instruction set that the build and the machine have.
inline std::vector<Tables> kernel_tables() {
    const auto stages = cpu::all_stage_kernels();
    const auto intersect = cpu::all_intersect_kernels();
    const auto features = cpu::all_feature_kernels();
    std::vector<Tables> tables;
    for (std::size_t i = 0; i < stages.size(); ++i)
        tables.push_back({stages[i]->name, *stages[i], *intersect[i], *features[i]});
    return tables;
}

}  // namespace crumple::test
