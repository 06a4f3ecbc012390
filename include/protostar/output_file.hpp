// Output files that are replaced as a whole or not at all.
#pragma once

#include <cstddef>
#include <string>
#include <system_error>
#include <utility>

#include "platform.hpp"
#include "system_file.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Name of a file: a text, or anything with string(), such as a std::filesystem::path, whose header takes
/// long to compile. Throws std::system_error if it has a byte 0: systems take it for the end, and would open
/// another file.
class FileName {
 public:
  FileName(const char* text) : text_(text) {}
  FileName(std::string text) : text_(std::move(text)) {
    if (const std::size_t end = text_.find('\0'); end != std::string::npos) [[unlikely]]
      throw std::system_error(std::make_error_code(std::errc::invalid_argument),
                              "a file name has a byte 0 behind '" + text_.substr(0, end) + "'");
  }

  template <class Path>
  requires requires(const Path& path) { std::string(path.string()); }
  FileName(const Path& path) : FileName(std::string(path.string())) {}

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Output file that replaces its target as a whole or not at all. Bytes go to a temporary file in the same
/// folder, which takes the target's name on commit(). Until then, and if anything fails, a file of that name
/// stays as it was, and the temporary one is removed. If the process is killed, that file stays behind as
/// .TARGET.DIGITS.protostar-tmp, and the next OutputFile for that target removes it if it is of the same user
/// and the folder may be read.
///
/// A symbolic link stays one: the file it leads to is replaced, or made. The new file has the permissions of
/// the old one, but no set-id bits, and its owner, group and access control list as far as the system allows;
/// if the group or the list cannot be kept, the group gets no more rights than others have. Other extended
/// attributes and hard links are not kept: other names of the old file keep its bytes. While an old file is
/// replaced, only its user may read the temporary one.
///
/// Three kinds of targets are not replaced:
/// - a device, a pipe, or a file under /proc/, which is written directly;
/// - a descriptor of this process by its name, such as /dev/stdout, /dev/fd/N or /proc/self/fd/N: it is
///   written from its current position, so bytes that were written to it before stay;
/// - a file that is a mount point of its own, which cannot be replaced: it is emptied by the first bytes and
///   written in place (is_in_place), so a failure leaves a part of a picture there.
///
/// On a system without POSIX, descriptors have no names, mount points are not known, only permissions are
/// kept, and files that a killed process left behind stay.
///
/// Throws std::system_error, which names the path and the reason, for every failure.
class OutputFile {
 public:
  /// Opens the file. The target is not changed yet, but opening a pipe waits for its reader.
  [[gnu::cold]] explicit OutputFile(const FileName& target) : name_(target.text()) {
    if (const auto error = file_.open(name_); error.number != 0) fail(error);
  }

  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Returns the descriptor of this process that a path names, open or not: /dev/stdin, /dev/stdout,
  /// /dev/stderr, /dev/fd/N or /proc/self/fd/N; -1 for any other path.
  [[nodiscard]] static int descriptor_of(const FileName& path) {
    return detail::SystemFile::descriptor_of(path.text());
  }

  /// Returns true if the target is a mount point, which is written in place.
  [[nodiscard]] bool is_in_place() const { return file_.is_in_place(); }

  void write(const void* bytes, std::size_t size) {
    constexpr std::size_t at_once = 65536;  // so that the system is called seldom
    if (buffer_.size() + size > at_once) flush();
    buffer_.reserve(at_once);
    buffer_.append(static_cast<const char*>(bytes), size);
  }

  void write(const std::string& bytes) { write(bytes.data(), bytes.size()); }

  /// Completes the file and gives it its name.
  void commit() {
    flush();
    if (const int error = file_.commit()) fail({error});
  }

 private:
  [[noreturn]] void fail(const detail::OpenError& error) const {
    throw std::system_error(error.number, std::generic_category(),
                            "cannot write '" + name_ + "'" + error.explanation);
  }

  void flush() {
    if (const int error = file_.write(buffer_.data(), buffer_.size())) fail({error});
    buffer_.clear();
  }

  std::string name_, buffer_;
  detail::SystemFile file_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
