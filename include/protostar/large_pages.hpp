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

#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

inline constexpr std::size_t large_page = std::size_t{1} << 21, cache_line = 64;  ///< in bytes

/// Returns the alignment of a block that allocate_pages returns for a number of bytes.
[[nodiscard]] inline std::align_val_t alignment_of_pages(std::size_t bytes) {
  return std::align_val_t{bytes >= large_page ? large_page : cache_line};
}

/// Returns new memory, in large pages if it fills at least one. The last page is then a whole one, so that it
/// is large too.
[[nodiscard]] inline void* allocate_pages(std::size_t bytes) {
  if (bytes >= large_page) bytes = (bytes + large_page - 1) / large_page * large_page;
  void* const memory = ::operator new(bytes, alignment_of_pages(bytes));
#if defined(MADV_HUGEPAGE)
  if (bytes >= large_page) madvise(memory, bytes, MADV_HUGEPAGE);  // if this fails, pages are small
#endif
  return memory;
}

/// Frees a block that allocate_pages returned for this number of bytes.
inline void free_pages(void* memory, std::size_t bytes) {
  ::operator delete(memory, alignment_of_pages(bytes));
}

}  // namespace detail

}  // namespace protostar::inline PROTOSTAR_ABI
