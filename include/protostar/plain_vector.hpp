// Vector of elements that are copied byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "large_pages.hpp"

namespace protostar::inline PROTOSTAR_ABI {

namespace detail {

/// Memory of a PlainVector, in elements of a size and an alignment in bytes. Its functions are compiled once
/// for all types of elements.
class PlainMemory {
 public:
  PlainMemory(std::size_t element, std::size_t alignment)
      : element_(element), alignment_(static_cast<std::uint32_t>(alignment)) {}
  // Functions that copy, move or free are not inlined, as they take more code than all else that a caller
  // does with the vector.
  [[gnu::noinline]] PlainMemory(const PlainMemory& other)
      : element_(other.element_), alignment_(other.alignment_) {
    assign(other);
  }
  [[gnu::noinline]] PlainMemory(PlainMemory&& other) noexcept
      : element_(other.element_), alignment_(other.alignment_) {
    swap(other);
  }
  PlainMemory& operator=(const PlainMemory& other) {
    if (this != &other) assign(other);
    return *this;
  }
  [[gnu::noinline]] PlainMemory& operator=(PlainMemory&& other) noexcept {
    PlainMemory old(element_, alignment_);
    swap(old);
    swap(other);
    return *this;
  }
  [[gnu::noinline]] ~PlainMemory() {
    if (data_ != nullptr) free();
  }

  /// Makes room for so many elements, and at least doubles the memory if it does not suffice.
  void make_room(std::size_t count) {
    if (count > room_) [[unlikely]]
      grow(count);
  }

  [[nodiscard]] void* memory() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  [[nodiscard]] std::size_t room() const { return room_; }
  void set_size(std::size_t size) { size_ = size; }  ///< at most room()

 private:
  static constexpr std::size_t largest = static_cast<std::size_t>(-1) / 4;  ///< in bytes

  void free() { free_pages(data_, room_ * element_, alignment_); }
  [[gnu::noinline]] void grow(std::size_t count) {
    if (count > largest / element_) throw std::length_error("PlainVector: too many elements");
    const std::size_t room = count > 2 * room_ ? count : 2 * room_;
    void* const data = allocate_pages(room * element_, alignment_);
    if (size_ > 0) std::memcpy(data, data_, size_ * element_);
    if (data_ != nullptr) free();
    data_ = data, room_ = room;
  }
  [[gnu::noinline]] void assign(const PlainMemory& other) {
    size_ = 0;
    make_room(other.size_);
    if (other.size_ > 0) std::memcpy(data_, other.data_, other.size_ * element_);
    size_ = other.size_;
  }
  void swap(PlainMemory& other) noexcept {
    std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(room_, other.room_);
  }

  void* data_ = nullptr;
  std::size_t element_, size_ = 0, room_ = 0;
  std::uint32_t alignment_;
};

}  // namespace detail

/// Vector of elements that are copied byte by byte, in large pages if they fill one (large_pages.hpp). It has
/// the functions of std::vector that the library uses, and one for all types of elements where it can:
/// std::vector takes a compiler several times as long. Elements made without a value are not set to 0. One
/// that was moved from is empty.
template <class T>
class PlainVector : private detail::PlainMemory {
 public:
  using value_type = T;
  using PlainMemory::clear;
  using PlainMemory::empty;
  using PlainMemory::size;

  PlainVector() : PlainMemory(sizeof(T), alignof(T)) {}
  explicit PlainVector(std::size_t size) : PlainVector() { resize(size); }
  PlainVector(std::size_t size, const T& value) : PlainVector() { resize(size, value); }

  [[nodiscard]] T* data() { return static_cast<T*>(memory()); }
  [[nodiscard]] const T* data() const { return static_cast<const T*>(memory()); }
  [[nodiscard]] T* begin() { return data(); }
  [[nodiscard]] T* end() { return data() + size(); }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size(); }
  [[nodiscard]] T& operator[](std::size_t i) { return data()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data()[i]; }
  [[nodiscard]] T& back() { return data()[size() - 1]; }
  [[nodiscard]] const T& back() const { return data()[size() - 1]; }

  void resize(std::size_t size) {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    static_assert(alignof(T) <= detail::cache_line);
    const std::size_t old = this->size();
    make_room(size);
    set_size(size);
    if constexpr (!std::is_trivially_default_constructible_v<T>)
      for (std::size_t i = old; i < size; ++i) ::new (static_cast<void*>(data() + i)) T;
  }
  void resize(std::size_t size, const T& value) {
    const std::size_t old = this->size();
    const T copy = value;  // it may be an element
    make_room(size);
    set_size(size);
    for (std::size_t i = old; i < size; ++i) ::new (static_cast<void*>(data() + i)) T(copy);
  }

  /// Adds an element at the end and returns it.
  T& push_back(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    const std::size_t size = this->size();
    if (size < room()) [[likely]] {
      T* const place = ::new (static_cast<void*>(data() + size)) T(value);
      set_size(size + 1);
      return *place;
    }
    resize(size + 1, value);
    return back();
  }

  friend bool operator==(const PlainVector& a, const PlainVector& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!(a[i] == b[i])) return false;
    return true;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
