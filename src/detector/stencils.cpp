// The public functions of crumple/stencils.h: check options, and make rows on threads.

#include "crumple/stencils.h"

#include <cmath>

#include "backends/cpu/parallel.h"
#include "base/cancellation.h"
#include "base/float_environment.h"
#include "queries/checks.h"
#include "results/stencil_rows.h"

namespace crumple {
namespace {

/// Threads of one call.
class StencilThreads final : public ParallelFor {
   public:
    explicit StencilThreads(const Options& options) : workers_(options, cancellation_) { cancellation_.begin({}); }
    void parallel_for(std::size_t n, Task task) override {
        workers_.run([&] { workers_.parallel_for(n, [&](std::size_t i, std::size_t) { task(i); }); });
    }

   private:
    Cancellation cancellation_;
    cpu::Workers workers_;
};

template <class Result>
Stencils checked_stencils(const Scene& scene, const Result& found, const StencilOptions& options, bool needs_end) {
    const FloatEnvironment environment;
    Options threads;
    threads.threads = found.count <= 512 ? 1 : options.threads;
    check_options({.threads = options.threads});
    check(std::isfinite(options.parallel) && options.parallel >= 0, "parallel must be finite and 0 or more");
    const StencilScene prepared(scene, options, needs_end);
    StencilThreads workers(threads);
    return make_stencils(prepared, found, options, workers);
}

}  // namespace

Stencils stencils(const Scene& scene, const Proximities& found, const StencilOptions& options) {
    return checked_stencils(scene, found, options, false);
}
Stencils stencils(const Scene& scene, const Impacts& found, const StencilOptions& options) {
    return checked_stencils(scene, found, options, true);
}

}  // namespace crumple
