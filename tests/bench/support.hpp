// Shared parts of the benchmarks: a command line, times taken in turns, tables.
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace bench {

// ---- The command line

/// Options --csv FILE --threads N --runs N --quick; and --mesh
/// FILE, for that of meshes.
struct Options {
  std::string csv, mesh;  ///< empty: no file
  int threads = 1;
  int runs = 9;        ///< minimum for each work; the median counts
  bool quick = false;  ///< one run of little work, to test that the program runs at all

  Options(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
      const std::string name = argv[i];
      if (name == "--quick") {
        quick = true;
        runs = 1;
        continue;
      }
      if (i + 1 == argc) throw std::invalid_argument(name + " is no option, or needs a value");
      const std::string value = argv[++i];
      if (name == "--csv")
        csv = value;
      else if (name == "--mesh")
        mesh = value;
      else if (name == "--threads")
        threads = count(name, value);
      else if (name == "--runs")
        runs = count(name, value);
      else
        throw std::invalid_argument("no such option: " + name);
    }
  }

 private:
  static int count(const std::string& name, const std::string& value) {
    const bool is_number = value.find_first_not_of("0123456789") == std::string::npos && value.size() < 7;
    const int number = is_number && !value.empty() ? std::stoi(value) : 0;
    if (number < 1) throw std::invalid_argument(name + " needs a whole number of at least 1, not " + value);
    return number;
  }
};

/// Runs a benchmark and returns the program's exit status.
inline int run(int argc, char** argv, void (*benchmark)(const Options&)) {
  try {
    benchmark(Options(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

// ---- Time

using Work = std::function<void()>;

/// Returns the processor time of this program and of those that it started and waited for.
inline double processor_seconds() {
  rusage own{}, children{};
  getrusage(RUSAGE_SELF, &own);
  getrusage(RUSAGE_CHILDREN, &children);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(own.ru_utime) + seconds(own.ru_stime) + seconds(children.ru_utime) +
         seconds(children.ru_stime);
}

/// Returns the elapsed time, or the processor time if it is less: then others kept the program waiting.
inline double seconds_of(const Work& work) {
  const double processor = processor_seconds();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  return std::min(passed.count(), processor_seconds() - processor);
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Times of several works that were run in turns, A B C A B C, so that whatever else the machine does slows
/// all of them alike. Ratios are taken within a turn; their median counts.
class Times {
 public:
  /// Runs as many turns as the options say; more of short works, which are disturbed more easily, and no more
  /// than three of long ones.
  Times(const Options& options, const std::vector<Work>& works) : seconds_(works.size()) {
    for (const Work& work : works) work();  // caches, pages and tables are warm from here on
    constexpr double enough = 0.5, plenty = 10;
    double total = 0;
    const auto go_on = [&](int turns) {
      if (turns < options.runs) return turns < 3 || total < plenty;
      return total < enough && turns < 20 * options.runs && !options.quick;
    };
    for (int turns = 0; go_on(turns); ++turns)
      for (std::size_t i = 0; i < works.size(); ++i) {
        seconds_[i].push_back(seconds_of(works[i]));
        total += seconds_[i].back();
      }
  }

  /// Returns the times of one work, one for each turn.
  [[nodiscard]] const std::vector<double>& operator[](std::size_t i) const { return seconds_[i]; }

  [[nodiscard]] double seconds(std::size_t i) const { return median(seconds_[i]); }

  /// Returns the time of the least disturbed turn, for works that differ in how much of the machine they
  /// need.
  [[nodiscard]] double shortest(std::size_t i) const { return *std::ranges::min_element(seconds_[i]); }

  /// Returns the time of one work relative to another's.
  [[nodiscard]] double ratio(std::size_t i, std::size_t to) const {
    std::vector<double> ratios;
    for (std::size_t run = 0; run < seconds_[i].size(); ++run)
      ratios.push_back(seconds_[i][run] / seconds_[to][run]);
    return median(ratios);
  }

 private:
  std::vector<std::vector<double>> seconds_;
};

/// Makes the compiler believe that a value is used.
template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

/// Calls work(begin, end) for parts of [0, count), by several threads that each take the next part. One
/// thread is the caller's.
inline void in_parts(std::size_t count, int threads, const auto& work) {
  constexpr std::size_t part = 4096;
  std::atomic<std::size_t> next = 0;
  const auto take = [&] {
    for (std::size_t begin = next.fetch_add(part); begin < count; begin = next.fetch_add(part))
      work(begin, std::min(begin + part, count));
  };
  std::vector<std::jthread> helpers;  // joined at the end
  for (int i = 1; i < threads; ++i) helpers.emplace_back(take);
  take();
}

// ---- Tables

/// Returns a number with some significant digits, without an exponent if possible.
inline std::string number(double value, int digits = 3) {
  char text[32];
  const double size = std::abs(value);
  if (size >= std::pow(10, digits) && size < 1e12)
    std::snprintf(text, sizeof text, "%.0f", value);
  else
    std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// Table that is printed row by row, and also written to a CSV file, where an empty line separates it from
/// the one before.
class Table {
 public:
  using Cells = std::vector<std::string>;

  Table(const Options& options, const Cells& columns) {
    static bool first = true;  // a program's first table begins a new file
    if (!first) std::printf("\n");
    if (!options.csv.empty()) {
      csv_.open(options.csv, first ? std::ios::trunc : std::ios::app);
      if (!first) csv_ << '\n';
      path_ = options.csv;
    }
    first = false;
    for (const std::string& column : columns) widths_.push_back(std::max<std::size_t>(column.size(), 7));
    widths_.front() = 34;
    row(columns);
  }

  void row(const Cells& cells) {
    std::string line, values;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::size_t width = widths_.at(i);
      const std::string space(width > cells[i].size() ? width - cells[i].size() : 0, ' ');
      line += i == 0 ? cells[i] + space : "  " + space + cells[i];
      values += (i == 0 ? "" : ",") + (cells[i].find(',') == cells[i].npos ? cells[i] : '"' + cells[i] + '"');
    }
    std::printf("%s\n", line.substr(0, line.find_last_not_of(' ') + 1).c_str());
    std::fflush(stdout);
    if (path_.empty()) return;
    csv_ << values << std::endl;
    if (!csv_) throw std::runtime_error(path_ + ": cannot be written");
  }

 private:
  std::vector<std::size_t> widths_;
  std::ofstream csv_;
  std::string path_;
};

}  // namespace bench
