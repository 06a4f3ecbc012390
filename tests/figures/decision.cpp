#include <protostar/numeric/double_double.hpp>
#include <protostar/numeric/exact_number.hpp>
#include <protostar/ray.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <stdexcept>

#include "figures.hpp"
#include "svg.hpp"

using namespace protostar;

namespace figures {

namespace {

/// A line that passes the center of the unit sphere at a distance of nearly 1.
struct Passing {
  double computed, error;  ///< D and E, as the library computes them
  double exact;            ///< D without rounding

  explicit Passing(double distance) {
    const Ray ray{.origin = {distance, 0, -3}};
    const Point center{0};
    const auto e = sphere_equation(ray, center, 1.0);
    computed = e.D, error = e.E;
    const auto without_rounding = sphere_equation(exact_line(ray.origin, ray.direction), center, 1.0);
    exact = static_cast<double>(static_cast<DoubleDouble>(without_rounding.b * without_rounding.b -
                                                          without_rounding.A * without_rounding.c));
  }
};

}  // namespace

std::string decision() {
  Drawing drawing(640, 328, "How a discriminant with an error bound decides");
  constexpr double unit = 58, zero = 262, axis = 262, top = 66;  // pixels to one E, and of D = 0
  const auto at = [](double d) { return zero + unit * d; };
  const auto zone = [&](double from, double to, Paint paint, const char* words, const char* rule) {
    drawing.rectangle({from, top}, to - from, axis - top, paint, Fill::soft);
    drawing.words({(from + to) / 2, 24}, words, Anchor::middle, paint, true);
    drawing.words({(from + to) / 2, 48}, rule, Anchor::middle, paint);
  };
  zone(8, at(-1), Paint::red, "surely missed", "D < −E");
  zone(at(-1), at(4), Paint::orange, "in doubt: refine", "more digits");
  zone(at(4), 632, Paint::green, "surely hit", "D > 4E");

  drawing.arrow({8, axis}, {636, axis}, Paint::ink);
  for (const auto& [d, words] :
       {std::pair{-1.0, "−E"}, {0.0, "0"}, {1.0, "E"}, {2.0, "2E"}, {3.0, "3E"}, {4.0, "4E"}}) {
    drawing.line({at(d), axis}, {at(d), axis + 7}, Paint::ink);
    drawing.words({at(d), axis + 25}, words, Anchor::middle);
  }
  drawing.line({at(0), top}, {at(0), axis}, Paint::gray, Stroke::dashed);
  drawing.circle({16, axis + 48}, 6, Paint::ink, Fill::full);
  drawing.words({30, axis + 54}, "D as computed", Anchor::start);
  drawing.line({190, axis + 48}, {248, axis + 48}, Paint::ink, Stroke::bold);
  for (const double end : {190.0, 248.0})
    drawing.line({end, axis + 40}, {end, axis + 56}, Paint::ink, Stroke::bold);
  drawing.words({258, axis + 54}, "where the true D surely is: D ± E", Anchor::start);

  double y = top + 36;
  for (const double distance : {1 + 0x1p-52 * 200, 1 + 0x1p-52 * 36, 1 - 0x1p-52 * 440}) {
    const Passing passing(distance);
    const double D = passing.computed / passing.error, exact = passing.exact / passing.error;
    if (!(std::abs(exact - D) <= 1)) throw std::logic_error("decision: D is off by more than E");
    const Paint paint = D < -1 ? Paint::red : D > 4 ? Paint::green : Paint::orange;
    drawing.line({at(D - 1), y}, {at(D + 1), y}, paint, Stroke::bold);
    for (const double end : {D - 1, D + 1})
      drawing.line({at(end), y - 8}, {at(end), y + 8}, paint, Stroke::bold);
    drawing.circle({at(D), y}, 6, paint, Fill::full);
    y += 60;
  }
  return drawing.text();
}

}  // namespace figures
