// Figures of the pages about glass and Fresnel: light at the border of air and glass.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <protostar/integrators/whitted.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "figures.hpp"
#include "sketch.hpp"

using namespace protostar;

namespace figures {

namespace {

/// Light of amplitude 1 at a border: what is mirrored and what goes through, for the two directions in which
/// the electric field may swing.
struct Border {
  double across_mirrored, across_bent;  ///< at a right angle to the plane of the rays
  double along_mirrored, along_bent;    ///< in that plane

  /// Takes the indices of refraction before and behind the surface, and the cosines of the angles there.
  Border(double before, double behind, double cosine, double bent_cosine)
      : across_mirrored((before * cosine - behind * bent_cosine) / (before * cosine + behind * bent_cosine)),
        across_bent(1 + across_mirrored),
        along_mirrored((behind * cosine - before * bent_cosine) / (behind * cosine + before * bent_cosine)),
        along_bent(before / behind * (1 + along_mirrored)) {}

  /// Returns the share of unpolarized light that is mirrored.
  [[nodiscard]] double share() const {
    return (across_mirrored * across_mirrored + along_mirrored * along_mirrored) / 2;
  }
};

/// Returns Schlick's approximation of the share.
double schlick_share(double cosine) { return 0.04 + 0.96 * std::pow(1 - cosine, 5); }

const Vec3 upwards{0, 1, 0};

/// Plot over the angle between a ray and the normal, from 0 to 90 degrees.
class AnglePlot {
 public:
  AnglePlot(Drawing& drawing, double least, double most, const std::vector<double>& ticks, int digits,
            const std::string& title)
      : drawing_(drawing), least_(least), most_(most) {
    for (const double tick : ticks) {
      drawing.line(at(0, tick), at(90, tick), Paint::gray, tick == 0 ? Stroke::thin : Stroke::dashed);
      drawing.words({left - 10, at(0, tick).y + 6}, text_of(tick, digits), Anchor::end);
    }
    for (const double degrees : {0.0, 30.0, 60.0, 90.0})
      drawing.words({at(degrees, 0).x, bottom + 24}, text_of(degrees, 0) + "°", Anchor::middle);
    drawing.words({left, 26}, title);
    drawing.words({320, bottom + 50}, "angle θ between the ray and the normal", Anchor::middle);
  }

  [[nodiscard]] Place at(double degrees, double value) const {
    return {left + (right - left) * degrees / 90,
            bottom - (bottom - top) * (value - least_) / (most_ - least_)};
  }

  /// Draws value(border, cosine, bent cosine) as far as light passes, and 1 beyond if it is a share.
  void curve(double before, double behind, Paint paint, Stroke stroke, bool is_share,
             const auto& value) const {
    std::vector<Place> places;
    for (int i = 0; i <= 360; ++i) {
      const double degrees = 0.25 * i;
      const Vec3 d = at_angle(degrees - 90);
      const auto [passes, bent] = refracted(d, upwards, before / behind);
      const double cosine = -dot(upwards, d), bent_cosine = -dot(upwards, bent);
      if (passes)
        places.push_back(
            at(degrees, value(Border(before, behind, cosine, bent_cosine), cosine, bent_cosine)));
      else if (is_share)
        places.push_back(at(degrees, 1));
    }
    drawing_.polyline(places, paint, stroke);
  }

 private:
  static constexpr double left = 70, right = 600, bottom = 290, top = 50;
  Drawing& drawing_;
  double least_, most_;
};

double share(const Border& border, double /*cosine*/, double /*bent_cosine*/) { return border.share(); }

void fresnel(Drawing& drawing) {
  const AnglePlot plot(drawing, 0, 1, {0, 0.5, 1}, 1, "share of the light that is mirrored");
  plot.curve(1, 1.5, Paint::blue, Stroke::bold, true, share);
  plot.curve(1, 1.5, Paint::green, Stroke::dashed, true,
             [](const Border&, double cosine, double) { return schlick_share(cosine); });
  plot.curve(1.5, 1, Paint::red, Stroke::bold, true, share);
  drawing.words({plot.at(43, 0).x, 100}, "out of glass", Anchor::start, Paint::red);
  drawing.words({plot.at(45, 0).x, 190}, "into glass", Anchor::start, Paint::blue);
  drawing.words({plot.at(45, 0).x, 214}, "Schlick's formula", Anchor::start, Paint::green);
}

void fresnel_parts(Drawing& drawing) {
  const AnglePlot plot(drawing, 0, 1, {0, 0.5, 1}, 1, "share of the light that is mirrored, into glass");
  plot.curve(1, 1.5, Paint::red, Stroke::bold, true,
             [](const Border& border, double, double) { return std::pow(border.across_mirrored, 2); });
  plot.curve(1, 1.5, Paint::green, Stroke::bold, true,
             [](const Border& border, double, double) { return std::pow(border.along_mirrored, 2); });
  plot.curve(1, 1.5, Paint::blue, Stroke::dashed, true, share);
  const double brewster = std::atan(1.5) * 180 / std::numbers::pi;
  plot.curve(1, 1.5, Paint::ink, Stroke::thin, false, [&](const Border& border, double cosine, double) {
    expect(border.along_mirrored * (cosine - std::cos(std::atan(1.5))) >= 0, "fresnel_parts");
    return 0.0;
  });
  drawing.mark(plot.at(brewster, 0), Paint::green);
  drawing.words({plot.at(brewster, 0).x + 8, plot.at(0, 0.02).y}, text_of(brewster, 1) + "°", Anchor::start,
                Paint::green);
  drawing.words({plot.at(20, 0).x, 120}, "electric field across the plane: s", Anchor::start, Paint::red);
  drawing.words({plot.at(20, 0).x, 148}, "electric field in the plane: p", Anchor::start, Paint::green);
  drawing.words({plot.at(20, 0).x, 200}, "mean of both (dashed)", Anchor::start, Paint::blue);
}

void schlick_error(Drawing& drawing) {
  const AnglePlot plot(drawing, -0.05, 0.05, {-0.05, 0, 0.05}, 2, "Schlick's formula minus the exact share");
  plot.curve(1, 1.5, Paint::blue, Stroke::bold, false, [](const Border& border, double cosine, double) {
    return schlick_share(cosine) - border.share();
  });
  plot.curve(1.5, 1, Paint::red, Stroke::bold, false, [](const Border& border, double, double bent_cosine) {
    return schlick_share(bent_cosine) - border.share();
  });
  drawing.words({plot.at(58, 0).x, 110}, "into glass", Anchor::start, Paint::blue);
  drawing.words({plot.at(4, 0).x, 110}, "out of glass, with θ′", Anchor::start, Paint::red);
}

/// Draws a row of people before they enter glass and after, with the ways of the first and the last of them.
/// The piece of the border between their places of entry is the unit of length.
void snell_row(Drawing& drawing) {
  const Sketch sketch(drawing, {180, 144}, 260);
  drawing.rectangle({10, 144}, 620, 156, Paint::blue, Fill::soft);
  const double sine = std::sin(50 * std::numbers::pi / 180);
  const Vec3 d = at_angle(-40);
  const auto [passes, bent] = refracted(d, upwards, 1 / 1.5);
  const Point first{0}, first_behind = first + sine / 1.5 * bent;
  const Point last{1, 0, 0}, last_before = last - sine * d;
  // Both rows are at a right angle to their ways.
  expect(passes && std::abs(dot(last_before - first, d)) < 1e-12 &&
             std::abs(dot(last - first_behind, bent)) < 1e-12,
         "snell_row");
  for (const auto& [from, to] : {std::pair{first, last_before}, std::pair{first_behind, last}}) {
    sketch.line(from, to, Paint::green, Stroke::bold);
    for (int i = 0; i <= 4; ++i) sketch.mark(from + i / 4.0 * (to - from), Paint::green);
  }
  sketch.arrow(last_before, last, Paint::blue, Stroke::bold);
  sketch.arrow(first, first_behind, Paint::red, Stroke::bold);
  sketch.line(last, last + 0.5 * upwards, Paint::gray, Stroke::dashed);
  sketch.line(first, first - 0.5 * upwards, Paint::gray, Stroke::dashed);
  sketch.angle(last, 0.3, -d, upwards, Paint::ink);
  sketch.angle(first, 0.22, last - first, last_before - first, Paint::ink);
  sketch.angle(first, 0.28, bent, -upwards, Paint::ink);
  sketch.angle(last, 0.34, first - last, first_behind - last, Paint::ink);
  sketch.words(last + 0.3 * normalize(upwards - d), {-2, -6}, "θ", Paint::ink, Anchor::middle);
  sketch.words({0.22, 0, 0}, {10, -14}, "θ");
  sketch.words(first + 0.28 * normalize(bent - upwards), {0, 20}, "θ′", Paint::ink, Anchor::middle);
  sketch.words({0.66, 0, 0}, {-12, 24}, "θ′", Paint::ink, Anchor::end);
  sketch.words(last - 0.85 * sine * d, {14, -4}, "sin θ", Paint::blue);
  sketch.words(first_behind, {12, 18}, "sin θ′", Paint::red);
  sketch.words({0.5, 0, 0}, {0, -8}, "1", Paint::ink, Anchor::middle);
  drawing.words({624, 136}, "road", Anchor::end, Paint::gray);
  drawing.words({624, 292}, "sand", Anchor::end, Paint::gray);
}

/// Draws a ray into glass with the field that swings in the plane of the drawing, and below it the parts of
/// the fields along the surface. Their strengths are those of the light that comes, is mirrored and is bent.
void draw_fields(Drawing& drawing, double middle, bool is_across, double degrees) {
  const Sketch sketch(drawing, {middle, 180}, 96);
  const Vec3 d = at_angle(degrees - 90), mirrored = reflected(d, upwards);
  const auto [passes, bent] = refracted(d, upwards, 1 / 1.5);
  const Border border(1, 1.5, -dot(d, upwards), -dot(bent, upwards));
  // Across: the drawn field is the magnetic one, 1.5 times as strong in glass as the electric one.
  const std::array<double, 3> strengths =
      is_across ? std::array{1.0, border.across_mirrored, 1.5 * border.across_bent}
                : std::array{1.0, border.along_mirrored, border.along_bent};
  const std::array<Vec3, 3> directions{d, mirrored, bent};
  const std::array<Paint, 3> paints{Paint::blue, Paint::gray, Paint::red};
  drawing.rectangle({middle - 150, 180}, 300, 140, Paint::blue, Fill::soft);
  drawing.words({middle, 24}, is_across ? "s: electric field across" : "p: electric field in the plane",
                Anchor::middle, Paint::ink, true);
  sketch.line({0, 1.4, 0}, {0, -1.4, 0}, Paint::gray, Stroke::dashed);
  std::array<double, 3> parts{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& towards = directions[i];
    const Point from = i == 0 ? Point{0} - 1.4 * d : Point{0};
    sketch.arrow(from, from + 1.4 * towards, paints[i]);
    const Vec3 field = strengths[i] * Vec3{-towards.y, towards.x, 0};
    const Point at = i == 0 ? Point{0} - 0.9 * d : Point{0} + 0.9 * towards;
    sketch.arrow(at, at + 0.5 * field, paints[i], Stroke::bold);
    // The other field leads into the drawing (s) or out of it (p), and the other way if it has turned around.
    const bool leads_into = is_across == (strengths[i] > 0);
    sketch.mark(at, paints[i], leads_into ? Fill::none : Fill::full);
    if (leads_into) sketch.cross(at, paints[i]);
    parts[i] = field.x;
  }
  expect(passes && std::abs(parts[0] + parts[1] - parts[2]) < 1e-12, "fresnel_fields");
  // The parts along the surface: two arrows above, whose sum is the one below.
  const double start = middle - 70, unit = 130, y = 356;
  const double sum = start + unit * parts[0];
  drawing.arrow({start, y}, {sum, y}, paints[0], Stroke::bold);
  drawing.arrow({sum, y + 12}, {sum + unit * parts[1], y + 12}, paints[1], Stroke::bold);
  drawing.arrow({start, y + 28}, {start + unit * parts[2], y + 28}, paints[2], Stroke::bold);
  drawing.words({middle, y + 56}, is_across ? "magnetic, along the surface" : "electric, along the surface",
                Anchor::middle);
}

void fresnel_fields(Drawing& drawing) {
  draw_fields(drawing, 160, true, 30);
  draw_fields(drawing, 480, false, 30);
}

}  // namespace

std::vector<StageFigure> fresnel_figures() {
  return {
      {"snell_row", "12_glass", "A row of people that turns where they walk from a road into sand", 310,
       snell_row},
      {"fresnel", "fresnel", "Curves of the mirrored share against the angle", 356, fresnel},
      {"fresnel_fields", "fresnel",
       "A ray into glass twice, with its fields and the sums of their parts along the surface", 424,
       fresnel_fields},
      {"fresnel_parts", "fresnel", "The mirrored share of each of the two waves against the angle", 356,
       fresnel_parts},
      {"schlick_error", "fresnel", "The error of Schlick's formula against the angle, into glass and out",
       356, schlick_error},
  };
}

}  // namespace figures
