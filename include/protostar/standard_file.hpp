// Files written through the standard library, for systems without POSIX. system_file.hpp includes this header
// there.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "error_number.hpp"
#include "platform.hpp"
#include "temporary_file.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// File to be written through the standard library: no lock tells a leftover from a file that is being
/// written, so none is removed; no descriptor can be named; and only the permissions of the old file are
/// kept. The functions return an error number, or 0.
class StandardFile {
 public:
  StandardFile() = default;
  StandardFile(const StandardFile&) = delete;
  StandardFile& operator=(const StandardFile&) = delete;
  ~StandardFile() {
    if (file_) std::fclose(file_);
    std::error_code ignored;
    if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  }

  /// Opens the file that a path leads to, as OutputFile describes.
  [[nodiscard]] OpenError open(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    target_ = path;
    const fs::file_status status = fs::status(target_, error);
    if (status.type() == fs::file_type::none) return {error.value()};  // such as a link to itself
    while (fs::is_symlink(fs::symlink_status(target_, error)))
      target_ = target_.parent_path() / fs::read_symlink(target_, error);
    if (fs::is_directory(status)) return {EISDIR};
    if (fs::exists(status) && !fs::is_regular_file(status)) return {open(target_, "ab")};
    if (target_.filename().empty()) return {ENOENT};
    if (fs::exists(status)) {
      if (const int number = open(target_, "r+b"))
        return {number};  // a user who may not write may not replace
      std::fclose(std::exchange(file_, nullptr));
      permissions_ = status.permissions() & fs::perms::all;
    }
    const TemporaryNames names(target_.filename().string());
    for (std::random_device random;;) {
      const fs::path temporary = target_.parent_path() / names.name(std::uint64_t{random()} << 32 | random());
      const int number = open(temporary, "wbx");  // x: only if the name is free
      if (number == EEXIST) continue;
      if (number == 0) temporary_ = temporary;
      return {number};
    }
  }

  [[nodiscard]] static int descriptor_of(std::string_view) { return -1; }
  [[nodiscard]] bool is_in_place() const { return false; }

  [[nodiscard]] int write(const char* bytes, std::size_t size) {
    return error_of([&] { return std::fwrite(bytes, 1, size, file_) == size; });
  }

  /// Completes the file, and gives a temporary one its name.
  [[nodiscard]] int commit() {
    if (const int number = error_of([&] { return std::fclose(std::exchange(file_, nullptr)) == 0; }))
      return number;
    if (temporary_.empty()) return 0;
    std::error_code error;
    if (permissions_ != std::filesystem::perms::unknown)
      std::filesystem::permissions(temporary_, permissions_, error);  // as far as the system has any
    std::filesystem::rename(temporary_, target_, error);
    if (!error) temporary_.clear();
    return error.value();
  }

 private:
  /// Returns 0 if a call succeeds, and otherwise its error number.
  [[nodiscard]] static int error_of(const auto& call) {
    errno = 0;  // so that no number of an earlier failure is taken for it
    return call() ? 0 : error_number();
  }

  [[nodiscard]] int open(const std::filesystem::path& path, const char* mode) {
    return error_of([&] { return (file_ = std::fopen(path.string().c_str(), mode)) != nullptr; });
  }

  std::FILE* file_ = nullptr;
  std::filesystem::path target_, temporary_;  // temporary_ is empty if there is none
  std::filesystem::perms permissions_ = std::filesystem::perms::unknown;  // the replaced file's
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
