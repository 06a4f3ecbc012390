// The choice of a sampler when a program runs, and the sampler that an integrator gets for each sample.
//
// Both hide the sampler's type behind functions, so that a render is compiled once for all samplers.
#pragma once

#include <cstdint>
#include <type_traits>

#include "../platform.hpp"
#include "../simd/simd.hpp"
#include "../simd/vectors.hpp"
#include "../simd/words.hpp"
#include "sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Choice of a sampler: sampler_of<SobolSampler>. The default makes no choice.
class SamplerChoice {
 public:
  constexpr SamplerChoice() = default;

  /// Chooses a type of sampler.
  template <Sampler S>
  [[nodiscard]] static constexpr SamplerChoice of() {
    SamplerChoice choice;
    choice.numbers_ = [](const SampleIndex& at, std::uint32_t set) { return S(at)(set); };
    choice.in_lanes_ = [](const SampleIndices& at, std::uint32_t set) { return SamplerInLanes<S>(at)(set); };
    choice.has_common_places_ = requires { typename S::HasCommonPlaces; };
    choice.needs_number_ = requires { typename S::NeedsNumber; };
    return choice;
  }

  /// Returns true if a sampler has been chosen.
  [[nodiscard]] constexpr bool is_made() const { return numbers_ != nullptr; }

  /// Returns true if the first two numbers of set 0 are the same in every pixel. A type of sampler declares
  /// this by a type HasCommonPlaces.
  [[nodiscard]] constexpr bool has_common_places() const { return has_common_places_; }

  /// Returns true if the numbers of a sample depend on how many samples there are, or even samples on odd
  /// ones, so that these tell no error. A type of sampler declares this by a type NeedsNumber.
  [[nodiscard]] constexpr bool needs_number() const { return needs_number_; }

  /// Returns the numbers of a set; a choice must have been made.
  [[nodiscard]] SampleSet<double> operator()(const SampleIndex& at, std::uint32_t set) const {
    return numbers_(at, set);
  }
  [[nodiscard]] SampleSet<simd::Doubles> operator()(const SampleIndices& at, std::uint32_t set) const {
    return in_lanes_(at, set);
  }

  friend constexpr bool operator==(const SamplerChoice& a, const SamplerChoice& b) {
    return a.numbers_ == b.numbers_;
  }

 private:
  SampleSet<double> (*numbers_)(const SampleIndex&, std::uint32_t) = nullptr;
  SampleSet<simd::Doubles> (*in_lanes_)(const SampleIndices&, std::uint32_t) = nullptr;
  bool has_common_places_ = false, needs_number_ = false;
};

/// Choice of the sampler S.
template <Sampler S>
inline constexpr SamplerChoice sampler_of = SamplerChoice::of<S>();

/// Sampler of one sample of a pixel, or in lanes of one sample of some pixels, whose type was chosen when the
/// program ran. Set 0 is taken by the place in the pixel and on the lens; an integrator takes sets from 1 on.
template <class Word>
class BasicPixelSampler {
 public:
  BasicPixelSampler(const SamplerChoice& choice, const BasicSampleIndex<Word>& at)
      : choice_(choice), at_(at) {}

  /// Returns the four numbers of a set, each between 0 and 1.
  [[nodiscard]] auto operator()(std::uint32_t set) const { return choice_(at_, set); }

  /// Returns the seed, the pixel in the whole picture, and which sample it is of how many.
  [[nodiscard]] const BasicSampleIndex<Word>& index() const { return at_; }

  /// Returns the sampler of the pixel in a lane.
  [[nodiscard]] auto operator[](int lane) const requires(!std::is_same_v<Word, std::uint32_t>) {
    return BasicPixelSampler<std::uint32_t>(choice_,
                                            {at_.seed, at_.x[lane], at_.y[lane], at_.sample, at_.samples});
  }

 private:
  SamplerChoice choice_;
  BasicSampleIndex<Word> at_;
};

/// Sampler that a function of a ray gets, and an integrator for a single ray.
using PixelSampler = BasicPixelSampler<std::uint32_t>;

/// Sampler that an integrator gets for a packet of rays.
using PacketSampler = BasicPixelSampler<simd::Words>;

/// Returns the sampler of a hit: the sampler itself if a function gets a single hit, or the sampler of the
/// pixel in a lane if it gets the hits of a packet and the lane.
template <class S>
[[nodiscard]] const S& sampler_in(const S& sampler) {
  return sampler;
}
[[nodiscard]] inline PixelSampler sampler_in(const PacketSampler& sampler, int lane) { return sampler[lane]; }

}  // namespace protostar::inline PROTOSTAR_ABI
