// Samplers: values that give the numbers by which light is chosen at random.
//
// A sampler belongs to one sample of one pixel. It has no state: sampler(set) gives four numbers between 0
// and 1, which are a function of its SampleIndex (seed, pixel, sample, and their number) and the set. They
// depend on no thread, no order and no machine, and a part of a picture has the same numbers as the whole.
//
// Numbers come in sets of four, since numbers of one set are spread evenly together, and those of two sets
// are not: set 0 is for the place in the pixel and on the lens, and set k for vertex k of the path, two
// numbers for the direction and two for the light. There are as many sets as a path needs. The last set is
// for the time, so that place and lens stay in one set of four.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../simd/words.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Sample of a pixel, or of one pixel in each lane.
template <class Word>
struct BasicSampleIndex {
  std::uint64_t seed = 0;
  Word x = 0, y = 0;          ///< the pixel
  std::uint32_t sample = 0;   ///< from 0 to samples − 1
  std::uint32_t samples = 1;  ///< how many samples the pixel gets in all
};
using SampleIndex = BasicSampleIndex<std::uint32_t>;

/// The same sample of as many pixels as there are lanes.
using SampleIndices = BasicSampleIndex<simd::Words>;

/// Four numbers in the open interval (0, 1): doubles, or a double in each lane.
template <class Number>
using SampleSet = std::array<Number, 4>;

/// Set whose first number is the time at which a camera's shutter lets a ray pass. No path is so long that it
/// takes the set.
inline constexpr std::uint32_t set_of_time = 0xffffffff;

/// Type that gives the numbers of a sample. Its numbers have to be functions of the sample's index and the
/// set alone.
template <class S>
concept Sampler = std::copyable<S> && std::constructible_from<S, const SampleIndex&> &&
    requires(const S& sampler, std::uint32_t set) {
  { sampler(set) } -> std::same_as<SampleSet<double>>;
};

/// A sampler of any type in each lane, asked lane by lane.
template <Sampler S>
class LaneByLane {
 public:
  explicit LaneByLane(const SampleIndices& at)
      : samplers_([&]<std::size_t... lane>(std::index_sequence<lane...>) {
          return std::array{S(lane_of(at, static_cast<int>(lane)))...};
        }(std::make_index_sequence<simd::double_lanes>())) {}

  [[nodiscard]] SampleSet<simd::Doubles> operator()(std::uint32_t set) const {
    SampleSet<simd::Doubles> numbers;
    for (int lane = 0; lane < simd::double_lanes; ++lane) {
      const SampleSet<double> of_lane = samplers_[static_cast<std::size_t>(lane)](set);
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i].set(lane, of_lane[i]);
    }
    return numbers;
  }

 private:
  static SampleIndex lane_of(const SampleIndices& at, int lane) {
    return {at.seed, at.x[lane], at.y[lane], at.sample, at.samples};
  }

  std::array<S, simd::double_lanes> samplers_;
};

namespace detail {

template <class S>
struct InLanes {
  using type = LaneByLane<S>;
};
template <template <class> class BasicSampler>
struct InLanes<BasicSampler<std::uint32_t>> {
  using type = BasicSampler<simd::Words>;
};

}  // namespace detail

/// Type of a sampler with a pixel in each lane, made from SampleIndices; its numbers are simd::Doubles, and
/// in each lane those that S has for that pixel. For the library's samplers it is the same template for
/// another type of word; for others each lane has a sampler of its own.
template <Sampler S>
using SamplerInLanes = typename detail::InLanes<S>::type;

/// Number of independent scramblings between which the samples of a pixel are dealt out in turn by samplers
/// whose points depend on each other.
///
/// A single scrambled set of points tells nothing of its error; two tell it by their difference, and it has
/// to be possible to stop at any time. The price is the error of two halves that know nothing of each other:
/// if n points have a standard error c · n^-a, two means of n/2 have one of c · n^-a · 2^(a − ½) together.
/// This is 1.19 times as much at an edge (a = ¾), 1.9 times for smooth light in four dimensions (a = 1.4),
/// and nothing for independent numbers (a = ½).
inline constexpr std::uint32_t scramblings = 2;

/// Returns the scrambling that a sample belongs to, in which its index is sample / scramblings.
[[nodiscard]] constexpr std::uint32_t scrambling_of(std::uint32_t sample) { return sample % scramblings; }

}  // namespace protostar::inline PROTOSTAR_ABI
