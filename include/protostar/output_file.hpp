// A file that is replaced as a whole or not at all.
#pragma once

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "system_file.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Bytes on their way to a file. They go to a temporary file in the same folder, which takes the target's
/// name when commit() says that it is complete. Until then, and if anything fails, a file of that name stays
/// as it was, and the temporary one is removed. If the process is killed it stays behind, as
/// .TARGET.DIGITS.protostar-tmp, and the next OutputFile for that target removes it, of those of its own user
/// and in a folder that may be read.
///
/// A symbolic link stays one: what it leads to is replaced, or made. The new file has the permissions of the
/// old one, but no set-id bits; of owner, group and access control list what the system lets; where the group
/// cannot be kept, it gets no more rights than others have. Other extended attributes and hard links are not
/// kept: other names of the old file keep its bytes. While an old file is replaced, only its user may read
/// the temporary one.
///
/// Three kinds of targets are not replaced:
/// - a device or a pipe, which is written directly;
/// - a descriptor of this process by its name, such as /dev/stdout, /dev/fd/N or /proc/self/fd/N: it is
///   written from where it stands, so that what was written to it before stays;
/// - a file that is a mount point of its own, which cannot be replaced: it is emptied by the first bytes and
///   written in place (is_in_place), so that a failure leaves a part of a picture there.
///
/// Where the system has no POSIX, descriptors have no names, mount points are not known, only permissions are
/// kept, and what a killed process left behind stays.
///
/// Every failure is a std::system_error that names the path and the reason.
class OutputFile {
 public:
  /// Opens it. Nothing that exists is changed yet, except that opening a pipe waits for its reader.
  explicit OutputFile(std::filesystem::path target) : name_(target.string()) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    if (status.type() == fs::file_type::none)
      fail({error.value()});  // a link to itself, a name that is too long
    while (!is_in_proc(target) && !descriptor_of(target) && fs::is_symlink(fs::symlink_status(target, error)))
      target = target.parent_path() / fs::read_symlink(target, error);
    const bool exists = fs::exists(status);
    if (const auto number = descriptor_of(target))
      check(file_.open_descriptor(*number));
    else if (fs::is_directory(status))
      fail({EISDIR});
    else if (exists && (!fs::is_regular_file(status) || is_in_proc(target)))
      check(file_.open_directly(target));
    else
      check(file_.open_target(target, exists));
  }

  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The descriptor of this process that a path names: /dev/stdin, /dev/stdout, /dev/stderr, /dev/fd/N or
  /// /proc/self/fd/N, whether it is open or not.
  [[nodiscard]] static std::optional<int> descriptor_of(const std::filesystem::path& path) {
#if defined(PROTOSTAR_POSIX_FILES)
    const std::string text = path.string();
    if (text == "/dev/stdin") return STDIN_FILENO;
    if (text == "/dev/stdout") return STDOUT_FILENO;
    if (text == "/dev/stderr") return STDERR_FILENO;
    for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
      if (!text.starts_with(folder)) continue;
      int number = 0;
      const char* const end = text.data() + text.size();
      if (const auto read = std::from_chars(text.data() + folder.size(), end, number);
          read.ec == std::errc{} && read.ptr == end && number >= 0)
        return number;
    }
#else
    static_cast<void>(path);
#endif
    return std::nullopt;
  }

  /// Whether the target is a mount point, which is written in place.
  [[nodiscard]] bool is_in_place() const { return file_.is_in_place(); }

  void write(const void* bytes, std::size_t size) {
    const char* from = static_cast<const char*>(bytes);
    if (size > buffer_size - used_) flush();
    if (size > buffer_size) return put(from, size);
    std::memcpy(buffer_.get() + used_, from, size);
    used_ += size;
  }

  void write(const std::string& bytes) { write(bytes.data(), bytes.size()); }

  /// Ends the file and gives it its name.
  void commit() {
    flush();
    if (const int error = file_.commit()) fail({error});
  }

 private:
  [[noreturn]] void fail(const detail::OpenError& error) const {
    throw std::system_error(error.number, std::generic_category(),
                            "cannot write '" + name_ + "'" + error.explanation);
  }

  void check(const detail::OpenError& error) const {
    if (error.number != 0) fail(error);
  }

  void put(const char* bytes, std::size_t size) {
    if (const int error = file_.write(bytes, size)) fail({error});
  }

  void flush() { put(buffer_.get(), std::exchange(used_, 0)); }

  /// What other processes have open has names there, which may lead to a regular file; that belongs to
  /// whoever opened it.
  [[nodiscard]] static bool is_in_proc(const std::filesystem::path& path) {
    return path.string().starts_with("/proc/");
  }

  std::string name_;
  detail::SystemFile file_;
  // As much as is written at a time, so that the system is called seldom.
  static constexpr std::size_t buffer_size = 65536;
  std::unique_ptr<char[]> buffer_{new char[buffer_size]};
  std::size_t used_ = 0;
};

}  // namespace protostar::inline PROTOSTAR_ABI
