#pragma once

#include <cstddef>

// Limits of a launch on compute capability 9.0.
namespace cuda_on_cpu::limits {

inline constexpr int threads_per_block = 1024;
inline constexpr int block_x = 1024, block_y = 1024, block_z = 64;
inline constexpr int grid_x = 2147483647, grid_y = 65535, grid_z = 65535;
inline constexpr int threads_per_multiprocessor = 2048, blocks_per_multiprocessor = 32;
inline constexpr int registers = 65536;
inline constexpr std::size_t shared_bytes_per_block = 48 << 10;
/// Upper bound of the limit that cudaFuncSetAttribute may set.
inline constexpr std::size_t shared_bytes_per_block_optin = 227 << 10;
inline constexpr std::size_t shared_bytes_per_multiprocessor = 228 << 10;

}  // namespace cuda_on_cpu::limits
