#include "tutorial.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <numbers>

namespace tutorial {

namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// Returns the diffuse light of one lamp, unhindered; the normal is the one on the ray's side.
vec3 lit_by(const PointLight& light, const vec3& point, const vec3& normal, const vec3& color) {
  const vec3 to_light = light.position - point;
  const float distance = length(to_light), cosine = dot(normal, to_light) / distance;
  return color * light.intensity / (4 * pi) * std::max(0.0f, cosine) / (distance * distance);
}

/// Returns the normal on the side that the ray comes from.
vec3 facing_normal(const Intersection& intersection, const vec3& point, const Ray& ray) {
  const vec3 normal = intersection.surface->normal(point);
  return dot(normal, ray.direction) > 0 ? -normal : normal;
}

}  // namespace

void Image::correct_gamma() {
  for (vec3& pixel : pixels_)
    for (int i = 0; i < 3; ++i) pixel[i] = std::pow(std::max(0.0f, pixel[i]), 1 / 2.2f);
}

void Image::save_ppm(const std::filesystem::path& path) const {
  std::ofstream file(path);
  file << "P3\n" << width_ << " " << height_ << "\n255\n";
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const vec3& color = (*this)(x, y);
      for (int i = 0; i < 3; ++i)
        file << static_cast<int>(std::clamp(color[i] * 256.0f, 0.0f, 255.0f)) << (i < 2 ? "\t" : "\t\t");
    }
    file << "\n";
  }
}

Ray Camera::operator()(float u, float v) const { return {origin, normalize(u * right + v * up + forward)}; }

float Sphere::intersect(const Ray& ray, float min, float max) const {
  const vec3 l = center_ - ray.origin;
  const float b = dot(ray.direction, l), c = dot(l, l) - radius_ * radius_, D = b * b - c;
  if (D <= 0) return infinity;
  const float root = std::sqrt(D), near = b - root, far = b + root;
  if (min < near && near < max) return near;
  if (min < far && far < max) return far;
  return infinity;
}

vec3 Sphere::normal(const vec3& point) const { return (point - center_) / radius_; }

Intersection Scene::intersect(const Ray& ray, float min, float max) const {
  Intersection closest;
  for (const auto& surface : surfaces) {
    const float t = surface->intersect(ray, min, max);
    if (t < closest.t) closest = {surface.get(), t};
  }
  return closest;
}

bool Scene::intersect_any(const Ray& ray, float min, float max) const {
  for (const auto& surface : surfaces)
    if (surface->intersect(ray, min, max) < infinity) return true;
  return false;
}

Scene three_spheres() {
  Scene scene;
  scene.surfaces.push_back(std::make_unique<Sphere>(vec3{0, 0, 3}, 1.0f, vec3{1, 0.3f, 0}));
  scene.surfaces.push_back(std::make_unique<Sphere>(vec3{-1.5f, 0, 5}, 1.0f, vec3{0.2f, 0.7f, 0.1f}));
  scene.surfaces.push_back(std::make_unique<Sphere>(vec3{0, -1001, 3}, 1000.0f, vec3{0.2f, 0.4f, 0.8f}));
  scene.lights.push_back({{0, 3, 0}, vec3{4 * pi * 10}});
  return scene;
}

void Integrator::render(Image& image, const Camera& camera, const Scene& scene) const {
  const float width = static_cast<float>(image.width()), height = static_cast<float>(image.height());
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const float u = width / height * (2 * (static_cast<float>(x) + 0.5f) / width - 1);
      const float v = -2 * (static_cast<float>(y) + 0.5f) / height + 1;
      image(x, y) = radiance(camera(u, v), scene);
    }
}

vec3 BinaryIntegrator::radiance(const Ray& ray, const Scene& scene) const {
  return vec3{scene.intersect(ray) ? 1.0f : 0.0f};
}

vec3 DepthIntegrator::radiance(const Ray& ray, const Scene& scene) const {
  return vec3{1 / scene.intersect(ray).t};
}

vec3 NormalIntegrator::radiance(const Ray& ray, const Scene& scene) const {
  const Intersection intersection = scene.intersect(ray);
  if (!intersection) return vec3{0};
  return 0.5f * intersection.surface->normal(ray(intersection.t)) + vec3{0.5f};
}

vec3 ColorIntegrator::radiance(const Ray& ray, const Scene& scene) const {
  const Intersection intersection = scene.intersect(ray);
  return intersection ? intersection.surface->color : vec3{0};
}

vec3 DiffuseIntegrator::radiance(const Ray& ray, const Scene& scene) const {
  const Intersection intersection = scene.intersect(ray);
  if (!intersection) return vec3{0};
  const vec3 point = ray(intersection.t), normal = facing_normal(intersection, point, ray);
  vec3 color{0};
  for (const PointLight& light : scene.lights)
    color += lit_by(light, point, normal, intersection.surface->color);
  return color;
}

vec3 TransparencyIntegrator::radiance(const Ray& ray, const Scene& scene) const {
  Ray current = ray;
  vec3 color{1};
  for (int i = 0; i < 10; ++i) {
    const Intersection intersection = scene.intersect(current);
    if (!intersection) break;
    color *= intersection.surface->color;
    const vec3 point = current(intersection.t);
    current.origin = point - epsilon * facing_normal(intersection, point, current);
  }
  return color;
}

vec3 ShadowIntegrator::radiance(const Ray& ray, const Scene& scene) const {
  const Intersection intersection = scene.intersect(ray);
  if (!intersection) return vec3{0};
  const vec3 point = ray(intersection.t), normal = facing_normal(intersection, point, ray);
  vec3 color{0};
  for (const PointLight& light : scene.lights) {
    const vec3 start = point + epsilon * normal, to_light = light.position - start;
    const float distance = length(to_light);
    if (!scene.intersect_any({start, to_light / distance}, 0, distance - epsilon))
      color += lit_by(light, point, normal, intersection.surface->color);
  }
  return color;
}

}  // namespace tutorial
