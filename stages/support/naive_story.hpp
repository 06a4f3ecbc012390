// Tells of the rays that the naive stages trace, for the explanation of a pixel.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "../naive.hpp"
#include "explanation.hpp"
#include "message.hpp"

namespace naive {

/// Listener to the rays of a sample, which writes a line for each of their steps, and their numbers.
class Story {
 public:
  Story(SampleRecord& sample, float offset) : sample_(sample) {
    const auto& light = light_of_the_three_spheres;
    Facts scene{"scene",
                {{"offset", {offset}}, {"position", list(light.position)}, {"power", list(light.power)}}};
    for (const Sphere& sphere : spheres)
      scene.parts.push_back(
          {"sphere",
           {{"center", list(sphere.center)}, {"radius", {sphere.radius}}, {"color", list(sphere.color)}}});
    sample.steps.push_back(scene);
  }

  /// Tells of a ray and its closest hit.
  void operator()(const Ray& ray, const std::optional<Hit>& hit) const {
    Facts& step = spheres_along(ray, "ray");
    if (!hit) return add("  no hit");
    add("  closest hit at ", words(hit->point), ", normal ", words(hit->normal), ", color ",
        words(hit->color));
    step.numbers.push_back({"point", list(hit->point)});
    step.numbers.push_back({"normal", list(hit->normal)});
    step.numbers.push_back({"color", list(hit->color)});
  }

  /// Tells of a shadow ray, in whose way is all with t < end.
  void operator()(const Ray& ray, float end) const {
    add("shadow ray, stopped by a hit with t < ", end);
    spheres_along(ray, "shadow ray").numbers.push_back({"end", {end}});
  }

 private:
  Facts& spheres_along(const Ray& ray, const char* type) const {
    add("ray from ", words(ray.origin), " along ", words(ray.direction), ", in float");
    std::vector<double> all_t;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const auto t = spheres[i].intersect(ray);
      all_t.push_back(t.value_or(std::numeric_limits<float>::infinity()));
      if (t)
        add("  sphere ", i, ": hit at t = ", *t);
      else
        add("  sphere ", i, ": missed");
    }
    sample_.steps.push_back(
        {type, {{"origin", list(ray.origin)}, {"direction", list(ray.direction)}, {"t", all_t}}});
    return sample_.steps.back();
  }

  static std::vector<double> list(const auto& v) { return {v.x, v.y, v.z}; }

  static std::string words(const auto& v) {
    return "(" + text(v.x) + ", " + text(v.y) + ", " + text(v.z) + ")";
  }

  static std::string text(float number) { return in_digits(number, 9); }  // tells each float from all others
  static std::string text(std::size_t number) { return std::to_string(number); }
  static std::string text(const std::string& words) { return words; }

  void add(const auto&... parts) const { sample_.told.push_back((text(parts) + ...)); }

  SampleRecord& sample_;
};

}  // namespace naive
