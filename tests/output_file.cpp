#include <fcntl.h>
#include <grp.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <future>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#if defined(PROTOSTAR_STANDARD_FILES)
// A C library that lets calls fail without a reason, as the standard allows.
static bool gives_no_reason = false;
static std::size_t fwrite_or_fail(const void* bytes, std::size_t size, std::size_t count, std::FILE* file) {
  return gives_no_reason ? 0 : std::fwrite(bytes, size, count, file);
}
namespace std {
using ::fwrite_or_fail;
}
#define fwrite fwrite_or_fail
#endif
#include <protostar/output_file.hpp>
#undef fwrite

#if defined(__linux__)
#include <sys/xattr.h>
#endif

#include "support/cases.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"

using namespace protostar;
namespace fs = std::filesystem;

namespace {
void save(const fs::path& path, const std::string& bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

/// Returns the error number that an action fails with, or 0. Checks that the message names the path and the
/// reason.
int failure(const fs::path& path, auto&& action) {
  try {
    action();
  } catch (const std::system_error& error) {
    CHECK_THAT(error.what(), ContainsSubstring("'" + path.string() + "'"));
    CHECK_THAT(error.what(), ContainsSubstring(error.code().message()));
    CHECK(error.code().category() == std::generic_category());
    return error.code().value();
  }
  return 0;
}

/// Returns the sorted names in a folder.
std::vector<std::string> names_in(const TemporaryFolder& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "")) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

/// Returns the only temporary file of a folder.
fs::path temporary_in(const TemporaryFolder& folder) {
  std::vector<fs::path> found;
  for (const std::string& name : names_in(folder))
    if (name.ends_with(".protostar-tmp") || name.ends_with(".tmp")) found.push_back(folder / name);
  REQUIRE(found.size() == 1);
  return found[0];
}

mode_t mode_of(const fs::path& path) {
  struct stat status {};
  REQUIRE(::lstat(path.c_str(), &status) == 0);
  return status.st_mode & 07777;
}

/// Returns the result of an action, 0 to 255, run in a process of its own; 255 if it throws, and -1 if a
/// signal ends it.
int in_another_process(auto&& action) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    int result = 255;
    try {
      result = action();
    } catch (...) {
    }
    ::_exit(result);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Returns the result of an action, run in a process as another user, whose only group has the user's number;
/// 254 if that fails.
int as_user(uid_t user, auto&& action) {
  return in_another_process([&] {
    if (::setgroups(0, nullptr) != 0 || ::setgid(user) != 0 || ::setuid(user) != 0) return 254;
    return action();
  });
}
}  // namespace

TEST_CASE("a file gets its name when it is committed, and not before") {
  const TemporaryFolder folder;
  OutputFile file(folder / "a");
  file.write("one ");
  file.write("two", 3);
  CHECK_FALSE(fs::exists(folder / "a"));
  file.commit();
  CHECK(bytes_of(folder / "a") == "one two");
  CHECK(folder.count() == 1);
}

TEST_CASE("a file that is not committed leaves the old one unchanged, and no temporary file") {
  const TemporaryFolder folder;
  put_bytes(folder / "a", "old");
  {
    OutputFile file(folder / "a");
    file.write(std::string(1000000, 'x'));
    CHECK(bytes_of(folder / "a") == "old");
  }
  CHECK(bytes_of(folder / "a") == "old");
  CHECK(folder.count() == 1);
  try {
    OutputFile file(folder / "b");
    file.write("half");
    throw 1;
  } catch (int) {
  }
  CHECK(folder.count() == 1);
}

TEST_CASE("a file replaces an old one as a whole and keeps its permissions") {
  const TemporaryFolder folder;
  for (const auto mode : {fs::perms{0600}, fs::perms{0644}, fs::perms{0666}, fs::perms{0755}}) {
    put_bytes(folder / "a", "a long old text");
    fs::permissions(folder / "a", mode);
    save(folder / "a", "new");
    CHECK(bytes_of(folder / "a") == "new");
    CHECK(fs::status(folder / "a").permissions() == mode);
  }
  CHECK(folder.count() == 1);
}

TEST_CASE("a new file has the default permissions") {
  const TemporaryFolder folder;
  save(folder / "a", "new");
  put_bytes(folder / "b", "the stream library's");
  CHECK(fs::status(folder / "a").permissions() == fs::status(folder / "b").permissions());
}

TEST_CASE("a symbolic link stays a link, and its target is replaced") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "elsewhere");
  put_bytes(folder / "elsewhere/a", "old");
  fs::create_symlink("elsewhere/a", folder / "link");
  fs::create_symlink("link", folder / "link to link");
  save(folder / "link to link", "new");
  CHECK(fs::is_symlink(folder / "link to link"));
  CHECK(fs::is_symlink(folder / "link"));
  CHECK(fs::is_regular_file(fs::symlink_status(folder / "elsewhere/a")));
  CHECK(bytes_of(folder / "elsewhere/a") == "new");
  CHECK(folder.count() == 3);
}

TEST_CASE("files of one folder may be written at the same time") {
  const TemporaryFolder folder;
  {
    OutputFile a(folder / "a"), b(folder / "b"), again(folder / "a");
    a.write("1");
    b.write("2");
    again.write("3");
    a.commit();
    b.commit();
    CHECK(bytes_of(folder / "a") == "1");
    CHECK(bytes_of(folder / "b") == "2");
  }
  CHECK(folder.count() == 2);
}

TEST_CASE("a path without a folder is in the current folder") {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder / "");
  save("a", "here");
  fs::current_path(before);
  CHECK(bytes_of(folder / "a") == "here");
}

TEST_CASE("a path that cannot be written is refused with path and reason") {
  const TemporaryFolder folder;
  put_bytes(folder / "file", "old");
  CHECK(failure(folder / "", [&] { OutputFile(folder / ""); }) == EISDIR);
  fs::create_directory(folder / "sub");
  CHECK(failure(folder / "sub", [&] { OutputFile(folder / "sub"); }) == EISDIR);
  CHECK(failure(folder / "none/a", [&] { OutputFile(folder / "none/a"); }) == ENOENT);
  CHECK(failure(folder / "file/a", [&] { OutputFile(folder / "file/a"); }) == ENOTDIR);
  CHECK(failure("", [&] { save("", "x"); }) == ENOENT);
  const std::string cut = (folder / "file").string() + std::string(1, '\0') + ".ppm";
  CHECK(failure(folder / "file", [&] { save(cut, "x"); }) == EINVAL);
  const fs::path long_name = folder / std::string(300, 'x');
  CHECK(failure(long_name, [&] { save(long_name, "x"); }) == ENAMETOOLONG);
  CHECK(folder.count() == 2);
  CHECK(bytes_of(folder / "file") == "old");
}

TEST_CASE("a file is not replaced without permission to write to it and to its folder") {
  const TemporaryFolder folder;
  fs::permissions(folder / "", fs::perms{0777});
  put_bytes(folder / "a", "old");
  fs::permissions(folder / "a", fs::perms{0444});
  fs::create_directory(folder / "sub");
  fs::permissions(folder / "sub", fs::perms{0555});
  const auto error_at = [&](const std::string& name) {
    const auto error = [&] { return failure(folder / name, [&] { save(folder / name, "new"); }); };
    return ::geteuid() == 0 ? as_user(54321, error) : error();  // root may write everywhere
  };
  CHECK(error_at("a") == EACCES);
  CHECK(error_at("sub/a") == EACCES);
  CHECK(error_at("b") == 0);
  CHECK(bytes_of(folder / "a") == "old");
}

TEST_CASE("a full disk is an error, for few bytes and for many") {
  if (!fs::exists("/dev/full")) {
    WARN("not tested: this system has no /dev/full");
    return;
  }
  CHECK(failure("/dev/full", [] { save("/dev/full", "x"); }) == ENOSPC);
  CHECK(failure("/dev/full", [] { save("/dev/full", std::string(10000000, 'x')); }) == ENOSPC);
  CHECK(fs::is_character_file("/dev/full"));
}

#if defined(PROTOSTAR_STANDARD_FILES)
TEST_CASE("a failure for which the C library gives no reason is an error, and not told as a success") {
  const TemporaryFolder folder;
  errno = ENOENT;  // of an earlier failure
  gives_no_reason = true;
  const int number = failure(folder / "a", [&] { save(folder / "a", "new"); });
  gives_no_reason = false;
  CHECK(number == EIO);
  CHECK(folder.count() == 0);
}
#endif

TEST_CASE("a pipe is written directly and stays a pipe") {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  auto read = std::async(std::launch::async, [&] { return bytes_of(pipe); });
  save(pipe, "through the pipe");
  CHECK(read.get() == "through the pipe");
  CHECK(fs::is_fifo(pipe));
  CHECK(folder.count() == 1);
}

TEST_CASE("a replaced file loses its set-id and sticky bits") {
  const TemporaryFolder folder;
  for (const mode_t mode : {04777u, 02755u, 01644u, 06711u}) {
    put_bytes(folder / "a", "old");
    REQUIRE(::chmod((folder / "a").c_str(), mode) == 0);
    save(folder / "a", "new");
    CHECK(mode_of(folder / "a") == (mode & 0777));
  }
}

TEST_CASE("the name of a temporary file begins with the target's and is unpredictable") {
  const TemporaryFolder folder;
  std::set<std::string> names;
  for (int i = 0; i < 20; ++i) {
    const OutputFile file(folder / "picture.ppm");
    const std::string name = temporary_in(folder).filename();
    CHECK(name.starts_with(".picture.ppm."));
    names.insert(name);
  }
  CHECK(names.size() == 20);
}

TEST_CASE("a target may have a name as long as the system allows") {
  const TemporaryFolder folder;
  std::string stars;
  while (stars.size() < 252) stars += "★";  // three bytes each, so that a cut could split one
  for (const std::string& name : {std::string(255, 'x'), stars, "a" + stars, "ab" + stars}) {
    save(folder / name, "new");
    CHECK(bytes_of(folder / name) == "new");
    const OutputFile file(folder / name);
    const std::string temporary = temporary_in(folder).filename();
    const std::string begin = temporary.substr(1, temporary.find('.', 1) - 1);
    CHECK(name.starts_with(begin));
    CHECK(begin.size() >= 62);
    CHECK((static_cast<unsigned char>(name[begin.size()]) & 0xc0) != 0x80);
  }
}

#if defined(PROTOSTAR_POSIX_FILES)

TEST_CASE("while an old file is replaced, only its owner may read the temporary file") {
  const TemporaryFolder folder;
  for (const mode_t mode : {0600u, 0644u, 0666u}) {
    put_bytes(folder / "a", "old");
    REQUIRE(::chmod((folder / "a").c_str(), mode) == 0);
    OutputFile file(folder / "a");
    CHECK(mode_of(temporary_in(folder)) == 0600);
    file.write("new");
    CHECK(mode_of(temporary_in(folder)) == 0600);
    file.commit();
    CHECK(mode_of(folder / "a") == mode);
  }
}

TEST_CASE("a symbolic link in the place of the temporary file does not change the link's target") {
  const TemporaryFolder folder;
  put_bytes(folder / "secret", "secret");
  put_bytes(folder / "a", "old");
  REQUIRE(::chmod((folder / "secret").c_str(), 0600) == 0);
  REQUIRE(::chmod((folder / "a").c_str(), 0777) == 0);
  {
    OutputFile file(folder / "a");
    const fs::path temporary = temporary_in(folder);
    fs::remove(temporary);
    fs::create_symlink("secret", temporary);
    file.write("new");
    file.commit();
  }
  CHECK(mode_of(folder / "secret") == 0600);
  CHECK(bytes_of(folder / "secret") == "secret");
}

TEST_CASE("the temporary file of a killed process is removed by the next writer of the same target") {
  const TemporaryFolder folder;
  put_bytes(folder / "a", "old");
  CHECK(in_another_process([&]() -> int {
          OutputFile file(folder / "a");
          file.write(std::string(1'000'000, 'x'));
          std::raise(SIGKILL);
          return 0;
        }) == -1);
  CHECK(folder.count() == 2);
  CHECK(bytes_of(folder / "a") == "old");
  save(folder / "b", "new");
  CHECK(folder.count() == 3);
  { const OutputFile not_committed(folder / "a"); }
  CHECK(names_in(folder) == std::vector<std::string>{"a", "b"});
  CHECK(bytes_of(folder / "a") == "old");
}

TEST_CASE("only leftovers of the same target are removed when it is written") {
  const TemporaryFolder folder;
  put_bytes(folder / ".a.0123456789abcdef.protostar-tmp", "a leftover");
  put_bytes(folder / ".ab.0123456789abcdef.protostar-tmp", "another target's");
  put_bytes(folder / ".a.0123456789abcde.protostar-tmp", "a digit less");
  put_bytes(folder / ".a.0123456789abcdeX.protostar-tmp", "not a digit");
  put_bytes(folder / ".a.0123456789abcdef.protostar-tmp.gz", "another ending");
  fs::create_directory(folder / ".a.1123456789abcdef.protostar-tmp");
  fs::create_symlink("a", folder / ".a.2123456789abcdef.protostar-tmp");
  REQUIRE(::mkfifo((folder / ".a.3123456789abcdef.protostar-tmp").c_str(), 0600) == 0);
  save(folder / "a", "new");
  CHECK(folder.count() == 8);
  CHECK_FALSE(fs::exists(folder / ".a.0123456789abcdef.protostar-tmp"));
}

TEST_CASE("several writers of one target leave a whole file, and do not disturb each other") {
  const TemporaryFolder folder;
  constexpr std::size_t size = 100'000;
  std::vector<std::future<int>> writers;
  for (const char letter : {'a', 'b', 'c', 'd', 'e', 'f'})
    writers.push_back(std::async(std::launch::async, [&folder, letter] {
      int broken = 0;
      for (int i = 0; i < cases(50, 200); ++i) {
        save(folder / "target", std::string(size, letter));
        const std::string bytes = bytes_of(folder / "target");
        broken += bytes != std::string(size, bytes.empty() ? ' ' : bytes[0]);
      }
      return broken;
    }));
  for (auto& writer : writers) CHECK(writer.get() == 0);
  CHECK(folder.count() == 1);
}

TEST_CASE("a replaced file keeps its owner and its group") {
  if (::geteuid() != 0) {
    WARN("not tested: only root gives files away");
    return;
  }
  const TemporaryFolder folder;
  put_bytes(folder / "a", "old");
  REQUIRE(::chown((folder / "a").c_str(), 54321, 54322) == 0);
  REQUIRE(::chmod((folder / "a").c_str(), 0640) == 0);
  save(folder / "a", "new");
  struct stat status {};
  REQUIRE(::stat((folder / "a").c_str(), &status) == 0);
  CHECK(status.st_uid == 54321);
  CHECK(status.st_gid == 54322);
  CHECK(mode_of(folder / "a") == 0640);
}

TEST_CASE("the new group of a file has no more rights than others if the old group cannot be kept") {
  if (::geteuid() != 0) {
    WARN("not tested: only root may become another user");
    return;
  }
  const TemporaryFolder folder;
  REQUIRE(::chmod((folder / "").c_str(), 0777) == 0);
  put_bytes(folder / "a", "old");
  REQUIRE(::chmod((folder / "a").c_str(), 0676) == 0);
  CHECK(as_user(54321, [&] { return save(folder / "a", "new"), 0; }) == 0);
  CHECK(mode_of(folder / "a") == 0666);
  CHECK(bytes_of(folder / "a") == "new");
}

TEST_CASE("a file may be written to a folder that may not be read") {
  if (::geteuid() != 0) {
    WARN("not tested: only root may become another user");
    return;
  }
  const TemporaryFolder folder;
  REQUIRE(::chmod((folder / "").c_str(), 0733) == 0);
  CHECK(as_user(54321, [&] { return save(folder / "a", "new"), 0; }) == 0);
  CHECK(bytes_of(folder / "a") == "new");
}

#if defined(__linux__)
TEST_CASE("a replaced file keeps its access control list") {
  // Format of the kernel (linux/posix_acl_xattr.h): a version, and per entry a kind, rights, and who.
  struct Entry {
    std::uint16_t kind, rights;
    std::uint32_t who;
  };
  constexpr std::uint32_t nobody = ~std::uint32_t{0};
  const std::array<Entry, 5> entries{
      {{1, 6, nobody}, {2, 6, 54321}, {4, 0, nobody}, {16, 6, nobody}, {32, 0, nobody}}};
  std::string list("\2\0\0\0", 4);
  list.append(reinterpret_cast<const char*>(entries.data()), sizeof entries);

  const TemporaryFolder folder;
  put_bytes(folder / "a", "old");
  const char* const name = "system.posix_acl_access";
  if (::setxattr((folder / "a").c_str(), name, list.data(), list.size(), 0) != 0) {
    WARN("not tested: this file system has no access control lists");
    return;
  }
  REQUIRE(mode_of(folder / "a") == 0660);  // the mask takes the place of the group's rights, which are none
  save(folder / "a", "new");
  std::array<char, 256> kept{};
  const auto size = ::getxattr((folder / "a").c_str(), name, kept.data(), kept.size());
  REQUIRE(size == static_cast<ssize_t>(list.size()));
  CHECK(std::string(kept.data(), list.size()) == list);
}
#endif

TEST_CASE("in a sticky folder only the owners and root may replace a file") {
  const auto allowed = [](mode_t mode, uid_t of_folder, uid_t of_file, uid_t user) {
    struct stat folder {
    }, file{};
    folder.st_mode = S_IFDIR | mode;
    folder.st_uid = of_folder;
    file.st_uid = of_file;
    return detail::may_replace(folder, file, user);
  };
  CHECK(allowed(0777, 1, 2, 3));
  CHECK(allowed(01777, 1, 2, 2));
  CHECK(allowed(01777, 1, 2, 1));
  CHECK(allowed(01777, 1, 2, 0));
  CHECK_FALSE(allowed(01777, 1, 2, 3));
  CHECK_FALSE(allowed(01777, 0, 0, 3));
}

TEST_CASE("a file that may not be replaced in a sticky folder is refused before a byte is written") {
  if (::geteuid() != 0) {
    WARN("not tested: only root may become another user");
    return;
  }
  const TemporaryFolder folder;
  REQUIRE(::chmod((folder / "").c_str(), 01777) == 0);
  put_bytes(folder / "a", "old");
  REQUIRE(::chmod((folder / "a").c_str(), 0666) == 0);
  const std::string message = "cannot write '" + (folder / "a").string() +
                              "', which belongs to another user, in a folder where only owners replace "
                              "files: " +
                              std::generic_category().message(EPERM);
  CHECK(as_user(54321, [&] {
          try {
            const OutputFile file(folder / "a");
          } catch (const std::system_error& error) {
            return error.code().value() == EPERM && error.what() == message ? 0 : 1;
          }
          return 2;
        }) == 0);
  CHECK(folder.count() == 1);
}

TEST_CASE("a mount point is recognized by the system's answer, or by its device") {
  const auto is_mounted = [](const fs::path& folder, const std::string& name) {
    const detail::Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    struct stat of_folder {
    }, of_file{};
    REQUIRE(::fstat(descriptor.number(), &of_folder) == 0);
    REQUIRE(::fstatat(descriptor.number(), name.c_str(), &of_file, 0) == 0);
    return detail::is_mount_point(descriptor, name, of_folder, of_file);
  };
  const TemporaryFolder folder;
  put_bytes(folder / "a", "");
  CHECK_FALSE(is_mounted(folder / "", "a"));
  if (fs::exists("/proc/self"))
    CHECK(is_mounted("/", "proc"));
  else
    WARN("not tested: no /proc is mounted");
}

TEST_CASE("writing to a descriptor's name continues at the descriptor's position") {
  const TemporaryFolder folder;
  for (const std::string prefix : {"/dev/fd/", "/proc/self/fd/"}) {
    const detail::Descriptor descriptor(
        ::open((folder / "a").c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    const fs::path name = prefix + std::to_string(descriptor.number());
    REQUIRE(::write(descriptor.number(), "before ", 7) == 7);
    save(name, "picture");
    REQUIRE(::write(descriptor.number(), " after", 6) == 6);
    CHECK(bytes_of(folder / "a") == "before picture after");

    fs::create_symlink(name, folder / "link");
    save(folder / "link", "!");
    CHECK(bytes_of(folder / "a") == "before picture after!");
    CHECK(fs::is_symlink(folder / "link"));
    fs::remove(folder / "link");
    CHECK(folder.count() == 1);
  }
}

TEST_CASE("a descriptor that is closed, or open for reading only, is refused") {
  const TemporaryFolder folder;
  put_bytes(folder / "a", "old");
  const detail::Descriptor descriptor(::open((folder / "a").c_str(), O_RDONLY | O_CLOEXEC));
  const fs::path readable = "/dev/fd/" + std::to_string(descriptor.number());
  CHECK(failure(readable, [&] { OutputFile{readable}; }) == EBADF);
  CHECK(failure("/dev/fd/98765", [] { OutputFile{"/dev/fd/98765"}; }) == EBADF);
  CHECK(failure("/proc/self/fd/98765", [] { OutputFile{"/proc/self/fd/98765"}; }) == EBADF);
  CHECK(bytes_of(folder / "a") == "old");
}

TEST_CASE("a non-blocking pipe is filled as its reader empties it") {
  std::array<int, 2> ends{};
  REQUIRE(::pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) == 0);
  const detail::Descriptor from(ends[0]);
  detail::Descriptor to(ends[1]);
  auto writer = std::async(std::launch::async, [&] {
    save("/dev/fd/" + std::to_string(to.number()), std::string(1'000'000, 'x'));
    to.close();
  });
  std::size_t count = 0;
  std::array<char, 5000> bytes{};
  for (ssize_t some = -1; some != 0;) {
    some = ::read(from.number(), bytes.data(), bytes.size());
    if (some > 0) count += static_cast<std::size_t>(some);
    if (some < 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  writer.get();
  CHECK(count == 1'000'000);
}

#endif
