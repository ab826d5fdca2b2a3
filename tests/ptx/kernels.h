#pragma once

// Runs kernels of the emulated device from the PTX that nvcc has generated instead of from their C++.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cuda_on_cpu/machine/kernel.h"
#include "ptx/program.h"

namespace crumple::ptx {

/// Returns the PTX in a file: the text itself, or the uncompressed PTX of a fat binary.
std::string read_ptx(const std::string& path);

class Kernels {
   public:
    /// Loads from each file the kernels whose names contain one of `words`.
    Kernels(const std::vector<std::string>& files, const std::vector<std::string>& words);

    /// Runs a launch as a grid of one thread, so that the kernel's loop visits every item. Returns false if the
    /// kernel's PTX was not loaded.
    bool run(const cuda_on_cpu::Kernel& launch);

    /// Number of launches of each kernel, by its name as the host's compiler mangles it.
    std::map<std::string, int> launches;

   private:
    std::vector<std::unique_ptr<Program>> programs_;
    std::map<std::string, const Function*> functions_;  ///< decoded kernels, by the same names as `launches`
    Thread thread_;
};

}  // namespace crumple::ptx
