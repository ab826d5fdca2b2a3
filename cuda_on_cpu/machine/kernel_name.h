#pragma once

#include <string>

namespace cuda_on_cpu {

/// Returns the name of a kernel of this executable, without namespaces, template arguments and parameters; its address
/// if the executable has no symbol for it. Reads the executable's table of symbols, because dladdr() does not find
/// functions of anonymous namespaces.
std::string kernel_name(const void* function);

}  // namespace cuda_on_cpu
