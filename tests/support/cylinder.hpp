// A user-defined surface: intersect and normal_at, and nothing else.
#pragma once

#include <cmath>
#include <optional>
#include <protostar/interval.hpp>
#include <protostar/ray.hpp>
#include <utility>

/// The points at distance radius from the y axis, by the textbook formula, without care for rounding.
struct Cylinder {
  double radius = 1;

  std::optional<double> intersect(const protostar::Ray& ray, protostar::Interval range) const {
    const auto& [o, d] = std::pair{ray.origin, ray.direction};
    const double a = d.x * d.x + d.z * d.z;
    const double b = 2 * (o.x * d.x + o.z * d.z);
    const double c = o.x * o.x + o.z * o.z - radius * radius;
    const double discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0) || a == 0) return std::nullopt;
    for (const double t :
         {(-b - std::sqrt(discriminant)) / (2 * a), (-b + std::sqrt(discriminant)) / (2 * a)})
      if (range.contains(t)) return t;
    return std::nullopt;
  }

  protostar::Vec3 normal_at(protostar::Point point) const {
    return protostar::Vec3{point.x, 0, point.z} / radius;
  }
};
