#pragma once

// Kernels of the played device, run by their PTX instead of by their C++.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cuda_on_cpu/machine/kernel.h"
#include "ptx/program.h"

namespace crumple::ptx {

/// The PTX in a file: the text itself, or what lies uncompressed in a fat binary.
std::string read_ptx(const std::string& path);

class Kernels {
   public:
    /// Takes from each file the kernels that have one of these words in their names.
    Kernels(const std::vector<std::string>& files, const std::vector<std::string>& words);

    /// Runs a launch as a grid of one thread, for which the kernel's loop goes over all items. False if there is no PTX
    /// of the kernel.
    bool run(const cuda_on_cpu::Kernel& launch);

    /// Mangled names of the kernels, and how often each was launched.
    std::map<std::string, int> launches;

   private:
    std::vector<std::unique_ptr<Program>> programs_;
    std::map<std::string, const Function*> functions_;  ///< by name as the host's compiler mangles it
    Thread thread_;
};

}  // namespace crumple::ptx
