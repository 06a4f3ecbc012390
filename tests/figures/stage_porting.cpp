// Figure of the page about shaders: how well a float knows where a ray meets the ground.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "figures.hpp"
#include "scenes/three_spheres.hpp"

namespace figures {

namespace {

/// The t of the near root at the ground in float, relative to that in double, less 1.
struct Errors {
  double difference;  ///< of (-b - √D) / 2a
  double quotient;    ///< of 2c / q
};

/// Returns the errors for the ray from the eye through the middle of the picture's width, at the height v.
Errors errors_at(double v) {
  const protostar::Sphere& ground = the_three_spheres[2].sphere;
  const double scale = 1 / std::sqrt(1 + v * v);
  const auto roots = [&]<class T>(T) {
    const T dy = static_cast<T>(v * scale), dz = static_cast<T>(scale);
    const T y = -static_cast<T>(ground.center.y), z = -static_cast<T>(ground.center.z);
    const T radius = static_cast<T>(ground.radius);
    const T a = dy * dy + dz * dz, b = 2 * (dy * y + dz * z), c = y * y + z * z - radius * radius;
    const T root = std::sqrt(b * b - 4 * a * c);
    return std::array<double, 2>{static_cast<double>((-b - root) / (2 * a)),
                                 static_cast<double>(2 * c / (root - b))};
  };
  const auto in_float = roots(0.0f), in_double = roots(0.0);
  return {std::abs(in_float[0] / in_double[1] - 1), std::abs(in_float[1] / in_double[1] - 1)};
}

void float_roots(Drawing& drawing) {
  drawing.words({320, 24}, "error of t at the ground in float, in millionths of t", Anchor::middle,
                Paint::ink, true);
  constexpr double bottom = 280;
  double x = 44, of_differences = 0, of_quotients = 0;
  for (const double v : {-0.95, -0.75, -0.55, -0.35, -0.25, -0.15}) {
    const Errors errors = errors_at(v);
    of_differences += errors.difference;
    of_quotients += errors.quotient;
    char text[32];
    for (const auto& [error, paint] :
         {std::pair{errors.difference, Paint::red}, {errors.quotient, Paint::blue}}) {
      const double high = 150 * std::log10(1 + 1e6 * error);
      drawing.rectangle({x, bottom - high}, 34, high, paint, Fill::soft);
      std::snprintf(text, sizeof text, "%.2g", 1e6 * error);
      drawing.words({x + 17, bottom - 8 - high}, text, Anchor::middle, paint);
      x += 40;
    }
    std::snprintf(text, sizeof text, "v = %g", v);
    drawing.words({x - 40, bottom + 24}, text, Anchor::middle);
    x += 16;
  }
  expect(of_differences > 10 * of_quotients, "float_roots");
  drawing.line({28, bottom}, {620, bottom}, Paint::ink);
  drawing.words({430, 60}, "red: (−b − √D) / 2a", Anchor::middle, Paint::red);
  drawing.words({430, 86}, "blue: 2c / (√D − b)", Anchor::middle, Paint::blue);
}

}  // namespace

std::vector<StageFigure> porting_figures() {
  return {{"float_roots", "porting", "Bars: errors of a root in float, as a difference and as a quotient",
           318, float_roots}};
}

}  // namespace figures
