// The last scene of Peter Shirley, Trevor David Black and Steve Hollasch, "Ray Tracing in One Weekend": three
// large balls among some hundreds of small ones, each of a material drawn by chance.
#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <protostar/camera.hpp>
#include <protostar/numeric/trigonometry.hpp>
#include <protostar/scene.hpp>
#include <protostar/surfaces/parallelogram.hpp>
#include <protostar/surfaces/sphere.hpp>

/// Random numbers, the same on any machine: a linear congruential generator (Knuth's MMIX).
class WeekendNumbers {
 public:
  /// Returns a number from least to most.
  double operator()(double least, double most) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return least + (most - least) * (static_cast<double>(state_ >> 40) * 0x1p-24);
  }

 private:
  std::uint64_t state_ = 2016;
};

/// Calls glass(sphere), metal(sphere, color, fuzz) or matte(sphere, color) for each ball, the ground first.
/// The sky is all that shines. The book's metal with fuzz scatters a mirrored ray by a random
/// vector that is as long as the fuzz.
inline void weekend_balls(const auto& glass, const auto& metal, const auto& matte) {
  using protostar::Color, protostar::Point, protostar::Sphere;
  WeekendNumbers random;
  const auto color = [&](double least) {
    const auto channel = [&] { return static_cast<float>(random(least, 1)); };
    const float r = channel(), g = channel(), b = channel();
    return Color{r, g, b};
  };
  matte(Sphere{{0, -1000, 0}, 1000}, Color{0.5f});
  for (int a = -11; a < 11; ++a)
    for (int b = -11; b < 11; ++b) {
      const double chosen = random(0, 1), dx = random(0, 0.9), dz = random(0, 0.9);
      const Sphere small{{a + dx, 0.2, b + dz}, 0.2};
      if (length(small.center - Point{4, 0.2, 0}) <= 0.9) continue;  // it would touch the third large ball
      if (chosen < 0.8) {
        const Color one = color(0);
        matte(small, one * color(0));
      } else if (chosen < 0.95) {
        const Color light = color(0.5);
        metal(small, light, random(0, 0.5));
      } else {
        glass(small);
      }
    }
  glass(Sphere{{0, 1, 0}, 1});
  matte(Sphere{{-4, 1, 0}, 1}, Color{0.4f, 0.2f, 0.1f});
  metal(Sphere{{4, 1, 0}, 1}, Color{0.7f, 0.6f, 0.5f}, 0.0);
}

/// The light from a unit direction: white at the nadir, blue at the zenith, and between them in proportion to
/// the height.
inline protostar::Color weekend_sky(const protostar::Vec3& direction) {
  const auto blue = static_cast<float>(0.5 + 0.5 * direction.y);
  return protostar::Color{1 - 0.5f * blue, 1 - 0.3f * blue, 1};
}

/// Builds the scene, with the material metal(color, fuzz) for each ball of metal.
inline protostar::Scene<protostar::Sphere, protostar::Parallelogram> weekend_of(const auto& metal) {
  using protostar::Color, protostar::Material, protostar::Sphere;
  protostar::Scene<protostar::Sphere, protostar::Parallelogram> scene;
  weekend_balls(
      [&](const Sphere& ball) { scene.add(ball, Material{.refract = 1, .ior = 1.5}); },
      [&](const Sphere& ball, const Color& color, double fuzz) { scene.add(ball, metal(color, fuzz)); },
      [&](const Sphere& ball, const Color& color) { scene.add(ball, color); });
  scene.set_environment(weekend_sky);
  return scene;
}

/// Returns the roughness of a GgxLobe that, seen along the normal, reflects half of the rays into the same
/// angle around the mirror direction as the book's metal of a small fuzz f.
///
/// The book adds f times a point of the unit sphere to the mirrored direction. Half of these points are less
/// than √3/2 from the axis of the mirrored direction, so half of the rays are within f √3/2 of it. Half of
/// the lobe's tiny mirrors are tilted by less than its width α, and turn rays by twice their tilt. So 2 α =
/// f √3/2, and the roughness is the root of α.
inline double weekend_roughness(double fuzz) { return std::sqrt(std::sqrt(3.0) / 4 * fuzz); }

/// Builds the scene. Metal is a blurred mirror of its color.
inline protostar::Scene<protostar::Sphere, protostar::Parallelogram> weekend() {
  return weekend_of([](const protostar::Color& color, double fuzz) {
    return protostar::Material{.glossy = color, .roughness = weekend_roughness(fuzz)};
  });
}

/// Builds the scene with mirrors without a color in place of metal, as dark as the metal is on average: the
/// scene that this library and the book's way draw exactly alike.
inline protostar::Scene<protostar::Sphere, protostar::Parallelogram> weekend_of_mirrors() {
  return weekend_of([](const protostar::Color& color, double) {
    return protostar::Material{.reflect = (double{color.r} + color.g + color.b) / 3};
  });
}

/// Distance of what is in focus, and radius of the lens, which the book gives by an angle of 0.6 degrees.
inline constexpr double weekend_focus = 10;
inline double weekend_aperture() { return weekend_focus * protostar::tangent_of_degrees(0.3); }

/// The camera. The book's coordinates are right-handed.
inline protostar::Camera camera_of_weekend() {
  return protostar::Camera::look_at_right_handed({13, 2, 3}, {0, 0, 0}, {0, 1, 0}, 20)
      .with_lens(weekend_aperture(), weekend_focus);
}
