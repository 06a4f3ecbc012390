// Tests of memory in large pages, if the system has them (large_pages.hpp).
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <protostar/large_pages.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "support/catch.hpp"

using namespace protostar;

TEST_CASE("a vector in large pages can be copied and moved and is aligned to 64 bytes") {
  for (const std::size_t size : {std::size_t{3}, std::size_t{1'000'000}}) {
    LargeVector<std::uint32_t> numbers(size);
    CHECK(reinterpret_cast<std::uintptr_t>(numbers.data()) % 64 == 0);
    std::iota(numbers.begin(), numbers.end(), 7u);
    LargeVector<std::uint32_t> others = numbers;
    others.resize(2 * size);
    const LargeVector<std::uint32_t> moved = std::move(numbers);
    CHECK(moved.size() == size);
    CHECK(std::equal(moved.begin(), moved.end(), others.begin()));
    CHECK(moved.back() == size + 6);
  }
}

// Linux marks memory with "hg" if large pages were requested for it.
TEST_CASE("large pages are requested for a vector that fills some, and for no other", "[linux]") {
  if (!std::filesystem::exists("/sys/kernel/mm/transparent_hugepage") ||
      !std::filesystem::exists("/proc/self/smaps")) {
    WARN("this system does not tell of large pages");
    return;
  }
  const auto is_asked_for = [](const void* memory) {
    const auto address = reinterpret_cast<std::uintptr_t>(memory);
    std::ifstream maps("/proc/self/smaps");
    bool is_here = false;
    for (std::string line; std::getline(maps, line);) {
      std::uintptr_t from = 0, to = 0;
      char dash = 0;
      if (std::istringstream head(line); head >> std::hex >> from >> dash >> to && dash == '-')
        is_here = from <= address && address < to;
      if (is_here && line.starts_with("VmFlags:")) return line.find(" hg") != std::string::npos;
    }
    FAIL("the address is nowhere");
    return false;
  };
  const LargeVector<char> large(std::size_t{40} << 20);
  const LargeVector<char> small(1000);
  CHECK(is_asked_for(large.data()));
  CHECK_FALSE(is_asked_for(small.data()));
}
