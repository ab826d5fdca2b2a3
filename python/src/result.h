#pragma once

// The answer on its way out: a Collisions that Python owns, shown as NumPy arrays without a copy.

#include <memory>
#include <mutex>

#include <nanobind/nanobind.h>

#include "crumple/collisions.h"

namespace crumple::python {

/// Storage of a dropped result, waiting for the next call of the detector that made it. Results are dropped by any
/// thread. So frames of a simulation go back and forth between two results and allocate nothing.
class Spare {
   public:
    void put(Collisions&& storage) {
        const std::lock_guard lock(mutex_);
        std::swap(storage_, storage);
    }
    Collisions take() {
        const std::lock_guard lock(mutex_);
        return std::move(storage_);
    }

   private:
    std::mutex mutex_;
    Collisions storage_;
};

struct Result {
    Collisions collisions;
    std::weak_ptr<Spare> spare;

    explicit Result(const std::shared_ptr<Spare>& s) : spare(s) {}
    ~Result() {
        if (const auto place = spare.lock()) place->put(std::move(collisions));
    }
};

void bind_result(nanobind::module_& module);

}  // namespace crumple::python
