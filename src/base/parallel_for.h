#pragma once

// How what comes before a backend borrows its threads.

#include <cstddef>

namespace crumple {

/// A reference to a function of one index; allocates nothing, and must not outlive the function.
class Task {
   public:
    template <class Function>
    Task(const Function& function)
        : function_(&function), call_([](const void* f, std::size_t i) { (*static_cast<const Function*>(f))(i); }) {}
    void operator()(std::size_t i) const { call_(function_, i); }

   private:
    const void* function_;
    void (*call_)(const void*, std::size_t);
};

/// Something that runs task(i) for i in [0, n), in any order and perhaps several at once. Tasks must not throw.
class ParallelFor {
   public:
    virtual ~ParallelFor() = default;
    virtual void parallel_for(std::size_t n, Task task) {
        for (std::size_t i = 0; i < n; ++i) task(i);
    }
};

}  // namespace crumple
