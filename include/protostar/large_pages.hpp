// Allocates memory in large pages, for large data that is read all over, as trees are, or that is new, as
// images are.
//
// A processor remembers where a few thousand pages of memory are. With pages of 4 KB these are a few
// megabytes, and a ray that reads outside of them waits for the address of the page before it waits for the
// data. A page that is written for the first time also costs a call of the system, which takes longer than
// its pixels. Linux has pages of 2 MB as well, and gives them on request.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

inline constexpr std::size_t large_page = std::size_t{1} << 21, cache_line = 64;  ///< in bytes

/// Returns the alignment of a block that is not a scalar one.
[[nodiscard]] inline std::align_val_t block_alignment(std::size_t bytes, std::size_t alignment) {
  if (bytes >= large_page) return std::align_val_t{large_page};
  return std::align_val_t{alignment < cache_line ? cache_line : alignment};
}

/// Returns true if a block is aligned as any scalar is.
[[nodiscard]] inline bool is_scalar_block(std::size_t bytes, std::size_t alignment) {
  return bytes <= 256 && alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__;
}

/// Returns new memory for elements of some alignment, in large pages if it fills at least one. The last page
/// is then a whole one, so that it is large too. A few bytes are aligned as any scalar is if that is enough,
/// since a cache line takes twice the time.
[[nodiscard]] inline void* allocate_pages(std::size_t bytes, std::size_t alignment) {
  if (bytes < large_page)
    return is_scalar_block(bytes, alignment) ? ::operator new(bytes)
                                             : ::operator new(bytes, block_alignment(bytes, alignment));
  bytes = (bytes + large_page - 1) / large_page * large_page;
  void* const memory = ::operator new(bytes, block_alignment(bytes, alignment));
#if defined(MADV_HUGEPAGE)
  madvise(memory, bytes, MADV_HUGEPAGE);  // if this fails, pages are small
#endif
  return memory;
}

/// Frees a block that allocate_pages returned for this number of bytes and alignment.
inline void free_pages(void* memory, std::size_t bytes, std::size_t alignment) {
  if (is_scalar_block(bytes, alignment))
    ::operator delete(memory);
  else
    ::operator delete(memory, block_alignment(bytes, alignment));
}

/// Allocator of a std::vector in large pages, if it fills one.
template <class T>
struct LargePages {
  using value_type = T;

  LargePages() = default;
  template <class Other>
  LargePages(const LargePages<Other>&) {}

  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_pages(count * sizeof(T), alignof(T)));
  }
  void deallocate(T* memory, std::size_t count) { free_pages(memory, count * sizeof(T), alignof(T)); }

  template <class Other>
  friend bool operator==(const LargePages&, const LargePages<Other>&) {
    return true;
  }
};

}  // namespace detail

/// Vector of surfaces or of materials of a scene, which rays read at places without order.
template <class T>
using SceneVector = std::vector<T, detail::LargePages<T>>;

}  // namespace protostar::inline PROTOSTAR_ABI
