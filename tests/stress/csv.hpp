// CSV file that a stress program writes beside the table that it prints, if the option --csv names one.
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>

class CsvFile {
 public:
  /// Opens the file and writes the names of its columns; does nothing if the path is empty.
  CsvFile(const std::string& path, const char* columns) : path_(path) {
    if (path.empty()) return;
    file_.open(path);
    file_ << columns << '\n';
    check();
  }

  template <class First, class... Others>
  void row(const First& first, const Others&... others) {
    if (path_.empty()) return;
    file_ << first;
    ((file_ << ',' << others), ...) << '\n';
    file_.flush();
    check();
  }

 private:
  void check() const {
    if (!file_) throw std::runtime_error(path_ + ": cannot be written");
  }

  std::string path_;
  std::ofstream file_;
};
