// The triangles in the leaves of a BVH, tested in double, as many at once as a vector holds: which of them a
// ray surely misses, which it surely crosses, and where (numeric/planar_equation.hpp).
//
// A ray meets few leaves, and fetching one from far away takes nearly all of the time. Therefore a leaf has
// all numbers of its triangles in one place. If float holds all numbers of the tree, as those of files mostly
// allow, they are kept in float, which takes half the memory; the results are the same.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "../bvh/bvh.hpp"
#include "../bvh/node.hpp"
#include "../plain_vector.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "triangle.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Numbers of the triangles of a tree, leaf by leaf.
class TriangleLeaves {
  /// Returns f(the numbers), whether they are float or double.
  decltype(auto) with_rows(const auto& f) const {
    return floats_.empty() ? f(doubles_.data()) : f(floats_.data());
  }

 public:
  /// Place of a triangle's numbers: a.x, a.y, a.z, b.x, ..., and its index, each `step` after the one before;
  /// the step is the number of triangles in the leaf.
  struct Place {
    std::uint32_t first, step;
  };

  /// Stores triangle(i), for all i in the tree, in the order of the leaves.
  TriangleLeaves(const Bvh& bvh, const auto& triangle, const RenderOptions& options) {
    if (!fill(floats_, bvh, triangle, options)) {
      floats_ = {};
      fill(doubles_, bvh, triangle, options);
    }
  }

  [[nodiscard]] static Place place(Leaf leaf, std::uint32_t i) { return {rows * leaf.first + i, leaf.count}; }

  [[nodiscard]] Triangle triangle(Place place) const {
    return with_rows([&](const auto* all) {
      const auto corner = [&](std::size_t k) {
        const auto* const row = all + place.first + k * place.step;
        return Point{row[0], row[place.step], row[2 * std::size_t{place.step}]};
      };
      return Triangle{corner(0), corner(3), corner(6)};
    });
  }

  /// Returns the index of the triangle.
  [[nodiscard]] std::uint32_t number(Place place) const {
    return with_rows([&](const auto* all) {
      std::uint32_t number;
      std::memcpy(&number, all + place.first + std::size_t{place.step} * (rows - 1), sizeof number);
      return number;
    });
  }

  /// Returns the corners of the triangles from the i-th of a leaf on, as many as a vector holds; lanes behind
  /// the last triangle have any numbers.
  [[nodiscard, gnu::always_inline]] std::array<Vectors, 3> corners(Leaf leaf, std::uint32_t i) const {
    std::array<Vectors, 3> corners;
    with_rows([&](const auto* all) {
      const auto* const row = all + place(leaf, i).first;
      const auto numbers = [&](std::size_t k) { return load(row + k * leaf.count); };
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = {numbers(3 * k), numbers(3 * k + 1), numbers(3 * k + 2)};
    });
    return corners;
  }

  /// Prefetches the numbers of a leaf that is likely to be visited.
  template <Read read>
  void fetch(Leaf leaf) const {
    with_rows([&](const auto* all) {
      constexpr std::size_t line = 64 / sizeof *all;
      const auto* const row = all + place(leaf, 0).first;
      const std::size_t count = rows * leaf.count;
      for (std::size_t i = 0; i < count; i += line) prefetch<read>(row + i);
      prefetch<read>(row + count - 1);  // a leaf may begin inside a line, and then ends in one more
    });
  }

  /// Results for triangles: bit and lane k are the k-th of those tested.
  struct Tried {
    Bits crossed;   ///< crossed inside the range for sure, at t
    Bits in_doubt;  ///< maybe crossed inside the range
    Doubles t;
  };

  /// Tests the triangles from the i-th of a leaf on, as many as a vector holds, along the line of a ray. No
  /// crossing is certain if the ray departs from a plane, which may be that of a triangle.
  [[nodiscard, gnu::always_inline]] Tried tried(Leaf leaf, std::uint32_t i, const Ray& ray,
                                                const RoundedLine& line, const Interval& range) const {
    const auto [a, b, c] = corners(leaf, i);
    const auto on_each_axis = [](const Vec3& error) {
      const Doubles largest = std::max({error.x, error.y, error.z});
      return Vectors(largest, largest, largest);
    };
    const struct {
      Vectors origin, direction, origin_error, direction_error;
    } lines{line.origin, line.direction, on_each_axis(line.origin_error), on_each_axis(line.direction_error)};
    const auto e = triangle_equation(lines, a, b, c);
    const Bits passed = bits(!e.misses) & first_bits(static_cast<int>(leaf.count - i));
    if (passed == 0) return {.crossed = 0, .in_doubt = 0, .t = {}};
    // The margin is that of lies_inside.
    const Doubles t = e.height / e.slope, margin = 2 * Roots::relative_error * abs(t);
    const auto known = e.crosses && e.is_certain && margin < Doubles(infinity);
    const auto inside = known && t - margin > Doubles(range.min) && t + margin < Doubles(range.max);
    const auto outside = known && !(t + margin > Doubles(range.min) && t - margin < Doubles(range.max));
    const Bits crossed = ray.departure.is_planar() ? 0 : passed & bits(inside);
    return {.crossed = crossed, .in_doubt = passed & ~crossed & bits(!outside), .t = t};
  }

 private:
  static constexpr std::uint32_t rows = 10;

  static Doubles load(const double* from) { return Doubles::load(from); }
  static Doubles load(const float* from) { return to_double(Floats::load(from)); }

  /// Returns true if a T holds all numbers; if not, some have not been stored.
  template <class T>
  static bool fill(PlainVector<T>& all, const Bvh& bvh, const auto& triangle, const RenderOptions& options) {
    const std::size_t count = rows * bvh.order().size();
    all = PlainVector<T>(count + double_lanes);
    std::fill_n(&all[count], double_lanes, T{0});  // padding, read behind the last triangle
    std::atomic<bool> holds = true;
    const auto fill_leaf = [&](Leaf leaf) {
      if (!holds.load(std::memory_order_relaxed)) return;
      // Reads all triangles first, which come from anywhere in memory: several are waited for at a time.
      Point corners[largest_leaf][3];
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        const Triangle one = triangle(bvh.order()[leaf.first + i]);
        corners[i][0] = one.a, corners[i][1] = one.b, corners[i][2] = one.c;
      }
      for (std::uint32_t i = 0; i < leaf.count; ++i) {
        T* row = &all[place(leaf, i).first];
        for (const Point& corner : corners[i])
          for (int axis = 0; axis < 3; ++axis, row += leaf.count) {
            *row = static_cast<T>(corner[axis]);
            if (*row != corner[axis]) holds = false;
          }
        *row = 0;
        std::memcpy(row, &bvh.order()[leaf.first + i], sizeof(std::uint32_t));
      }
    };
    bvh.each_leaf(fill_leaf, options);
    return holds;
  }

  /// Numbers of each leaf, from rows · first on: all a.x, all a.y, ..., all c.z, and the bits of the
  /// triangles' indices. One of these is empty.
  PlainVector<float> floats_;
  PlainVector<double> doubles_;
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd
