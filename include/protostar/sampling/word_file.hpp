// Files that consist of words, the lowest byte first on any machine, with a checksum at their end.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "../platform.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Checksum of words. A change of one word surely changes it: for the same state before, different words lead
/// to different states, and for the same words after it, different states lead to different checksums. Any
/// other change goes unnoticed with a probability of 2^-64.
class WordChecksum {
 public:
  void add(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
    state_ ^= state_ >> 32;
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0x70726f746f737461u;
};

/// Words written as bytes to a sink, which takes them in blocks as sink(bytes, size).
template <class Sink>
class WordWriter {
 public:
  explicit WordWriter(Sink& sink) : sink_(sink) {}

  void put(std::uint64_t word) {
    checksum_.add(word);
    for (int i = 0; i < 8; ++i) block_[size_++] = static_cast<char>(word >> (8 * i) & 0xff);
    if (size_ == block_.size()) flush();
  }

  /// Writes a word of two halves, each below 2^32.
  void put(std::uint64_t low, std::uint64_t high) { put(low | high << 32); }

  /// Writes bytes, and zeros up to a whole word.
  void put_bytes(std::string_view bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += 8) {
      std::uint64_t word = 0;
      for (std::size_t j = i; j < i + 8 && j < bytes.size(); ++j)
        word |= std::uint64_t{static_cast<unsigned char>(bytes[j])} << (8 * (j - i));
      put(word);
    }
  }

  /// Writes the checksum, and hands the last bytes to the sink.
  void end() {
    put(checksum_.value());
    flush();
  }

 private:
  void flush() {
    sink_(block_.data(), size_);
    size_ = 0;
  }

  Sink& sink_;
  WordChecksum checksum_;
  std::array<char, 1 << 15> block_;
  std::size_t size_ = 0;
};

/// Words read from a source: source(bytes, size) writes up to `size` bytes and returns how many, 0 at the
/// end. Failures are std::runtime_error; they name the file, and the byte at which a word begins.
template <class Source>
class WordReader {
 public:
  WordReader(Source& source, std::string name) : source_(source), name_(std::move(name)) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("'" + name_ + "': " + what);
  }

  /// Fails with what was found in the word that was read last.
  [[noreturn]] void fail_at_word(const std::string& what) const {
    fail("byte " + std::to_string(position_ - 8) + ": " + what);
  }

  /// Reads a word. Fails at the end of the file.
  std::uint64_t get() {
    std::uint64_t word = 0;
    for (int i = 0; i < 8; ++i) {
      if (at_ == size_) {
        at_ = 0;
        size_ = source_(block_.data(), block_.size());
        if (size_ == 0)
          fail("the file ends after " + std::to_string(position_ + static_cast<std::uint64_t>(i)) +
               " bytes, too early");
      }
      word |= std::uint64_t{static_cast<unsigned char>(block_[at_++])} << (8 * i);
    }
    position_ += 8;
    checksum_.add(word);
    return word;
  }

  /// Reads a word. Fails with the name `what` unless it is from `least` to `most`.
  std::uint64_t get(const char* what, std::uint64_t least, std::uint64_t most) {
    const std::uint64_t word = get();
    if (word < least || word > most)
      fail_at_word(std::string(what) + " " + std::to_string(word) + "; allowed are " + std::to_string(least) +
                   " to " + std::to_string(most));
    return word;
  }

  /// Reads a word, and returns its lower and its upper half.
  std::pair<std::uint32_t, std::uint32_t> get_pair() {
    const std::uint64_t word = get();
    return {static_cast<std::uint32_t>(word), static_cast<std::uint32_t>(word >> 32)};
  }

  /// Reads `size` bytes, and fails unless zeros fill the last word.
  std::string get_bytes(std::size_t size) {
    std::string bytes;
    for (std::size_t i = 0; i < size; i += 8) {
      const std::uint64_t word = get();
      for (std::size_t j = 0; j < 8; ++j) {
        const auto byte = static_cast<char>(word >> (8 * j) & 0xff);
        if (i + j < size)
          bytes += byte;
        else if (byte != 0)
          fail_at_word("a text is filled up with something else than zeros");
      }
    }
    return bytes;
  }

  /// Reads the checksum and the end of the file. Fails if either is wrong.
  void end() {
    const std::uint64_t sum = checksum_.value();
    if (get() != sum)
      fail_at_word("the checksum does not belong to the bytes before it: the file was damaged");
    if (char byte = 0; at_ != size_ || source_(&byte, 1) != 0)
      fail("the file goes on after " + std::to_string(position_) + " bytes, where it should end");
  }

 private:
  Source& source_;
  std::string name_;
  WordChecksum checksum_;
  std::array<char, 1 << 15> block_;
  std::size_t at_ = 0, size_ = 0;
  std::uint64_t position_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
