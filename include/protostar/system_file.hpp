// Files written through the descriptors of POSIX. Systems without POSIX use standard_file.hpp.
#pragma once

// A program may define PROTOSTAR_STANDARD_FILES, in all of its translation units, to do without POSIX.
#if defined(PROTOSTAR_STANDARD_FILES) || defined(_WIN32) || defined(__EMSCRIPTEN__) || \
    !__has_include(<unistd.h>) || !__has_include(<sys/file.h>)
#include "standard_file.hpp"
namespace protostar::inline PROTOSTAR_ABI::detail {
using SystemFile = StandardFile;
}
#else
#define PROTOSTAR_POSIX_FILES

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#if __has_include(<sys/random.h>)
#include <sys/random.h>  // getentropy on macOS
#endif
#if defined(__linux__) && __has_include(<sys/xattr.h>)
#define PROTOSTAR_HAS_ACCESS_LISTS
#include <sys/xattr.h>
#endif

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "platform.hpp"
#include "temporary_file.hpp"

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Descriptor that is closed at the end; -1 for none, as open returns it.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }

  [[nodiscard]] int number() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }

  /// Closes the descriptor. Returns 0, or −1 with errno set, also for a failure of an earlier write that
  /// shows only now.
  int close() { return number_ < 0 ? 0 : ::close(std::exchange(number_, -1)); }

 private:
  int number_ = -1;
};

/// Returns true if a user may replace a file by renaming another to its name. In a sticky folder, such as
/// /tmp, only the owner of the file, the owner of the folder, and root may.
[[nodiscard]] inline bool may_replace(const struct stat& folder, const struct stat& file, uid_t user) {
  return !(folder.st_mode & S_ISVTX) || user == 0 || user == file.st_uid || user == folder.st_uid;
}

/// Returns true if a file is mounted by itself over a name in a folder, as `docker run -v file:file` does.
/// Such a name cannot be given to another file. Linux tells since 5.8; elsewhere a device other than the
/// folder's shows it, unless the file is bound from the same one.
[[nodiscard]] inline bool is_mount_point(const Descriptor& folder, const std::string& name,
                                         const struct stat& of_folder, const struct stat& of_file) {
#if defined(STATX_ATTR_MOUNT_ROOT)
  struct statx status {};
  if (::statx(folder.number(), name.c_str(), AT_SYMLINK_NOFOLLOW, 0, &status) == 0 &&
      (status.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT))
    return (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
#endif
  static_cast<void>(folder), static_cast<void>(name);
  return of_folder.st_dev != of_file.st_dev;
}

/// Gives a file the owner, the group, the access control list and the permissions of another, as far as the
/// system allows, but never a set-id or a sticky bit. If the group or the list cannot be kept, the group gets
/// no more than others have.
inline void copy_attributes(const Descriptor& from, const Descriptor& to) {
  struct stat status {};
  if (::fstat(from.number(), &status) != 0) return;
  bool kept = true;
#if defined(PROTOSTAR_HAS_ACCESS_LISTS)
  constexpr const char* access_list = "system.posix_acl_access";
  std::string list(1 << 16, '\0');  // Linux allows no longer ones
  if (const auto size = ::fgetxattr(from.number(), access_list, list.data(), list.size()); size > 0)
    kept = ::fsetxattr(to.number(), access_list, list.data(), static_cast<std::size_t>(size), 0) == 0;
#endif
  if (::fchown(to.number(), status.st_uid, status.st_gid) != 0 &&  // only root gives files away
      ::fchown(to.number(), static_cast<uid_t>(-1), status.st_gid) != 0)
    kept = false;
  const mode_t mode = status.st_mode & (S_IRWXU | S_IRWXG | S_IRWXO), others = mode & S_IRWXO;
  // On file systems without permissions fchmod fails, and then none are lost.
  static_cast<void>(::fchmod(to.number(), kept ? mode : (mode & S_IRWXU) | (others << 3) | others) == 0);
}

/// File to be written: an existing one, or a temporary one that takes a name when it is complete.
///
/// A process holds a lock on its temporary file until the file has taken its name, and the system ends the
/// lock with the process. A temporary file without a lock is therefore a leftover of a process that was
/// killed. The functions return an error number, or 0.
class SystemFile {
 public:
  SystemFile() = default;
  SystemFile(const SystemFile&) = delete;
  SystemFile& operator=(const SystemFile&) = delete;
  ~SystemFile() {
    if (!temporary_.empty()) ::unlinkat(folder_.number(), temporary_.c_str(), 0);
  }

  /// Opens the file that a path leads to, as OutputFile describes.
  [[nodiscard]] OpenError open(std::string path) {
    struct stat status {};
    const bool exists = ::stat(path.c_str(), &status) == 0;
    if (!exists && errno != ENOENT && errno != ENOTDIR) return {errno};  // such as a link to itself
    char link[4096];                                                     // as long as a path on Linux
    while (!is_in_proc(path) && descriptor_of(path) < 0) {
      const auto size = ::readlink(path.c_str(), link, sizeof link);
      if (size < 0) break;
      const std::string_view to(link, static_cast<std::size_t>(size));
      path.resize(to.starts_with('/') ? 0 : path.rfind('/') + 1);  // npos is −1
      path += to;
    }
    if (const int number = descriptor_of(path); number >= 0) return open_descriptor(number);
    if (exists && S_ISDIR(status.st_mode)) return {EISDIR};
    if (exists && (!S_ISREG(status.st_mode) || is_in_proc(path))) {
      file_ = Descriptor(::open(path.c_str(), O_WRONLY | O_APPEND | O_NOCTTY | O_CLOEXEC));
      return {file_ ? 0 : errno};
    }
    return open_target(path, exists);
  }

  /// Returns the descriptor of this process that a path names, open or not; -1 for any other path.
  [[nodiscard, gnu::cold]] static int descriptor_of(std::string_view path) {
    if (path == "/dev/stdin") return STDIN_FILENO;
    if (path == "/dev/stdout") return STDOUT_FILENO;
    if (path == "/dev/stderr") return STDERR_FILENO;
    for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
      if (!path.starts_with(folder)) continue;
      int number = 0;
      const char* const end = path.data() + path.size();
      if (const auto read = std::from_chars(path.data() + folder.size(), end, number);
          read.ec == std::errc{} && read.ptr == end && number >= 0)
        return number;
    }
    return -1;
  }

  /// Returns true if the target itself is written, as it cannot be replaced.
  [[nodiscard]] bool is_in_place() const { return is_in_place_; }

  [[nodiscard]] int write(const char* bytes, std::size_t size) {
    if (is_in_place_ && !is_emptied_) {
      if (::ftruncate(file_.number(), 0) != 0) return errno;
      is_emptied_ = true;
    }
    while (size > 0) {
      const auto count = ::write(file_.number(), bytes, size);
      if (count >= 0) {
        bytes += count;
        size -= static_cast<std::size_t>(count);
      } else if (errno == EAGAIN || errno == EWOULDBLOCK) {  // a pipe that somebody made non-blocking
        pollfd room{file_.number(), POLLOUT, 0};
        ::poll(&room, 1, -1);
      } else if (errno != EINTR) {
        return errno;
      }
    }
    return 0;
  }

  /// Completes the file, and gives a temporary one its name.
  [[nodiscard]] int commit() {
    if (temporary_.empty()) return file_.close() == 0 ? 0 : errno;
    // The old file is closed before it is replaced, which some network file systems ask for.
    if (const Descriptor replaced = std::move(replaced_)) copy_attributes(replaced, file_);
    // Network file systems report only on close that the file could not be written; the copy keeps the lock.
    const Descriptor lock(::fcntl(file_.number(), F_DUPFD_CLOEXEC, 0));
    if (!lock || file_.close() != 0 ||
        ::renameat(folder_.number(), temporary_.c_str(), folder_.number(), target_.c_str()) != 0)
      return errno;
    temporary_.clear();
    return 0;
  }

 private:
  // A folder need not be readable to make files in it.
#if defined(O_PATH)
  static constexpr int search_only = O_PATH;
#elif defined(O_SEARCH)
  static constexpr int search_only = O_SEARCH;
#else
  static constexpr int search_only = O_RDONLY;
#endif
  static constexpr int not_followed = O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;

  /// Returns true for a name under /proc/. Files that other processes have open have names there; a regular
  /// file among them belongs to the process that opened it, and is not replaced.
  [[nodiscard]] static bool is_in_proc(const std::string& path) { return path.starts_with("/proc/"); }

  /// Opens the file of a descriptor of this process, to write from its current position.
  [[nodiscard]] OpenError open_descriptor(int number) {
    file_ = Descriptor(::fcntl(number, F_DUPFD_CLOEXEC, 0));
    if (!file_) return {errno};
    return {(::fcntl(number, F_GETFL) & O_ACCMODE) == O_RDONLY ? EBADF : 0};
  }

  /// Opens a temporary file for a target that does not exist, or is a regular file and is replaced; a target
  /// that is a mount point is opened itself, and emptied by the first write.
  [[nodiscard, gnu::cold]] OpenError open_target(const std::string& path, bool exists) {
    const std::size_t begin = path.rfind('/') + 1;  // npos is −1
    const std::string folder = begin == 0 ? "." : path.substr(0, begin);
    folder_ = Descriptor(::open(folder.c_str(), search_only | O_DIRECTORY | O_CLOEXEC));
    if (!folder_) return {errno};
    target_ = path.substr(begin);
    if (target_.empty()) return {ENOENT};
    if (exists) {
      // A user who may not write to the old file may not replace it either.
      Descriptor old(::openat(folder_.number(), target_.c_str(), O_WRONLY | not_followed));
      struct stat of_folder {
      }, of_file{};
      if (!old || ::fstat(folder_.number(), &of_folder) != 0 || ::fstat(old.number(), &of_file) != 0)
        return {errno};
      if (is_mount_point(folder_, target_, of_folder, of_file)) {
        file_ = std::move(old);
        is_in_place_ = true;
        return {};
      }
      if (!may_replace(of_folder, of_file, ::geteuid()))
        return {EPERM, ", which belongs to another user, in a folder where only owners replace files"};
      replaced_ = std::move(old);
    }
    const TemporaryNames names(target_);
    reclaim(folder, names);
    return {create(names, exists ? 0600 : 0666)};  // before the umask
  }

  [[nodiscard]] int create(const TemporaryNames& names, mode_t mode) {
    for (;;) {
      std::uint64_t random = 0;
      if (::getentropy(&random, sizeof random) != 0) return errno;
      temporary_ = names.name(random);
      file_ = Descriptor(::openat(folder_.number(), temporary_.c_str(),
                                  O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode));
      if (!file_) {
        temporary_.clear();
        if (errno == EEXIST) continue;
        return errno;
      }
      // Before it has a lock, another process may take the file for a leftover: then the other has the lock,
      // or the name is gone. On a file system without locks, leftovers are not removed.
      struct stat status {};
      if ((::flock(file_.number(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) &&
          ::fstatat(folder_.number(), temporary_.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0)
        return 0;
      ::unlinkat(folder_.number(), temporary_.c_str(), 0);
    }
  }

  /// Removes the files that killed processes left behind, as far as the folder may be read and they belong to
  /// this user.
  void reclaim(const std::string& folder, const TemporaryNames& names) const {
    DIR* const entries = ::opendir(folder.c_str());
    if (!entries) return;
    while (const dirent* entry = ::readdir(entries)) {
      if (!names.contain(entry->d_name)) continue;
      const Descriptor file(::openat(folder_.number(), entry->d_name, O_WRONLY | not_followed));
      struct stat status {};
      if (file && ::fstat(file.number(), &status) == 0 && S_ISREG(status.st_mode) &&
          ::flock(file.number(), LOCK_EX | LOCK_NB) == 0)
        ::unlinkat(folder_.number(), entry->d_name, 0);
    }
    ::closedir(entries);
  }

  Descriptor folder_, file_, replaced_;
  std::string target_, temporary_;  // names in the folder; temporary_ is empty if there is none
  bool is_in_place_ = false, is_emptied_ = false;
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail

#endif
