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

/// A Collisions that lives as long as somebody looks at it.
struct Storage {
    Collisions collisions;
    std::weak_ptr<Spare> spare;

    Storage(Collisions&& c, const std::shared_ptr<Spare>& s) : collisions(std::move(c)), spare(s) {}
    Storage(const Storage&) = delete;
    Storage& operator=(const Storage&) = delete;
    ~Storage() {
        if (const auto place = spare.lock()) place->put(std::move(collisions));
    }
};

/// What lies under a crumple.Result, which is a Python subclass of it: one object, for each more that is made after a
/// search has swept the caches costs microseconds. Arrays own the storage and not the result, which keeps them.
struct Result {
    std::shared_ptr<Storage> storage;
    nanobind::object first, second;  ///< the meshes, tuples of three; second is None for one soup
    bool has_contacts = false, copy = false;

    const Collisions& collisions() const { return storage->collisions; }
};

/// A new crumple.Result.
nanobind::object make_result(Result&& result);

void bind_result(nanobind::module_& module);

}  // namespace crumple::python
