// The way of "Ray Tracing in One Weekend" and the two books after it, to compare with: hittables and
// materials behind shared pointers and virtual functions, double, an offset, recursion to a depth of 50,
// random numbers of one global generator, and a square of samples in each pixel. It is written from the
// books' text, and shares no code with the library.
#pragma once

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <vector>

namespace weekend_way {

using vec3 = glm::dvec3;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Starts the random numbers anew.
void seed_random(std::uint64_t seed);

/// Returns a random number from 0 to 1, without 1.
double random_double();

struct Ray {
  vec3 origin, direction;
  [[nodiscard]] vec3 at(double t) const { return origin + t * direction; }
};

class Material;

struct HitRecord {
  vec3 p{0}, normal{0};
  std::shared_ptr<Material> material;
  double t = 0;
  bool front_face = false;

  void set_face_normal(const Ray& ray, const vec3& outward) {
    front_face = dot(ray.direction, outward) < 0;
    normal = front_face ? outward : -outward;
  }
};

/// Box with sides along the axes.
struct Aabb {
  vec3 least{infinity}, most{-infinity};

  [[nodiscard]] bool hit(const Ray& ray, double t_min, double t_max) const;
  void include(const Aabb& other);
};

class Hittable {
 public:
  virtual ~Hittable() = default;
  virtual bool hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const = 0;
  [[nodiscard]] virtual Aabb bounding_box() const = 0;

  /// Density of random directions to it, and one of these; only of what is a light.
  [[nodiscard]] virtual double pdf_value(const vec3&, const vec3&) const { return 0; }
  [[nodiscard]] virtual vec3 random(const vec3&) const { return {1, 0, 0}; }
};

class Sphere final : public Hittable {
 public:
  Sphere(const vec3& center, double radius, std::shared_ptr<Material> material)
      : center_(center), radius_(radius), material_(std::move(material)) {}

  bool hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const override;
  [[nodiscard]] Aabb bounding_box() const override { return {center_ - radius_, center_ + radius_}; }
  [[nodiscard]] double pdf_value(const vec3& origin, const vec3& direction) const override;
  [[nodiscard]] vec3 random(const vec3& origin) const override;

 private:
  vec3 center_;
  double radius_;
  std::shared_ptr<Material> material_;
};

class Quad final : public Hittable {
 public:
  Quad(const vec3& q, const vec3& u, const vec3& v, std::shared_ptr<Material> material);

  bool hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const override;
  [[nodiscard]] Aabb bounding_box() const override;
  [[nodiscard]] double pdf_value(const vec3& origin, const vec3& direction) const override;
  [[nodiscard]] vec3 random(const vec3& origin) const override;

 private:
  vec3 q_, u_, v_, w_, normal_;
  double d_, area_;
  std::shared_ptr<Material> material_;
};

/// All objects of the world, asked one after the other; or one of some lights.
class HittableList final : public Hittable {
 public:
  std::vector<std::shared_ptr<Hittable>> objects;

  bool hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const override;
  [[nodiscard]] Aabb bounding_box() const override;
  [[nodiscard]] double pdf_value(const vec3& origin, const vec3& direction) const override;
  [[nodiscard]] vec3 random(const vec3& origin) const override;
};

/// Tree of boxes, halved at the median of the longest axis ("The Next Week").
class BvhNode final : public Hittable {
 public:
  BvhNode(std::vector<std::shared_ptr<Hittable>>& objects, std::size_t begin, std::size_t end);

  bool hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const override;
  [[nodiscard]] Aabb bounding_box() const override { return box_; }

 private:
  std::shared_ptr<Hittable> left_, right_;
  Aabb box_;
};

std::shared_ptr<Material> lambertian(const vec3& albedo);
std::shared_ptr<Material> metal(const vec3& albedo, double fuzz);
std::shared_ptr<Material> dielectric(double index);
std::shared_ptr<Material> diffuse_light(const vec3& emission);

struct Camera {
  vec3 from{0}, at{0, 0, 1}, up{0, 1, 0};
  double field_of_view = 90;  ///< vertical, in degrees
  double aperture = 0, focus = 1;
};

struct World {
  std::shared_ptr<Hittable> objects;
  std::shared_ptr<Hittable>
      lights;            ///< if there are any, half of the directions of matte surfaces lead to them
  bool has_sky = false;  ///< white to blue; otherwise it is black
};

/// Number of rays that have been traced.
extern std::uint64_t traced_rays;

/// Returns the light of all pixels, row by row.
std::vector<vec3> render(const World& world, const Camera& camera, int width, int height, int samples);

}  // namespace weekend_way
