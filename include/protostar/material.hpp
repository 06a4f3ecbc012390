// Materials: how surfaces reflect and refract light.
#pragma once

#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

#include "magnitude.hpp"
#include "vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Color as a function of the surface coordinates u and v (uv_at). Any function of the two will do; it is
/// called from several threads at once.
using Texture = std::function<Color(double u, double v)>;

/// Texture of squares in two alternating colors. The one at 0 < u, v < size has the first; a line between two
/// belongs to the one on its greater side.
struct Checker {
  Color first{1}, second{0};
  double size = 1;  ///< side of a square, in units of u and v; a size (magnitude.hpp)

  [[nodiscard]] Color operator()(double u, double v) const {
    // The parity of whole numbers is taken in double, as no integer type may hold them.
    const double sum = std::floor(u / size) + std::floor(v / size);
    return sum - 2 * std::floor(sum / 2) == 0 ? first : second;
  }
};

/// Direction of the normal as a function of the surface coordinates u and v, in tangent space (normals.hpp):
/// x along u, y at a right angle to it on the side to which v grows, z along the surface's own normal. It has
/// any length and z > 0; (0, 0, 1) leaves the normal as it is. Any function of the two that returns a Vec3
/// will do; it is called from several threads at once, and copies share it.
class NormalMap {
 public:
  NormalMap() = default;  ///< without a function: surfaces keep their normals
  template <class F>
  requires(!std::same_as<F, NormalMap> && std::is_invocable_r_v<Vec3, const F&, double, double>)
      NormalMap(F function)
      : function_(std::make_shared<const std::function<Vec3(double, double)>>(std::move(function))) {
    if (!*function_) function_ = nullptr;  // an empty std::function is none
  }

  explicit operator bool() const { return function_ != nullptr; }

  /// Returns the function that is held if it is of type F, otherwise null.
  template <class F>
  [[nodiscard]] const F* target() const {
    return function_ ? function_->template target<F>() : nullptr;
  }
  [[nodiscard]] Vec3 operator()(double u, double v) const { return (*function_)(u, v); }

 private:
  std::shared_ptr<const std::function<Vec3(double, double)>> function_;
};

/// Lobe of a blurred mirror: GgxLobe, whose width is the roughness, or PhongLobe, whose exponent is the
/// shininess (sampling/glossy_lobes.hpp).
enum class Blur { ggx, phong };

/// Emission, reflection and refraction of a surface. By WhittedIntegrator the radiance that leaves a point is
///   emission + Σ over the lights (diffuse · E + specular · E⊥ · cos(r, v)^shininess)
///     + reflect · (radiance from the mirror direction) + refract · (radiance from the refracted direction)
/// with the irradiance E of a light and E⊥ without its cosine, and the angle between the mirror image r of
/// the direction to the light and the direction v to the eye (Phong). There are no other weights: the
/// materials of different ray tracers differ in their numbers alone. The comment of each other integrator has
/// its equation. DirectIntegrator and PathIntegrator take diffuse as the albedo, so that it reflects
/// diffuse/π · E, leave specular out and add the glossy lobe's reflection.
struct Material {
  Color diffuse{0};           ///< share of irradiance that is reflected alike in all directions
  Texture texture = {};       ///< replaces diffuse if it is not empty
  NormalMap normal_map = {};  ///< tilts the normals that light is reflected by, if it is not empty
  Color specular{0};
  double shininess = 50;
  double reflect = 0;
  double refract = 0;
  double ior = 1.5;   ///< index of refraction inside, the normal pointing outside; outside it is 1
  Color emission{0};  ///< radiance that the surface itself sends out, on both sides, alike in all directions
  Color glossy{0};    ///< blurred mirror: share that a sharp one reflects at normal incidence; black: none
  double roughness = 0.5;  ///< of the blurred mirror, from 0, sharp, to 1 (GgxLobe)
  Blur blur = Blur::ggx;   ///< lobe of the blurred mirror

  /// Largest shininess of a blurred mirror by Phong's lobe, about 10^9: the error of its numbers, in
  /// proportion to the exponent, is then below 2^-20. The lobe is as narrow as 2^-15 radians.
  static constexpr double most_shininess_of_blur = 0x1p30;

  /// Throws std::invalid_argument, with the number that was found, if a number is negative or not finite
  /// (reflect and refract as floats), if roughness is not from 0 to 1, if the shininess of a blurred mirror
  /// by Phong's lobe is above most_shininess_of_blur, if ior or the size of a Checker is no size
  /// (magnitude.hpp), or if a color of a Checker is negative or not finite. Other textures are not checked.
  void validate() const {
    const auto check = [](bool holds, const char* rule, const auto& found) {
      if (!holds) detail::refuse_found(rule, found);
    };
    const auto check_light = [&](const Color& c, const char* rule) { check(is_light(c), rule, Vec3(c)); };
    const auto is_share = [](double x) { return x >= 0 && std::isfinite(x); };
    const auto is_factor = [](double x) { return x >= 0 && x <= std::numeric_limits<float>::max(); };
    if (const auto* checker = texture.target<Checker>()) {
      check_light(checker->first, "Checker: first color must be finite and not negative");
      check_light(checker->second, "Checker: second color must be finite and not negative");
      check(is_size(checker->size), "Checker: size must be from 2^-400 (3.9e-121) to 2^400 (2.6e120)",
            checker->size);
    }
    check_light(diffuse, "Material: diffuse color must be finite and not negative");
    check_light(emission, "Material: emission must be finite and not negative");
    check_light(specular, "Material: specular color must be finite and not negative");
    check(is_share(shininess), "Material: shininess must be finite and not negative", shininess);
    check(is_factor(reflect), "Material: reflect must be finite as a float and not negative", reflect);
    check(is_factor(refract), "Material: refract must be finite as a float and not negative", refract);
    check_light(glossy, "Material: glossy color must be finite and not negative");
    check(roughness >= 0 && roughness <= 1, "Material: roughness must be from 0 to 1", roughness);
    check(blur != Blur::phong || shininess <= most_shininess_of_blur,
          "Material: shininess of a blurred mirror must be at most 2^30", shininess);
    check(is_size(ior), "Material: ior must be from 2^-400 (3.9e-121) to 2^400 (2.6e120)", ior);
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI
