// A file that is replaced as a whole or not at all.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "platform.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Bytes on their way to a file. They go to a temporary file in the same folder, which takes the target's
/// name when commit() says that it is complete; until then, and if anything fails, a file of that name stays
/// as it was, and the temporary one is removed. A target that exists and is no regular file, a device or a
/// pipe, is written directly.
///
/// Every failure is a std::system_error that names the path and the reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path target) : name_(target.string()), target_(std::move(target)) {
    namespace fs = std::filesystem;
    std::error_code error;
    // A link that leads nowhere yet is followed, like any other, to where the file is to be.
    while (fs::is_symlink(fs::symlink_status(target_, error)) &&
           fs::status(target_, error).type() == fs::file_type::not_found)
      target_ = target_.parent_path() / fs::read_symlink(target_);
    const fs::file_status status = fs::status(target_, error);
    if (status.type() == fs::file_type::none)
      fail(error.value());  // a link to itself, a name that is too long
    if (is_standard_stream() && !fs::exists(status)) fail(ENOENT);  // no file is made there
    if (fs::is_directory(status)) fail(EISDIR);
    if (fs::exists(status)) {
      if (!fs::is_regular_file(status) || is_standard_stream()) {
        open(target_, "ab");
        use_buffer();
        return;
      }
      open(target_, "r+b");  // who may not write to the old file may not replace it either
      std::fclose(std::exchange(file_, nullptr));
      target_ = fs::canonical(target_, error);  // through links, so that they stay links
      if (error) fail(error.value());
    }
    open_temporary();
    use_buffer();
    if (fs::exists(status))
      fs::permissions(temporary_, status.permissions(), error);  // as far as the system has any
  }

  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  ~OutputFile() {
    std::error_code ignored;
    if (file_) std::fclose(file_);
    if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  }

  void write(const void* bytes, std::size_t size) {
    if (std::fwrite(bytes, 1, size, file_) != size) fail(errno);
  }

  void write(const std::string& bytes) { write(bytes.data(), bytes.size()); }

  /// Ends the file and gives it its name.
  void commit() {
    if (std::fflush(file_) != 0) fail(errno);
    if (std::fclose(std::exchange(file_, nullptr)) != 0) fail(errno);
    if (temporary_.empty()) return;
    std::error_code error;
    std::filesystem::rename(temporary_, target_, error);
    if (error) fail(error.value());
    temporary_.clear();
  }

 private:
  [[noreturn]] void fail(int reason) const {
    throw std::system_error(reason, std::generic_category(), "cannot write '" + name_ + "'");
  }

  void open(const std::filesystem::path& path, const char* mode) {
    file_ = std::fopen(path.string().c_str(), mode);
    if (!file_) fail(errno);
  }

  /// Makes what is written at a time large: the system is called less often than with the 4 KiB that C's
  /// own buffer mostly has.
  void use_buffer() { std::setvbuf(file_, buffer_.get(), _IOFBF, buffer_size); }

  /// A file that did not exist before, beside the target.
  void open_temporary() {
    for (int attempt = 0; !file_; ++attempt) {
      const auto path = target_.parent_path() / (".protostar-" + std::to_string(attempt) + ".tmp");
      file_ = std::fopen(path.string().c_str(), "wbx");  // x: only if there is none of that name
      if (file_)
        temporary_ = path;
      else if (errno != EEXIST)
        fail(errno);
    }
  }

  /// /dev/stdout and its like may lead to a regular file, which belongs to whoever opened it.
  [[nodiscard]] bool is_standard_stream() const {
    const std::string path = target_.string();
    return path == "/dev/stdout" || path == "/dev/stderr" || path.starts_with("/dev/fd/") ||
           path.starts_with("/proc/");
  }

  std::string name_;
  std::filesystem::path target_;
  std::filesystem::path temporary_;  // empty: there is none
  static constexpr std::size_t buffer_size = 65536;
  std::unique_ptr<char[]> buffer_ = std::make_unique_for_overwrite<char[]>(buffer_size);
  std::FILE* file_ = nullptr;
};

}  // namespace protostar::inline PROTOSTAR_ABI
