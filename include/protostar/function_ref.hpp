// Reference to a function object of any type, for parameters of functions that are no templates.
#pragma once

#include <concepts>
#include <type_traits>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

template <class>
class FunctionRef;

/// Refers to a function object, such as a lambda, which has to live as long and is called as a constant. A
/// std::function would hold a copy of it, and takes a compiler ten functions for each type instead of one.
template <class R, class... Arguments>
class FunctionRef<R(Arguments...)> {
 public:
  template <class F>
  requires(!std::same_as<F, FunctionRef> && std::is_invocable_r_v<R, const F&, Arguments...>)
      FunctionRef(const F& function)
      : function_(&function), call_(&call<F>) {}

  R operator()(Arguments... arguments) const {
    return call_(function_, static_cast<Arguments>(arguments)...);
  }

 private:
  template <class F>
  static R call(const void* object, Arguments... arguments) {
    return (*static_cast<const F*>(object))(static_cast<Arguments>(arguments)...);
  }

  const void* function_;
  R (*call_)(const void*, Arguments...);
};

}  // namespace protostar::inline PROTOSTAR_ABI
