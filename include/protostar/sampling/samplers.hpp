// All samplers of the library, by their names.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "../platform.hpp"
#include "halton_sampler.hpp"
#include "hammersley_sampler.hpp"
#include "independent_sampler.hpp"
#include "pixel_sampler.hpp"
#include "sobol_sampler.hpp"
#include "stratified_sampler.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Names of the samplers, as the option --sampler has them.
inline constexpr std::array<std::string_view, 5> sampler_names = {"independent", "stratified", "halton",
                                                                  "sobol", "hammersley"};

/// Returns the sampler with a name, or nothing for another name.
[[nodiscard]] inline std::optional<SamplerChoice> sampler_named(std::string_view name) {
  constexpr SamplerChoice choices[] = {sampler_of<IndependentSampler>, sampler_of<StratifiedSampler>,
                                       sampler_of<HaltonSampler>, sampler_of<SobolSampler>,
                                       sampler_of<HammersleySampler>};
  for (std::size_t i = 0; i < sampler_names.size(); ++i)
    if (sampler_names[i] == name) return choices[i];
  return std::nullopt;
}

}  // namespace protostar::inline PROTOSTAR_ABI
