// Room for a few values, of which some are constructed later.
#pragma once

#include <cstddef>
#include <type_traits>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Room for n values of a type that needs no destructor, none of which is constructed: a std::array would
/// construct all of them. The user constructs those that are needed, by new (&room[k]) T(...), and remembers
/// which.
template <class T, std::size_t n>
class Uninitialized {
 public:
  static_assert(std::is_trivially_destructible_v<T>);

  /// Returns the k-th value, or its place if it has not been constructed.
  [[nodiscard]] T& operator[](std::size_t k) { return reinterpret_cast<T*>(bytes_)[k]; }

 private:
  alignas(T) std::byte bytes_[n * sizeof(T)];
};

}  // namespace protostar::inline PROTOSTAR_ABI
