// Finish: how the light of a picture becomes the numbers of its file.
#pragma once

#include <string>
#include <variant>

#include "../encode.hpp"
#include "../shown.hpp"
#include "../tone.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Treatment of the light of a picture that is drawn in parts, when they are merged, unless the user wants
/// another one. It is a property of the scene, and so the same in all parts.
struct Finish {
  double exposure = 1;
  Tone tone = Tone::clip;
  Transfer transfer = Gamma{2.2};
  bool plain = false;  ///< true if .ppm files hold decimal numbers

  /// Throws std::invalid_argument unless the exposure is a factor that expose takes, and a gamma one that
  /// Encoder takes.
  void validate() const {
    detail::require_exposure("Finish", exposure);
    detail::require_exponent("Finish", transfer);
  }

  /// Returns a description such as "exposure 1, tone clip, transfer srgb"; finishes that differ have
  /// different ones.
  [[nodiscard]] std::string text() const {
    const char* const tones[] = {"clip", "scale-pixel", "scale-image"};
    const auto* gamma = std::get_if<Gamma>(&transfer);
    return "exposure " + shown(exposure) + ", tone " + tones[static_cast<int>(tone)] + ", transfer " +
           (gamma                                    ? "gamma=" + shown(gamma->exponent)
            : std::holds_alternative<Srgb>(transfer) ? "srgb"
                                                     : "linear") +
           (plain ? ", plain" : "");
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
