#pragma once

#include <vector>

#include "engine/cpu/kernels.h"
#include "engine/cpu/simd/simd.h"

namespace crumple::test {

/// The kernel tables of every instruction set that build and machine have.
inline std::vector<const cpu::Kernels*> kernel_tables() {
    std::vector<const cpu::Kernels*> tables = cpu::all_simd_kernels();
    tables.insert(tables.begin(), &cpu::scalar_kernels);
    return tables;
}

}  // namespace crumple::test
