// Random numbers, the same in every run and with every standard library.
#pragma once

#include <cstdint>
#include <protostar/ray.hpp>
#include <protostar/vec3.hpp>
#include <random>

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed), seed_(seed) {}

  std::uint64_t bits() { return ++drawn_, engine_(); }

  std::uint64_t seed() const { return seed_; }

  /// Returns how many numbers have been drawn so far.
  std::uint64_t drawn() const { return drawn_; }

  /// Returns a number in [min, max).
  double real(double min, double max) {
    return min + (max - min) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  }

  /// Returns a number in (0, 1), as samplers give them: an odd multiple of 2^-33.
  double interior() { return (static_cast<double>(bits() >> 32) + 0.5) * 0x1p-32; }

  /// Returns a point in the cube [−size, size)³.
  protostar::Point point(double size) { return {real(-size, size), real(-size, size), real(-size, size)}; }

  /// Returns a whole number from −size to size.
  std::int64_t whole(std::int64_t size) {
    return static_cast<std::int64_t>(bits() % static_cast<std::uint64_t>(2 * size + 1)) - size;
  }

  protostar::Vec3 whole_vector(std::int64_t size) {
    const auto x = whole(size), y = whole(size), z = whole(size);
    return {x, y, z};
  }

  /// Returns a unit vector, no direction more likely than another.
  protostar::Vec3 direction() {
    for (;;) {
      const protostar::Vec3 v = point(1);
      if (const double r2 = dot(v, v); r2 > 0.01 && r2 <= 1) return normalize(v);
    }
  }

  protostar::Color color() { return protostar::Color{protostar::Vec3{real(0, 1), real(0, 1), real(0, 1)}}; }

 private:
  std::mt19937_64 engine_;
  std::uint64_t seed_, drawn_ = 0;
};
