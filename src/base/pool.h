#pragma once

// Objects that own scratch memory, for tasks that run at once.

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace crumple {

/// Pool of objects. Each is used by one task at a time, and then by others. Tasks may call with() at the same time.
template <class T>
class Pool {
   public:
    /// Calls use(object) with an idle object, or with one that make() returns (std::unique_ptr) if none is idle. If use
    /// throws, the object is destroyed.
    template <class Make, class Use>
    void with(Make make, Use use) {
        std::unique_ptr<T> object = take();
        if (!object) object = make();
        use(*object);
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(object));
    }

    /// Destroys all idle objects. No task may call with() meanwhile.
    void clear() { idle_.clear(); }

   private:
    std::unique_ptr<T> take() {
        const std::lock_guard lock(mutex_);
        if (idle_.empty()) return nullptr;
        std::unique_ptr<T> object = std::move(idle_.back());
        idle_.pop_back();
        return object;
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<T>> idle_;
};

}  // namespace crumple
