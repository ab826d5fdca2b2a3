#pragma once

// The answer on its way out: a Collisions that Python owns, shown as NumPy arrays without a copy.

#include <memory>
#include <mutex>
#include <utility>

#include <nanobind/nanobind.h>

#include "crumple/collisions.h"

namespace crumple::python {

/// Storage of a dropped result, waiting for the next call of the detector that made it. Results are dropped by any
/// thread. So frames of a simulation go back and forth between two results and allocate nothing.
class Spare {
   public:
    /// Storage for an answer. It comes back when the last who looks at it lets go, unless `spare` is gone by then.
    static std::shared_ptr<Collisions> take(const std::shared_ptr<Spare>& spare) {
        std::unique_ptr<Collisions> storage = spare->exchange(nullptr);
        if (!storage) storage = std::make_unique<Collisions>();
        return {storage.release(), [place = std::weak_ptr(spare)](Collisions* dropped) {
                    std::unique_ptr<Collisions> back(dropped);
                    if (const auto origin = place.lock()) origin->exchange(std::move(back));
                }};
    }

   private:
    std::unique_ptr<Collisions> exchange(std::unique_ptr<Collisions> storage) {
        const std::lock_guard lock(mutex_);
        return std::exchange(storage_, std::move(storage));
    }

    std::mutex mutex_;
    std::unique_ptr<Collisions> storage_;
};

/// What lies under a crumple.Result, which is a Python subclass of it: one object, for each more that is made after a
/// search has swept the caches costs microseconds. Arrays own the storage and not the result, which keeps them.
struct Result {
    std::shared_ptr<Collisions> storage;
    nanobind::object first, second;  ///< the meshes, tuples of three; second is None for one soup
    bool has_contacts = false, copy = false;

    const Collisions& collisions() const { return *storage; }
};

/// A new crumple.Result.
nanobind::object make_result(Result&& result);

void bind_result(nanobind::module_& module);

}  // namespace crumple::python
