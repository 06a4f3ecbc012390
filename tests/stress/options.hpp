// Command lines of the stress programs that take numbers: --name value, nothing else.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <string>

class Options {
 public:
  Options(int argc, char** argv, std::initializer_list<std::string> names) {
    for (const std::string& name : names) values_[name];
    for (int i = 1; i < argc; i += 2) {
      const auto option = values_.find(argv[i]);
      if (option == values_.end()) throw std::invalid_argument("no such option: " + std::string(argv[i]));
      if (i + 1 == argc) throw std::invalid_argument(option->first + " needs a value");
      option->second = argv[i + 1];
    }
  }

  [[nodiscard]] const std::string& text(const std::string& name) const { return values_.at(name); }

  [[nodiscard]] std::uint64_t number(const std::string& name, std::uint64_t otherwise) const {
    const std::string& value = text(name);
    if (value.empty()) return otherwise;
    std::size_t used = 0;
    const std::uint64_t number = value[0] >= '0' && value[0] <= '9' ? std::stoull(value, &used) : 0;
    if (used != value.size()) throw std::invalid_argument(name + " needs a whole number, not " + value);
    return number;
  }

 private:
  std::map<std::string, std::string> values_;
};
