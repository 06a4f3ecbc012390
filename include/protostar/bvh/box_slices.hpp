// Sums of boxes in the slices of a range along each axis: the bins of the surface area heuristic.
#pragma once

#include <algorithm>
#include <cstdint>

#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "box_space.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Box around the primitives of a slice, and their number.
struct Slice {
  Box box;
  std::uint32_t count;

  static Slice nothing() { return {Box::nothing(), 0}; }
  void add(const Slice& other) {
    box.add(other.box);
    count += other.count;
  }
};

/// Largest number of slices on an axis.
inline constexpr int most_slices = 16;

/// Slices on each of the three axes.
struct Slices {
  int count;  ///< number on each axis
  Slice on[3][most_slices];

  Slices() = default;
  explicit Slices(int slices) : count(slices) {
    for (auto& slice : on) std::fill(slice, slice + count, Slice::nothing());
  }
  void add(const Slices& other) {
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < count; ++k) on[axis][k].add(other.on[axis][k]);
  }
};

/// Position of centers among the slices; all are given twice as large (Box::twice_center). It is finite: the
/// step is 0 if they are no farther apart than 2^-100.
struct Slicing {
  int count;
  Float4 start, step;

  Slicing(const Box& centers, int slices) : count(slices), start(centers.min) {
    const Float4 size = centers.max - centers.min;
    // A little less than the number of slices, so that the largest center falls into the last slice.
    const Float4 most = static_cast<float>(slices) * (1 - 0x1p-20f);
    step = select(size > Float4(0x1p-100f), most / size, Float4(0));
  }
  [[nodiscard]] Float4 place(const Box& box) const { return (box.twice_center() - start) * step; }
};

}  // namespace protostar::inline PROTOSTAR_ABI::simd
