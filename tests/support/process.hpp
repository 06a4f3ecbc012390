// Runs programs as a user does, and returns what comes of it.
#pragma once

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

/// A program that is to be run in a folder.
struct Command {
  std::filesystem::path program;
  std::vector<std::string> arguments;
  std::filesystem::path folder;
  std::function<void()> before = {};  ///< called in the new process right before exec
  bool terminal = false;              ///< true if its stderr is a terminal
};

/// Exit status and output of a program.
struct Outcome {
  int status = 0;  ///< its exit status, or the negative number of the signal that ended it
  std::string out, err;
};

/// Tests whether the system can make a pseudo terminal; a bare chroot cannot.
inline bool has_terminals() {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0) return false;
  close(terminal);
  return true;
}

/// A running program. SIGALRM ends it after two minutes, so that no test hangs.
class Process {
 public:
  explicit Process(const Command& command) {
    std::array<int, 2> out{}, err{};
    check(pipe2(out.data(), O_CLOEXEC));
    if (command.terminal)
      open_terminal(err);
    else
      check(pipe2(err.data(), O_CLOEXEC));
    out_ = out[0];
    err_ = err[0];
    pid_ = check(fork());
    if (pid_ == 0) become(command, out[1], err[1]);
    close(out[1]);
    close(err[1]);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (pid_ == 0) return;
    kill(pid_, SIGKILL);
    wait();
  }

  void send(int signal) const { check(kill(pid_, signal)); }

  /// Waits until the program has made a second thread, as a stage does once it listens to signals, or is
  /// done.
  void wait_for_thread() const {
    const std::filesystem::path threads = "/proc/" + std::to_string(pid_) + "/task";
    siginfo_t done{};
    do {
      usleep(500);
      check(waitid(P_PID, static_cast<id_t>(pid_), &done, WEXITED | WNOHANG | WNOWAIT));
    } while (done.si_pid == 0 && std::distance(std::filesystem::directory_iterator(threads), {}) < 2);
  }

  /// Reads the program's output until it is done.
  Outcome wait() {
    Outcome outcome;
    std::array<pollfd, 2> streams{{{out_, POLLIN, 0}, {err_, POLLIN, 0}}};
    while (streams[0].fd >= 0 || streams[1].fd >= 0) {
      check(poll(streams.data(), streams.size(), -1));
      if (streams[0].revents) read_some(streams[0].fd, outcome.out);
      if (streams[1].revents) read_some(streams[1].fd, outcome.err);
    }
    int status = 0;
    check(waitpid(std::exchange(pid_, 0), &status, 0));
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    return outcome;
  }

 private:
  static int check(int result) {
    if (result < 0) throw std::system_error(errno, std::generic_category(), "running a program");
    return result;
  }

  /// Opens a pseudo terminal: output to the second end can be read from the first.
  static void open_terminal(std::array<int, 2>& ends) {
    ends[0] = check(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    check(grantpt(ends[0]));
    check(unlockpt(ends[0]));
    ends[1] = check(open(ptsname(ends[0]), O_RDWR | O_NOCTTY | O_CLOEXEC));
  }

  /// Becomes the program, in the new process. Settings with which the tests were started, such as ignored
  /// signals, are not passed on.
  [[noreturn]] static void become(const Command& command, int out, int err) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    alarm(120);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    if (chdir(command.folder.c_str()) != 0) _exit(127);
    std::string name = command.program.string();
    std::vector<std::string> arguments = command.arguments;
    std::vector<char*> argv{name.data()};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    if (command.before) command.before();
    execv(name.c_str(), argv.data());
    _exit(127);
  }

  /// Appends the available bytes. At the end of the stream, which a terminal reports as an error, closes it.
  static void read_some(int& stream, std::string& text) {
    std::array<char, 1 << 16> bytes{};
    const ssize_t count = read(stream, bytes.data(), bytes.size());
    if (count > 0) {
      text.append(bytes.data(), static_cast<std::size_t>(count));
    } else {
      close(stream);
      stream = -1;
    }
  }

  int out_ = -1, err_ = -1;
  pid_t pid_ = 0;
};

inline Outcome run(const Command& command) { return Process(command).wait(); }

/// Returns the command for a stage of this build, to be run in a folder.
inline Command stage(const std::string& name, std::vector<std::string> arguments,
                     const std::filesystem::path& folder) {
  return {.program = std::filesystem::path(PROTOSTAR_BINARY_DIR) / "stages" / name,
          .arguments = std::move(arguments),
          .folder = folder};
}

/// Returns the words of a line, separated by spaces.
inline std::vector<std::string> words(const std::string& line) {
  std::vector<std::string> all;
  for (std::size_t end = 0, begin = 0; begin < line.size(); begin = end + 1) {
    end = std::min(line.find(' ', begin), line.size());
    if (end > begin) all.push_back(line.substr(begin, end - begin));
  }
  return all;
}

/// Forbids this process, and the program that it becomes, to start threads, as if the user had as many
/// processes as the system allows (ulimit -u). Root has no such limit, so the system calls are refused
/// instead.
inline void forbid_threads() {
  constexpr unsigned char load = BPF_LD | BPF_W | BPF_ABS, if_equal = BPF_JMP | BPF_JEQ | BPF_K,
                          if_set = BPF_JMP | BPF_JSET | BPF_K, answer = BPF_RET | BPF_K;
  constexpr unsigned thread_flag = 0x10000;  // CLONE_THREAD
  std::array<sock_filter, 8> rules{{{load, 0, 0, offsetof(seccomp_data, nr)},
                                    {if_equal, 0, 1, SYS_clone3},
                                    {answer, 0, 0, SECCOMP_RET_ERRNO | ENOSYS},  // its flags are in memory
                                    {if_equal, 0, 3, SYS_clone},
                                    {load, 0, 0, offsetof(seccomp_data, args)},
                                    {if_set, 0, 1, thread_flag},
                                    {answer, 0, 0, SECCOMP_RET_ERRNO | EAGAIN},
                                    {answer, 0, 0, SECCOMP_RET_ALLOW}}};
  const sock_fprog program{rules.size(), rules.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    _exit(126);
}
