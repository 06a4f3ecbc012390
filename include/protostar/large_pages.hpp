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

/// Allocator that asks for large pages if it allocates at least one, and otherwise allocates as usual.
/// Elements made without a value are not set to 0.
template <class T>
class LargePages {
 public:
  using value_type = T;

  LargePages() = default;
  template <class U>
  LargePages(const LargePages<U>&) {}

  [[nodiscard]] T* allocate(std::size_t count) {
    const std::size_t bytes = whole_pages(count * sizeof(T));
    void* const memory = ::operator new(bytes, alignment(bytes));
#if defined(MADV_HUGEPAGE)
    if (bytes >= page) madvise(memory, bytes, MADV_HUGEPAGE);  // if this fails, pages are small
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) { ::operator delete(memory, alignment(count * sizeof(T))); }

  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Values>
  void construct(U* place, Values&&... values) {
    ::new (static_cast<void*>(place)) U(static_cast<Values&&>(values)...);
  }

  template <class U>
  bool operator==(const LargePages<U>&) const {
    return true;
  }

 private:
  static constexpr std::size_t page = std::size_t{1} << 21, line = 64;  ///< bytes, in memory and cache
  static_assert(alignof(T) <= line);

  /// Returns a size of at least one page as a number of whole pages, so that the last one is large too.
  static std::size_t whole_pages(std::size_t bytes) {
    return bytes >= page ? (bytes + page - 1) / page * page : bytes;
  }

  static std::align_val_t alignment(std::size_t bytes) {
    return std::align_val_t{bytes >= page ? page : line};
  }
};

template <class T>
using LargeVector = std::vector<T, LargePages<T>>;

}  // namespace protostar::inline PROTOSTAR_ABI
