// Places where a stage may write its picture, and its report: files, links, mount points, file descriptors,
// devices and pipes.
#include <fcntl.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/run_stage.hpp"

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

/// Takes the right to write where the permissions forbid it from root, in case root runs the tests.
void respect_permissions() { prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE); }

}  // namespace

TEST_CASE("a file that cannot be written is reported with its path and the reason") {
  struct Row {
    std::string path;
    int reason;
  };
  const Row row = GENERATE(Row{"missing/a.ppm", ENOENT}, Row{"file/a.ppm", ENOTDIR}, Row{"folder", EISDIR},
                           Row{"folder/", EISDIR}, Row{"folder.ppm", EISDIR}, Row{"folder.png", EISDIR},
                           Row{"folder.pfm", EISDIR}, Row{"locked/a.ppm", EACCES},
                           Row{"locked/a.png", EACCES}, Row{"locked/a.pfm", EACCES}, Row{"old.ppm", EACCES},
                           Row{std::string(300, 'a').append(".ppm"), ENAMETOOLONG}, Row{"/dev/full", ENOSPC});
  CAPTURE(row.path);
  const TemporaryFolder folder;
  put_bytes(folder / "file", "a file");
  for (const char* name : {"folder", "folder.ppm", "folder.png", "folder.pfm", "locked"})
    fs::create_directory(folder / name);
  put_bytes(folder / "old.ppm", "old");
  fs::permissions(folder / "old.ppm", fs::perms::owner_read);
  fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  const auto before = folder.count();

  const Outcome outcome = run_stage("09_shadow", "--size 8x8 -o " + row.path, folder, respect_permissions);
  CHECK(outcome.status == 1);
  CHECK(outcome.out == "");
  CHECK(outcome.err == cannot_write("09_shadow", row.path, row.reason));
  CHECK(folder.count() == before);
  CHECK(fs::is_empty(folder / "locked"));
  CHECK(bytes_of(folder / "old.ppm") == "old");
  fs::permissions(folder / "locked", fs::perms::owner_all);
}

TEST_CASE("a picture that cannot be written is refused before it is drawn") {
  const TemporaryFolder folder;
  const auto start = std::chrono::steady_clock::now();
  CHECK(run_stage("09_shadow", "--size 16384x16384 -o missing/a.ppm", folder).status == 1);
  CHECK(run_stage("09_shadow", "--size 1x268435456 -o a.png", folder).err ==
        "09_shadow: save_png: an image of 1x268435456 is too large for PNG; save it as .ppm\n");
  CHECK(run_stage("09_shadow", "--size 268435456x1 -o a.png", folder).status == 1);
  CHECK(mkfifo((folder / "locked").c_str(), 0400) == 0);
  const Outcome locked = run_stage("09_shadow", "--size 16384x16384 -o locked", folder, respect_permissions);
  CHECK(locked.err == cannot_write("09_shadow", "locked", EACCES));
  CHECK(std::chrono::steady_clock::now() - start < 4s);  // drawing any of them takes longer
  CHECK(folder.count() == 1);
}

TEST_CASE("a file that is a mount point, as with Docker, is written in place, with a notice") {
  const TemporaryFolder folder;
  put_bytes(folder / "of the host.ppm", std::string(1000, 'x'));
  put_bytes(folder / "mounted.ppm", "");
  const std::string from = (folder / "of the host.ppm").string(), to = (folder / "mounted.ppm").string();
  constexpr int not_possible = 99;
  const auto mounted = [&] {
    if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        mount(from.c_str(), to.c_str(), nullptr, MS_BIND, nullptr) != 0)
      _exit(not_possible);
  };
  const Outcome outcome = run_stage("09_shadow", "--size 3x2 -o mounted.ppm", folder, mounted);
  if (outcome.status == not_possible) {
    WARN("not tested: this process may not mount");
    return;
  }
  CHECK(outcome.status == 0);
  CHECK(outcome.err ==
        "09_shadow: cannot replace 'mounted.ppm', which is a mount point: it is written in place\n");
  CHECK(outcome.out.starts_with("mounted.ppm: 3x2, "));
  CHECK(bytes_of(folder / "of the host.ppm") == stage_picture("09_shadow", "--size 3x2"));
  CHECK(bytes_of(folder / "mounted.ppm") == "");
  CHECK(folder.count() == 2);
  CHECK(run_stage("09_shadow", "--size 3x2 --quiet -o mounted.ppm", folder, mounted).err == "");

  // A render that is stopped before the first byte is written leaves the file unchanged.
  put_bytes(folder / "of the host.ppm", "old");
  Command slow = stage("15_csg", words("--size 4000x4000 --threads 1 -o mounted.ppm"), folder / "");
  slow.before = mounted;
  Process process(slow);
  process.wait_for_thread();
  std::this_thread::sleep_for(100ms);
  process.send(SIGTERM);
  CHECK(process.wait().status == 128 + SIGTERM);
  CHECK(bytes_of(folder / "of the host.ppm") == "old");
}

TEST_CASE("a file that cannot be completed leaves the old file unchanged and no temporary file") {
  const std::string name = GENERATE("out.ppm", "out.png", "out.pfm", "out.hdr");
  CAPTURE(name);
  const TemporaryFolder folder;
  put_bytes(folder / name, "old");
  const auto limit_files = [] {
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
  const Outcome outcome = run_stage("09_shadow", "--size 320x240 -o " + name, folder, limit_files);
  CHECK(outcome.status == 1);
  CHECK(outcome.out == "");
  CHECK(outcome.err == cannot_write("09_shadow", name, EFBIG));
  CHECK(bytes_of(folder / name) == "old");
  CHECK(folder.count() == 1);
}

TEST_CASE("a file that is replaced keeps its permissions; a symbolic link stays a link") {
  const TemporaryFolder folder;
  put_bytes(folder / "old.ppm", "old");
  fs::permissions(folder / "old.ppm", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("old.ppm", folder / "link.ppm");
  CHECK(run_stage("09_shadow", "--size 8x8 -o link.ppm", folder).status == 0);
  CHECK(bytes_of(folder / "old.ppm") == stage_picture("09_shadow", "--size 8x8"));
  CHECK(fs::is_symlink(folder / "link.ppm"));
  CHECK(fs::status(folder / "old.ppm").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
  CHECK(folder.count() == 2);
}

TEST_CASE("a path may contain spaces, quotes and any letters") {
  const std::string name = GENERATE("a b.ppm", "Würfel 星.ppm", "it's \"%s\".ppm", "[1,2].ppm", "a,b;c.ppm");
  CAPTURE(name);
  const TemporaryFolder folder;
  const Outcome outcome = run(stage("09_shadow", {"--size", "8x8", "-o", name}, folder / ""));
  CHECK(outcome.status == 0);
  CHECK(outcome.out.starts_with(name + ": 8x8, "));
  CHECK(bytes_of(folder / name) == stage_picture("09_shadow", "--size 8x8"));
}

TEST_CASE("stages that run at the same time in one folder do not interfere") {
  const TemporaryFolder folder;
  std::vector<std::unique_ptr<Process>> processes;
  for (const char* name : {"a.ppm", "b.ppm", "out.ppm", "out.ppm", "out.ppm"})
    processes.push_back(
        std::make_unique<Process>(stage("09_shadow", {"--size", "300x200", "-o", name}, folder / "")));
  for (const auto& process : processes) CHECK(process->wait().status == 0);
  const std::string expected = stage_picture("09_shadow", "--size 300x200");
  for (const char* name : {"a.ppm", "b.ppm", "out.ppm"}) CHECK(bytes_of(folder / name) == expected);
  CHECK(folder.count() == 3);
}

TEST_CASE("/dev/stdout receives the picture and nothing else; the report line goes to stderr") {
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("09_shadow", "--size 320x240 -o /dev/stdout", folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out == stage_picture("09_shadow", "--size 320x240"));
  CHECK(without_times(outcome.err) ==
        "/dev/stdout: 320x240, shadow, rendered in 0.0 ms, written in 0.0 ms\n");
  CHECK(folder.count() == 0);
  CHECK(run_stage("09_shadow", "--size 8x8 -o /dev/stdout --quiet", folder).err == "");
  CHECK(run_stage("09_shadow", "--size 8x8 -o /dev/stdout --plain", folder).out.starts_with("P3\n8 8\n"));
}

TEST_CASE("/dev/stdout may be redirected to a file") {
  const TemporaryFolder folder;
  const std::string path = (folder / "redirected").string();
  const Outcome outcome = run_stage("09_shadow", "--size 32x24 -o /dev/stdout", folder, [path] {
    dup2(open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600), STDOUT_FILENO);
  });
  CHECK(outcome.status == 0);
  CHECK(bytes_of(path) == stage_picture("09_shadow", "--size 32x24"));
  CHECK(outcome.err.starts_with("/dev/stdout: 32x24, "));
  CHECK(folder.count() == 1);
}

TEST_CASE("a file descriptor given by its path receives a PPM after what was written to it before") {
  struct Row {
    const char* path;
    int number;
    int flags;
  };
  const Row row = GENERATE(Row{"/dev/stdout", 1, 0}, Row{"/dev/fd/1", 1, 0}, Row{"/proc/self/fd/1", 1, 0},
                           Row{"/dev/stderr", 2, 0}, Row{"/dev/fd/2", 2, 0}, Row{"/dev/fd/7", 7, 0},
                           Row{"/dev/stdout", 1, O_APPEND}, Row{"/dev/fd/1", 1, O_APPEND});
  CAPTURE(row.path, row.flags);
  const TemporaryFolder folder;
  const std::string path = (folder / "redirected").string();
  put_bytes(path, "what was there");
  const auto redirect = [&path, row] {
    dup2(open(path.c_str(), O_RDWR | row.flags), row.number);
    if (write(row.number, "other output, ", 14) != 14) _exit(127);
  };
  const Outcome outcome =
      run_stage("09_shadow", std::string("--size 32x24 -o ") + row.path, folder, redirect);
  CHECK(outcome.status == 0);
  const std::string before = row.flags == 0 ? "other output, " : "what was thereother output, ";
  const bool is_behind = bytes_of(path) == before + stage_picture("09_shadow", "--size 32x24");
  CHECK(is_behind);
  CHECK_THAT(row.number == 1 ? outcome.err : outcome.out,
             ContainsSubstring(std::string(row.path) + ": 32x24, "));
  CHECK(folder.count() == 1);
}

TEST_CASE("a read-only file descriptor is refused before the picture is drawn") {
  const TemporaryFolder folder;
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome = run_stage("09_shadow", "--size 16384x16384 -o /dev/fd/7", folder,
                                    [] { dup2(open("/dev/null", O_RDONLY), 7); });
  CHECK(std::chrono::steady_clock::now() - start < 1s);
  CHECK(outcome.err == cannot_write("09_shadow", "/dev/fd/7", EBADF));
}

TEST_CASE("devices and pipes are written directly and are not replaced") {
  const TemporaryFolder folder;
  const std::string pipe = (folder / "pipe.png").string();  // its extension is ignored
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  Process process(stage("09_shadow", words("--size 320x240 -o pipe.png"), folder / ""));
  CHECK(bytes_of(pipe) == stage_picture("09_shadow", "--size 320x240"));
  CHECK(process.wait().status == 0);
  CHECK(fs::is_fifo(pipe));
  CHECK(folder.count() == 1);

  const Outcome outcome = run_stage("09_shadow", "--size 8x8 -o /dev/null", folder);
  CHECK(outcome.status == 0);
  CHECK(outcome.out.starts_with("/dev/null: 8x8, "));
  CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("a report line that cannot be printed is an error, though the picture is saved") {
  struct Row {
    int reason;
    void (*before)();
  };
  const Row row = GENERATE(Row{EBADF, [] { close(STDOUT_FILENO); }},
                           Row{ENOSPC, [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); }});
  const TemporaryFolder folder;
  const Outcome outcome = run_stage("09_shadow", "--size 8x8", folder, row.before);
  CHECK(outcome.status == 1);
  CHECK(outcome.err ==
        "09_shadow: cannot write standard output: " + std::generic_category().message(row.reason) + "\n");
  CHECK(bytes_of(folder / "out.ppm") == stage_picture("09_shadow", "--size 8x8"));
  CHECK(folder.count() == 1);
  CHECK(run_stage("09_shadow", "--size 8x8 --quiet", folder, row.before).status == 0);
}

TEST_CASE("a closed stdout is refused as an output file") {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_stage("09_shadow", "--size 8x8 -o /dev/stdout", folder, [] { close(STDOUT_FILENO); });
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err, ContainsSubstring("-o: '/dev/stdout' is not "));
  CHECK(fs::is_symlink("/dev/stdout"));
}

TEST_CASE("17_mesh writes no output over the mesh that it reads") {
  const TemporaryFolder folder;
  const fs::path mesh = fs::path(PROTOSTAR_SOURCE_DIR) / "scenes/knot.obj";
  const std::string before = bytes_of(mesh);
  fs::create_symlink(mesh, folder / "link.obj");
  const Outcome outcome = run_stage("17_mesh", "--pixel 1,1 --rays link.obj", folder);
  CHECK(outcome.status == 2);
  CHECK_THAT(outcome.err,
             ContainsSubstring("--rays: 'link.obj' is not another file than those of the scene"));
  CHECK(bytes_of(mesh) == before);
  CHECK(run_stage("17_mesh", "--pixel 1,1 --rays rays.obj --quiet", folder).status == 0);
}
