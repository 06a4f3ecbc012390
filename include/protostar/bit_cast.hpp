// std::bit_cast, also where the standard library does not have it yet (libc++ 13, as in Debian 12's
// emscripten).
#pragma once

#include <bit>
#include <cstring>
#include <type_traits>
#include <version>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

#if defined(__cpp_lib_bit_cast)
using std::bit_cast;
#else
/// Returns the value of type To that has the same bits.
template <class To, class From>
[[nodiscard]] To bit_cast(const From& from) {
  static_assert(sizeof(To) == sizeof(From) && std::is_trivially_copyable_v<To> &&
                std::is_trivially_copyable_v<From>);
  To to;
  std::memcpy(&to, &from, sizeof(To));
  return to;
}
#endif

}  // namespace protostar::inline PROTOSTAR_ABI::detail
