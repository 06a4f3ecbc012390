#include "spheres_and_board.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace tutorial {

namespace {

constexpr int most_rays = 5;        // maximum in a path
constexpr float offset = 1e-3f;     // for a ray that leaves a surface
constexpr float full_view = 1.05f;  // field of view of the camera, in radians

struct Substance {
  vec3 color;
  float shine, exponent, mirrored, passing, index;
};

struct Ball {
  vec3 center;
  float radius;
  Substance substance;

  /// Returns the first t > 0, or infinity.
  float meet(const Ray& ray) const {
    const vec3 l = center - ray.origin;
    const float along = dot(l, ray.direction), apart = dot(l, l) - along * along;
    if (apart > radius * radius) return infinity;
    const float half = std::sqrt(radius * radius - apart);
    if (along - half > 0) return along - half;
    return along + half > 0 ? along + half : infinity;
  }
};

constexpr Substance ivory{{0.36f, 0.36f, 0.27f}, 0.5f, 50, 0.1f, 0, 1};
constexpr Substance glass{{0, 0, 0}, 0.9f, 125, 0.1f, 0.8f, 1.5f};
constexpr Substance red_rubber{{0.42f, 0.14f, 0.14f}, 0.3f, 10, 0, 0, 1};
constexpr Substance mirror{{0, 0, 0}, 16, 1425, 0.8f, 0, 1};

constexpr std::array<Ball, 4> balls{{{{-3, 0, 16}, 2, ivory},
                                     {{-1, -1.5f, 12}, 2, glass},
                                     {{1.5f, -0.5f, 18}, 3, red_rubber},
                                     {{7, 5, 18}, 4, mirror}}};
constexpr std::array<vec3, 3> lamps{{{-20, 20, -20}, {30, 50, 25}, {30, 20, -30}}};
constexpr vec3 sky{0.2f, 0.7f, 0.8f};

struct Found {
  float t = infinity;
  vec3 point{0}, normal{0};
  Substance substance{};
};

/// Looks at the board, y = −4 over |x| < 10 and 10 < z < 30, in squares of 2; replaces found if it is closer.
void look_at_board(const Ray& ray, Found& found) {
  if (std::abs(ray.direction.y) <= 1e-3f) return;
  const float t = -(ray.origin.y + 4) / ray.direction.y;
  const vec3 point = ray(t);
  if (!(0 < t && t < found.t && std::abs(point.x) < 10 && 10 < point.z && point.z < 30)) return;
  const int square = static_cast<int>((point.x + 10) / 2) + static_cast<int>((point.z - 10) / 2);
  found = {t, point, {0, 1, 0}, {square % 2 == 0 ? vec3{0.6f, 0.4f, 0.2f} : vec3{0.6f}, 0, 1, 0, 0, 1}};
}

Found first_met(const Ray& ray) {
  Found found;
  const Ball* nearest = nullptr;
  for (const Ball& ball : balls)
    if (const float t = ball.meet(ray); t < found.t) found.t = t, nearest = &ball;
  if (nearest != nullptr) {
    found.point = ray(found.t);
    found.normal = normalize(found.point - nearest->center);
    found.substance = nearest->substance;
  }
  look_at_board(ray, found);
  return found;
}

vec3 mirror_image(const vec3& d, const vec3& n) { return d - n * (2 * dot(d, n)); }

/// Returns the direction refracted by Snell's law; the normal may be on either side.
vec3 bent(const vec3& d, const vec3& n, float before, float behind) {
  const float cosine = -std::clamp(dot(d, n), -1.0f, 1.0f);
  if (cosine < 0) return bent(d, -n, behind, before);
  const float ratio = before / behind, square = 1 - ratio * ratio * (1 - cosine * cosine);
  return square < 0 ? vec3{1, 0, 0} : d * ratio + n * (ratio * cosine - std::sqrt(square));
}

/// Returns a ray that starts beside the point, on the side that it leads to.
Ray leaving(const vec3& point, const vec3& normal, const vec3& direction) {
  return {dot(direction, normal) < 0 ? point - normal * offset : point + normal * offset, direction};
}

}  // namespace

vec3 SpheresAndBoard::radiance(const Ray& ray, int depth) const {
  if (depth >= most_rays) return sky;
  const Found found = first_met(ray);
  if (!(found.t < infinity)) return sky;
  const Substance& of = found.substance;
  const auto follow = [&](float share, const vec3& direction) {
    if (skips_what_weighs_nothing && share == 0) return vec3{0};
    return radiance(leaving(found.point, found.normal, normalize(direction)), depth + 1) * share;
  };
  const vec3 mirrored = follow(of.mirrored, mirror_image(ray.direction, found.normal));
  const vec3 passing = follow(of.passing, bent(ray.direction, found.normal, 1, of.index));

  float matte = 0, bright = 0;
  for (const vec3& lamp : lamps) {
    const vec3 to_lamp = normalize(lamp - found.point);
    const Ray shadow = leaving(found.point, found.normal, to_lamp);
    const Found between = first_met(shadow);
    if (between.t < infinity && length(between.point - shadow.origin) < length(lamp - shadow.origin))
      continue;
    matte += std::max(0.0f, dot(to_lamp, found.normal));
    bright += std::pow(std::max(0.0f, dot(mirror_image(to_lamp, found.normal), ray.direction)), of.exponent);
  }
  return of.color * matte + vec3{of.shine * bright} + mirrored + passing;
}

void SpheresAndBoard::render(Image& image) const {
  const float width = static_cast<float>(image.width()), height = static_cast<float>(image.height());
  const float half = std::tan(full_view / 2);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const float right = (2 * (static_cast<float>(x) + 0.5f) / width - 1) * half * width / height;
      const float up = -(2 * (static_cast<float>(y) + 0.5f) / height - 1) * half;
      image(x, y) = radiance({vec3{0}, normalize(vec3{right, up, 1})}, 0);
    }
}

}  // namespace tutorial
