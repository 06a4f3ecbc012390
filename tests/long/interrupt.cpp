// Ctrl-C and other signals, as a user of a stage sees them.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

using namespace std::chrono_literals;

namespace {

/// Sends a signal; checks that the process ends within half a second, with status 128 + signal and without
/// output.
void check_ends_at_once(Process& process, int signal) {
  const auto start = std::chrono::steady_clock::now();
  process.send(signal);
  const Outcome outcome = process.wait();
  const auto time = std::chrono::steady_clock::now() - start;
  CHECK(outcome.status == 128 + signal);
  CHECK(outcome.out == "");
  CHECK(outcome.err == "");
  CHECK(std::chrono::duration<double>(time).count() < 0.5);
}

/// Returns when a file other than out.ppm holds something: the picture is being written.
void wait_for_temporary_file(const TemporaryFolder& folder) {
  namespace fs = std::filesystem;
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < deadline) {
    for (const auto& entry : fs::directory_iterator(folder / "")) {
      std::error_code vanished;
      const auto size = fs::file_size(entry, vanished);
      if (entry.path().filename() != "out.ppm" && !vanished && size > 0) return;
    }
    std::this_thread::sleep_for(1ms);
  }
  FAIL("no temporary file was seen");
}

}  // namespace

TEST_CASE("a signal ends a render at once, with status 128 plus its number, and leaves no file") {
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP);
  CAPTURE(signal);
  const TemporaryFolder folder;
  // A picture that takes seconds, on any machine.
  Process process(stage("15_csg", words("--size 4000x4000 --threads 1"), folder / ""));
  process.wait_for_thread();
  std::this_thread::sleep_for(200ms);
  check_ends_at_once(process, signal);
  CHECK(folder.count() == 0);
}

TEST_CASE("a signal while the picture is written leaves the old file unchanged and no temporary file") {
  const TemporaryFolder folder;
  put_bytes(folder / "out.ppm", "old");
  Process process(stage("01_gradient", words("--size 6000x4000"), folder / ""));
  wait_for_temporary_file(folder);
  check_ends_at_once(process, SIGINT);
  CHECK(folder.count() == 1);
  CHECK(bytes_of(folder / "out.ppm") == "old");
}

TEST_CASE("the temporary file of a killed stage is removed by the next stage that writes the same picture") {
  const int signal = GENERATE(SIGKILL, SIGQUIT, SIGXCPU, SIGABRT);  // signals that a stage does not catch
  CAPTURE(signal);
  const TemporaryFolder folder;
  put_bytes(folder / "out.ppm", "old");
  Command command = stage("01_gradient", words("--size 6000x4000"), folder / "");
  command.before = [] {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
  };
  Process process(command);
  wait_for_temporary_file(folder);
  process.send(signal);
  CHECK(process.wait().status == -signal);
  CHECK(bytes_of(folder / "out.ppm") == "old");
  CHECK(folder.count() == 2);
  CHECK(run(stage("01_gradient", words("--size 3x1 -o other.ppm"), folder / "")).status == 0);
  CHECK(folder.count() == 3);
  CHECK(run(stage("01_gradient", words("--size 3x1"), folder / "")).status == 0);
  CHECK(folder.count() == 2);
  CHECK(bytes_of(folder / "out.ppm").starts_with("P3\n3 1\n"));
}

TEST_CASE("killing a stage does not affect another that writes the same picture", "[bytes]") {
  const TemporaryFolder folder;
  const Command command = stage("01_gradient", words("--size 3000x2000 --quiet"), folder / "");
  Process first(command);
  wait_for_temporary_file(folder);
  Process second(command);
  std::this_thread::sleep_for(20ms);
  first.send(SIGKILL);
  CHECK(first.wait().status == -SIGKILL);
  CHECK(second.wait().status == 0);
  const std::string picture = bytes_of(folder / "out.ppm");
  CHECK(run(command).status == 0);
  CHECK((bytes_of(folder / "out.ppm") == picture));  // in parentheses, to print no megabyte
  CHECK(folder.count() == 1);
}

TEST_CASE("a signal ends a stage at once even if it cannot start a thread that waits for signals") {
  const TemporaryFolder folder;
  Command command = stage("15_csg", words("--size 4000x4000 --threads 1 --quiet"), folder / "");
  command.before = forbid_threads;
  Process process(command);
  std::this_thread::sleep_for(300ms);
  const auto start = std::chrono::steady_clock::now();
  process.send(SIGINT);
  CHECK(process.wait().status == -SIGINT);
  CHECK(std::chrono::steady_clock::now() - start < 500ms);
  CHECK(folder.count() == 0);
}

TEST_CASE("a signal while a PNG is encoded leaves no file") {
  const TemporaryFolder folder;
  Process process(stage("01_gradient", words("--size 4000x4000 -o out.png"), folder / ""));
  process.wait_for_thread();
  std::this_thread::sleep_for(400ms);
  check_ends_at_once(process, SIGINT);
  CHECK(folder.count() == 0);
}

TEST_CASE("a signal ends a stage that waits for the reader of a pipe") {
  const bool opened = GENERATE(false, true);
  CAPTURE(opened);
  const TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = opened ? open(pipe.c_str(), O_RDONLY | O_NONBLOCK) : -1;  // it never reads
  Process process(stage("01_gradient", words("-o pipe --size 400x400"), folder / ""));
  process.wait_for_thread();
  std::this_thread::sleep_for(100ms);
  check_ends_at_once(process, SIGINT);
  if (opened) close(reader);
  CHECK(std::filesystem::is_fifo(pipe));
  CHECK(folder.count() == 1);
}

TEST_CASE("a signal that is ignored when a stage starts stays ignored") {
  const int signal = GENERATE(SIGINT, SIGHUP);  // as after the shell's & and nohup
  CAPTURE(signal);
  const TemporaryFolder folder;
  Command command = stage("09_shadow", words("--size 1000x1000 --threads 1"), folder / "");
  command.before = [signal] { std::signal(signal, SIG_IGN); };
  Process process(command);
  process.wait_for_thread();
  process.send(signal);
  CHECK(process.wait().status == 0);
  CHECK(bytes_of(folder / "out.ppm").size() == 3'000'000 + std::string("P6\n1000 1000\n255\n").size());
}
