// Tests of vectors of elements that are copied byte by byte, and of large pages, if the system has them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <protostar/plain_vector.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"

using namespace protostar;

namespace {

/// Returns true if the first element has an address that is a multiple of a number.
template <class T>
bool is_aligned(const PlainVector<T>& vector, std::uintptr_t to) {
  return reinterpret_cast<std::uintptr_t>(vector.data()) % to == 0;
}

}  // namespace

TEST_CASE("vectors of few bytes are aligned as their elements, and others to 64 bytes") {
  struct alignas(32) Wide {
    float numbers[8];
  };
  PlainVector<Wide> wide[16];
  PlainVector<std::uint32_t> longer[16];
  for (auto& vector : wide) CHECK((vector.resize(1), is_aligned(vector, alignof(Wide))));
  for (auto& vector : longer) CHECK((vector.resize(65), is_aligned(vector, 64)));
}

TEST_CASE("a vector in large pages can be copied and moved") {
  for (const std::size_t size : {std::size_t{3}, std::size_t{1'000'000}}) {
    PlainVector<std::uint32_t> numbers(size);
    std::iota(numbers.begin(), numbers.end(), 7u);
    PlainVector<std::uint32_t> others = numbers;
    others.resize(2 * size);
    const PlainVector<std::uint32_t> moved = std::move(numbers);
    CHECK(moved.size() == size);
    CHECK(std::equal(moved.begin(), moved.end(), others.begin()));
    CHECK(moved.back() == size + 6);
  }
}

TEST_CASE("the surfaces and materials of a scene are in large pages if they fill one") {
  Scene<Sphere> scene;
  for (std::size_t i = 0; i < detail::large_page / sizeof(Sphere); ++i)
    scene.add(Sphere{{0, 0, 0}, 1}, Color{1});
  CHECK(reinterpret_cast<std::uintptr_t>(scene.surfaces<Sphere>().data()) % detail::large_page == 0);
  CHECK(reinterpret_cast<std::uintptr_t>(scene.materials<Sphere>().data()) % detail::large_page == 0);
}

TEST_CASE("a vector of a scene is in large pages if it fills one, and so is its copy") {
  SceneVector<double> few(3), many(std::size_t{1} << 19);
  CHECK(reinterpret_cast<std::uintptr_t>(many.data()) % detail::large_page == 0);
  const SceneVector<double> copy = many;
  CHECK(reinterpret_cast<std::uintptr_t>(copy.data()) % detail::large_page == 0);
  CHECK(copy == many);
  few.push_back(1);
  CHECK(few.size() == 4);
}

TEST_CASE("a vector grows, shrinks, and compares as std::vector does") {
  PlainVector<int> numbers;
  std::vector<int> expected;
  CHECK(numbers.empty());
  for (int i = 0; i < 1000; ++i) {
    CHECK(numbers.push_back(i) == i);
    expected.push_back(i);
  }
  numbers.push_back(numbers[3]), expected.push_back(expected[3]);
  numbers.resize(3000, numbers[7]), expected.resize(3000, 7);
  CHECK(std::equal(numbers.begin(), numbers.end(), expected.begin(), expected.end()));
  PlainVector<int> copy(5, 1);
  copy = numbers;
  CHECK(copy == numbers);
  copy[2999] = 8;
  CHECK_FALSE(copy == numbers);
  copy.resize(10);
  CHECK_FALSE(copy == numbers);
  CHECK(copy.back() == 9);
  numbers = std::move(copy);
  CHECK(numbers.size() == 10);
  CHECK(copy.empty());
  numbers.clear();
  CHECK(numbers.empty());
  CHECK_THROWS_AS(numbers.resize(static_cast<std::size_t>(-1) / 8), std::length_error);
}

TEST_CASE("elements of a vector that have initial values get them") {
  struct Initial {
    int x = 7;
  };
  PlainVector<Initial> all(3);
  CHECK(all.back().x == 7);
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
  const PlainVector<char> large(std::size_t{40} << 20);
  const PlainVector<char> small(1000);
  CHECK(is_asked_for(large.data()));
  CHECK_FALSE(is_asked_for(small.data()));
}
