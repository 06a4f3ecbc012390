#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <future>
#include <protostar/output_file.hpp>
#include <string>
#include <system_error>

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

/// What an action fails with, as an error number, or 0. The message must name the path and the reason.
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
}  // namespace

TEST_CASE("a file takes its name when it is committed, and not before") {
  const TemporaryFolder folder;
  OutputFile file(folder / "a");
  file.write("one ");
  file.write("two", 3);
  CHECK_FALSE(fs::exists(folder / "a"));
  file.commit();
  CHECK(bytes_of(folder / "a") == "one two");
  CHECK(folder.count() == 1);
}

TEST_CASE("a file that is not committed leaves the old one as it was, and nothing else") {
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

TEST_CASE("a new file has the permissions that new files have") {
  const TemporaryFolder folder;
  save(folder / "a", "new");
  put_bytes(folder / "b", "the stream library's");
  CHECK(fs::status(folder / "a").permissions() == fs::status(folder / "b").permissions());
}

TEST_CASE("a link stays a link, and what it leads to is replaced") {
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

TEST_CASE("a path without folder is in the current one") {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder / "");
  save("a", "here");
  fs::current_path(before);
  CHECK(bytes_of(folder / "a") == "here");
}

TEST_CASE("what cannot be written is refused with path and reason") {
  const TemporaryFolder folder;
  put_bytes(folder / "file", "old");
  CHECK(failure(folder / "", [&] { OutputFile(folder / ""); }) == EISDIR);
  fs::create_directory(folder / "sub");
  CHECK(failure(folder / "sub", [&] { OutputFile(folder / "sub"); }) == EISDIR);
  CHECK(failure(folder / "none/a", [&] { OutputFile(folder / "none/a"); }) == ENOENT);
  CHECK(failure(folder / "file/a", [&] { OutputFile(folder / "file/a"); }) == ENOTDIR);
  CHECK(failure("", [&] { save("", "x"); }) == ENOENT);
  const fs::path long_name = folder / std::string(300, 'x');
  CHECK(failure(long_name, [&] { save(long_name, "x"); }) == ENAMETOOLONG);
  CHECK(folder.count() == 2);
  CHECK(bytes_of(folder / "file") == "old");
}

TEST_CASE("who may not write to a file or its folder may not replace it") {
  if (::geteuid() == 0) return;  // root may write everywhere
  const TemporaryFolder folder;
  put_bytes(folder / "a", "old");
  fs::permissions(folder / "a", fs::perms{0444});
  CHECK(failure(folder / "a", [&] { OutputFile(folder / "a"); }) == EACCES);
  fs::create_directory(folder / "sub");
  fs::permissions(folder / "sub", fs::perms{0555});
  CHECK(failure(folder / "sub/a", [&] { OutputFile(folder / "sub/a"); }) == EACCES);
  CHECK(bytes_of(folder / "a") == "old");
}

TEST_CASE("a full disk is an error, of few bytes and of many") {
  if (!fs::exists("/dev/full")) return;  // not on every system
  CHECK(failure("/dev/full", [] { save("/dev/full", "x"); }) == ENOSPC);
  CHECK(failure("/dev/full", [] { save("/dev/full", std::string(10000000, 'x')); }) == ENOSPC);
  CHECK(fs::is_character_file("/dev/full"));
}

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
