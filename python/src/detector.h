#pragma once

// crumple::Detector for Python: the GIL released, calls from several threads one after another, results that belong to
// whoever holds them.

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <nanobind/nanobind.h>

#include "crumple/detector.h"
#include "result.h"

namespace crumple::python {

class SharedDetector {
   public:
    explicit SharedDetector(const Options& options) : detector_(options) {}

    /// `second` null: one soup. Call without the GIL.
    std::unique_ptr<Result> find(const MeshView& first, const MeshView* second, const Part* part, const Query& query);
    bool any(const MeshView& first, const MeshView* second, const Query& query);
    std::vector<Part> partition(const MeshView& first, const MeshView* second, int count);
    const Options& options() const { return detector_.options(); }

   private:
    const Collisions& search(const MeshView& first, const MeshView* second, const Part* part, const Query& query);

    std::mutex mutex_;
    Detector detector_;
    std::shared_ptr<Spare> spare_ = std::make_shared<Spare>();
};

void bind_detector(nanobind::module_& module);

}  // namespace crumple::python
