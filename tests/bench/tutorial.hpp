// The tutorial's way, to compare with: surfaces and integrators behind virtual functions, float, an offset, a
// stream.
//
// It is written from the tutorial's text and shares no code with the library.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <vector>

namespace tutorial {

using vec3 = glm::vec3;

inline constexpr float infinity = std::numeric_limits<float>::infinity();

/// Distance from a surface at which the next ray starts (§2.3.2).
inline constexpr float epsilon = 1e-4f;

struct Ray {
  vec3 origin, direction;  // the direction is a unit vector
  vec3 operator()(float t) const { return origin + t * direction; }
};

/// Image of linear light (§2.2.2).
class Image {
 public:
  Image(int width, int height)
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width * height)) {}

  int width() const { return width_; }
  int height() const { return height_; }
  vec3& operator()(int x, int y) { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }
  const vec3& operator()(int x, int y) const { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }

  /// Raises every channel to the power 1/2.2 (§2.3.2).
  void correct_gamma();

  /// Writes a plain PPM.
  void save_ppm(const std::filesystem::path& path) const;

 private:
  int width_, height_;
  std::vector<vec3> pixels_;
};

/// Pinhole camera (§2.2.3).
struct Camera {
  vec3 origin{0}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, 1};

  Ray operator()(float u, float v) const;
};

/// Base class of surfaces (§2.3.1).
class Surface {
 public:
  explicit Surface(const vec3& surface_color) : color(surface_color) {}
  virtual ~Surface() = default;

  /// Returns the smallest t between min and max, or infinity.
  virtual float intersect(const Ray& ray, float min, float max) const = 0;
  virtual vec3 normal(const vec3& point) const = 0;

  vec3 color;
};

/// Sphere (§2.2.4).
class Sphere final : public Surface {
 public:
  Sphere(const vec3& center, float radius, const vec3& sphere_color)
      : Surface(sphere_color), center_(center), radius_(radius) {}

  float intersect(const Ray& ray, float min, float max) const final;
  vec3 normal(const vec3& point) const final;

 private:
  vec3 center_;
  float radius_;
};

struct PointLight {
  vec3 position, intensity;
};

struct Intersection {
  const Surface* surface = nullptr;
  float t = infinity;
  explicit operator bool() const { return surface != nullptr; }
};

struct Scene {
  std::vector<std::unique_ptr<Surface>> surfaces;
  std::vector<PointLight> lights;

  /// Returns the closest hit.
  Intersection intersect(const Ray& ray, float min = 0, float max = infinity) const;

  /// Returns true if there is any hit.
  bool intersect_any(const Ray& ray, float min, float max) const;
};

/// Returns the scene of §2.3.1, with the light of the pictures.
Scene three_spheres();

/// Base class of integrators, which compute the color of a ray (§2.3.2).
class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual void render(Image& image, const Camera& camera, const Scene& scene) const;
  virtual vec3 radiance(const Ray& ray, const Scene& scene) const = 0;
};

struct BinaryIntegrator final : Integrator {
  vec3 radiance(const Ray& ray, const Scene& scene) const final;
};
struct DepthIntegrator final : Integrator {
  vec3 radiance(const Ray& ray, const Scene& scene) const final;
};
struct NormalIntegrator final : Integrator {
  vec3 radiance(const Ray& ray, const Scene& scene) const final;
};
struct ColorIntegrator final : Integrator {
  vec3 radiance(const Ray& ray, const Scene& scene) const final;
};
struct DiffuseIntegrator final : Integrator {
  vec3 radiance(const Ray& ray, const Scene& scene) const final;
};
struct TransparencyIntegrator final : Integrator {
  vec3 radiance(const Ray& ray, const Scene& scene) const final;
};
struct ShadowIntegrator final : Integrator {
  vec3 radiance(const Ray& ray, const Scene& scene) const final;
};

}  // namespace tutorial
