// Points of space in a drawing, for the figures of the stages.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <numbers>
#include <protostar/camera.hpp>
#include <protostar/encode.hpp>
#include <protostar/ray.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "svg.hpp"

namespace figures {

using protostar::Camera;
using protostar::Color;
using protostar::Point;
using protostar::Ray;
using protostar::Vec3;

/// Throws if a figure would show what the library does not find.
inline void expect(bool is_as_drawn, const char* figure) {
  if (!is_as_drawn) throw std::logic_error(std::string(figure) + ": the figure does not show the result");
}

/// Returns words one after the other. (For a sum that begins with a short literal, g++ 12 warns of memory
/// that overlaps, wrongly.)
inline std::string joined(std::initializer_list<std::string> parts) {
  std::string result;
  for (const std::string& part : parts) result += part;
  return result;
}

/// Returns a number with a few digits behind the point.
inline std::string text_of(double value, int digits = 2) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, std::abs(value));
  return value < 0 ? std::string("−").append(text) : text;
}

/// Returns the unit vector in the plane of the drawing at an angle, in degrees, counterclockwise from the
/// right.
inline Vec3 at_angle(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {std::cos(angle), std::sin(angle), 0};
}

/// Returns the color that a file has for linear light.
inline std::array<int, 3> shown_color(const Color& light) {
  static const protostar::Encoder encoder(protostar::Srgb{}, 255);
  return {encoder(light.r), encoder(light.g), encoder(light.b)};
}

/// Part of a drawing that shows points of space: the plane of x and y, or what a distant camera sees.
class Sketch {
 public:
  /// Shows the coordinate origin at a place, and a unit of length in `scale` pixels.
  Sketch(Drawing& drawing, const Place& origin, double scale, const Camera& camera = {})
      : drawing_(drawing),
        origin_(origin),
        scale_(scale),
        right_(normalize(camera.right)),
        up_(normalize(camera.up)) {}

  /// Returns the place of a point in the drawing.
  [[nodiscard]] Place of(const Point& p) const {
    return {origin_.x + scale_ * dot(p, right_), origin_.y - scale_ * dot(p, up_)};
  }

  void line(const Point& from, const Point& to, Paint paint, Stroke stroke = Stroke::thin) const {
    drawing_.line(of(from), of(to), paint, stroke);
  }
  void arrow(const Point& from, const Point& to, Paint paint, Stroke stroke = Stroke::thin) const {
    drawing_.arrow(of(from), of(to), paint, stroke);
  }
  /// Draws a ray from its origin to a parameter t.
  void ray(const Ray& ray, double t, Paint paint, Stroke stroke = Stroke::thin) const {
    arrow(ray.origin, ray.at(t), paint, stroke);
  }
  void mark(const Point& at, Paint paint, Fill fill = Fill::full) const {
    drawing_.mark(of(at), paint, fill);
  }
  void cross(const Point& at, Paint paint) const { drawing_.cross(of(at), paint); }
  void circle(const Point& center, double radius, Paint paint, Fill fill = Fill::soft,
              Stroke stroke = Stroke::thin) const {
    drawing_.circle(of(center), scale_ * radius, paint, fill, stroke);
  }
  void polygon(const std::vector<Point>& corners, Paint paint, Fill fill = Fill::soft) const {
    drawing_.polygon(places(corners), paint, fill);
  }

  /// Draws the points at(t) for t from one number to another.
  void curve(const auto& at, double from, double to, Paint paint, Stroke stroke = Stroke::thin,
             int steps = 48) const {
    std::vector<Place> corners;
    for (int i = 0; i <= steps; ++i) corners.push_back(of(at(from + (to - from) * i / steps)));
    drawing_.polyline(corners, paint, stroke);
  }

  /// Draws the arc between two directions from a point.
  void angle(const Point& center, double radius, const Vec3& from, const Vec3& to, Paint paint) const {
    const Vec3 a = normalize(from), across = to - dot(a, to) * a, b = normalize(across);
    const double full = std::atan2(length(across), dot(a, to));
    curve([&](double t) { return center + radius * (std::cos(t) * a + std::sin(t) * b); }, 0, full, paint,
          Stroke::thin, 16);
  }

  /// Writes words beside a point, as many pixels to the right and down.
  void words(const Point& at, const Place& beside, const std::string& text, Paint paint = Paint::ink,
             Anchor anchor = Anchor::start) const {
    const Place place = of(at);
    drawing_.words({place.x + beside.x, place.y + beside.y}, text, anchor, paint);
  }

  /// Draws a mark for the camera, which looks along a direction.
  void eye(const Point& at, const Vec3& direction) const {
    const Vec3 d = normalize(direction) * (18 / scale_);
    const Vec3 side = (dot(d, right_) * up_ - dot(d, up_) * right_) * 0.42;  // across d in the drawing
    polygon({at, at - d + side, at - d - side}, Paint::ink, Fill::full);
  }

  /// Draws a mark for a light.
  void lamp(const Point& at) const {
    for (int i = 0; i < 8; ++i) {
      const Vec3 d = at_angle(45 * i) / scale_;
      line(at + 9.0 * d, at + 15.0 * d, Paint::orange);
    }
    drawing_.circle(of(at), 6, Paint::orange, Fill::full);
  }

 private:
  [[nodiscard]] std::vector<Place> places(const std::vector<Point>& points) const {
    std::vector<Place> result;
    for (const Point& point : points) result.push_back(of(point));
    return result;
  }

  Drawing& drawing_;
  Place origin_;
  double scale_;
  Vec3 right_, up_;
};

/// Figure of a stage's page.
struct StageFigure {
  const char *name, *page;
  const char* alt;  ///< text in place of the picture, on the page and in the file
  double height;    ///< in pixels; the width is 640
  void (*draw)(Drawing&);
};

}  // namespace figures
