// Check that what has been prepared of a scene is used with that scene.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "scene.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Identity of a scene when data such as its area lights were derived from it: the address of its lights and
/// its number of surfaces. Surfaces replaced in equal number, and added lights, are not noticed.
class SceneIdentity {
 public:
  template <Surface... S>
  explicit SceneIdentity(const Scene<S...>& scene) : lights_(&scene.lights()), surfaces_(scene.size()) {}

  /// Throws std::logic_error if the scene, or the scene behind a view, is not the recorded one or, for
  /// arguments with size(), has another number of surfaces. `prepared` begins the message and is a plural
  /// noun, such as "AreaLights".
  void require(const auto& scene, const char* prepared) const {
    bool is_same = static_cast<const void*>(&scene.lights()) == lights_;
    if constexpr (requires { scene.size(); }) is_same = is_same && scene.size() == surfaces_;
    if (!is_same) [[unlikely]]
      throw std::logic_error(std::string(prepared) +
                             ": the scene is not the one of which they were made, or has been moved or given "
                             "other surfaces since; make them again");
  }

 private:
  const void* lights_;  ///< address of the scene's lights, which its views have as well
  std::size_t surfaces_;
};

}  // namespace protostar::inline PROTOSTAR_ABI
