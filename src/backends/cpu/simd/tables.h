#pragma once

// Tables of kernels, one per instruction set, and their selection. The stages have such tables, and so does each kind
// of query.

#include <span>
#include <vector>

#include "crumple/error.h"
#include "crumple/options.h"
#include "hwy/targets.h"

namespace crumple::cpu {

/// Returns the Highway targets that this machine supports. Cached, since in a virtual machine the query takes some 10
/// us.
inline std::int64_t supported_targets() {
    static const std::int64_t targets = hwy::SupportedTargets();
    return targets;
}

/// Table of kernels that Highway has compiled for a target.
template <class Kernels>
struct Table {
    std::int64_t target;
    Simd simd;
    const Kernels* kernels;

    bool is_supported() const { return (supported_targets() & target) != 0; }
};

/// Returns the first table, in order of preference, that runs on this machine and suits `simd`, or the plain one.
/// Throws Error (backend_unavailable) if a particular instruction set is requested and unavailable.
template <class Kernels>
const Kernels& choose(std::span<const Table<Kernels>> tables, const Kernels& plain, Simd simd) {
    if (simd == Simd::scalar) return plain;
    for (const auto& table : tables)
        if (table.is_supported() && (simd == Simd::automatic || simd == table.simd)) return *table.kernels;
    if (simd == Simd::automatic) return plain;
    throw Error(ErrorCode::backend_unavailable,
                "the requested instruction set is not supported by this build or by this machine", Element::option);
}

/// Returns all tables that run on this machine, the plain one first.
template <class Kernels>
std::vector<const Kernels*> all_of(std::span<const Table<Kernels>> tables, const Kernels& plain) {
    std::vector<const Kernels*> all{&plain};
    for (const auto& table : tables)
        if (table.is_supported()) all.push_back(table.kernels);
    return all;
}

}  // namespace crumple::cpu
