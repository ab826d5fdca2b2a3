#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace crumple {

template <class Signature>
class FunctionRef;

/// Non-owning reference to a callable, to be used only during the call that it is passed to. Two pointers, no
/// allocation.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
   public:
    /// Refers to `function`, which must outlive this reference.
    template <class Function, class = std::enable_if_t<!std::is_same_v<std::remove_cvref_t<Function>, FunctionRef> &&
                                                       std::is_object_v<std::remove_reference_t<Function>> &&
                                                       std::is_invocable_r_v<Result, Function&, Arguments...>>>
    FunctionRef(Function&& function)
        : function_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
          call_([](void* f, Arguments... arguments) -> Result {
              return (*static_cast<std::remove_reference_t<Function>*>(f))(std::forward<Arguments>(arguments)...);
          }) {}

    /// Calls the function.
    Result operator()(Arguments... arguments) const { return call_(function_, std::forward<Arguments>(arguments)...); }

   private:
    void* function_;
    Result (*call_)(void*, Arguments...);
};

}  // namespace crumple
