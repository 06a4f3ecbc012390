// Prefetches data: asks memory for what will be read or written soon.
#pragma once

#include <cstddef>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Time at which prefetched data is read: soon, or after much else. If later, it waits in the second-level
/// cache; only few lines can be on their way into the first level at a time, and with more of them the
/// processor presumably waits.
enum class Read { soon, later };

/// Prefetches an address that will be read.
///
/// Without the empty asm g++ takes a function that does nothing but prefetch for one without effect, and may
/// never call it.
template <Read read = Read::soon>
void prefetch([[maybe_unused]] const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address, 0, read == Read::soon ? 3 : 2);
  asm volatile("");
#endif
}

/// Prefetches an address that will be written.
inline void prefetch_to_write([[maybe_unused]] const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address, 1, 3);
  asm volatile("");
#endif
}

/// Prefetches an object, in all its lines of the cache.
template <class T>
void prefetch_whole(const T& object) {
  const auto* const bytes = reinterpret_cast<const char*>(&object);
  for (std::size_t i = 0; i < sizeof(T); i += 64) prefetch(bytes + i);
  prefetch(bytes + sizeof(T) - 1);
}

/// Prefetches the start of an object, as many bytes as a line of the cache has, though they may be in two.
template <class T>
void prefetch_start(const T& object) {
  const auto* const bytes = reinterpret_cast<const char*>(&object);
  prefetch(bytes), prefetch(bytes + (sizeof(T) < 64 ? sizeof(T) : 64) - 1);
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd
