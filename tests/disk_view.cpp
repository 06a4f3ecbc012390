// Disks as seen from a point.
#include <protostar/sampling/disk_view.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/chi_squared.hpp"
#include "support/random.hpp"
#include "support/view_checks.hpp"

using namespace protostar;

namespace {

/// Returns the solid angle of a disk by a rule of another kind: Gauss-Legendre in the radius, midpoints
/// around.
double solid_angle_of_disk_by_area(double h, double rho, double radius, double from = 0) {
  constexpr int around = 400, rings = 40;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double width = (radius - from) / rings;
    sum += detail::gauss_legendre(
        [&](double r) {
          double ring = 0;
          for (int j = 0; j < around; ++j) {
            const double c = std::cos(2 * std::numbers::pi * (j + 0.5) / around);
            const double squares = h * h + rho * rho + r * r + 2 * rho * r * c;
            ring += h * r / (squares * std::sqrt(squares));
          }
          return ring;
        },
        from + i * width, width);
  }
  return sum * 2 * std::numbers::pi / around;
}

}  // namespace

TEST_CASE("the solid angle of a disk is that of a cap on its axis, and that of integration elsewhere") {
  for (const double h : {1e-9, 1e-3, 0.5, 1.0, 30.0, 1e6}) {
    const double r = std::sqrt(1 + h * h), expected = 2 * std::numbers::pi / (r * (r + h));
    CHECK(relative_error(DiskView({0, 0, 0}, {0, 0, h}, {0, 0, 2}, 1).solid_angle(), expected) < 0x1p-48);
  }
  // Beside and before the disk, at all heights; close before it, as 2π − ∫ h/√(h² + l²) dψ with the length l
  // from the foot to the rim.
  for (const double rho : {1.3, 2.0, 20.0, 1e4})
    for (const double h : {1e-12, 1e-6, 0.01, 1.0, 7.0, 1e5}) {
      CAPTURE(rho, h);
      const double solid_angle = DiskView({0, 0, 0}, {rho, 0, h}, {0, 0, 1}, 1).solid_angle();
      // 2^-48, and sums of 400, 12 and 40 positive numbers of 16 operations. The rules are exact to more.
      CHECK(relative_error(solid_angle, solid_angle_of_disk_by_area(h, rho, 1)) <=
            0x1p-48 + 468 * u_roundoff);
    }
  for (const double rho : {0.0, 0.3, 0.8})
    for (const double h : {1e-12, 1e-3, 0.3}) {
      CAPTURE(rho, h);
      double sum = 0;
      for (int i = 0; i < 400; ++i) {
        const double angle = 2 * std::numbers::pi * (i + 0.5) / 400;
        const double l = rho * std::cos(angle) + std::sqrt(1 - rho * rho * std::sin(angle) * std::sin(angle));
        sum += h / std::sqrt(h * h + l * l);
      }
      const double solid_angle = DiskView({0, 0, 0}, {rho, 0, -h}, {0, 0, 1}, 1).solid_angle();
      // 2^-48, and the sum of 400 positive numbers of 20 operations; each is at most 2π.
      CHECK(std::abs(solid_angle - (2 * std::numbers::pi - sum * 2 * std::numbers::pi / 400)) <=
            2 * std::numbers::pi * (0x1p-48 + 420 * u_roundoff));
    }
  // Close to the rim, the disk covers a half plane: twice the angle of the point's direction from the rim. At
  // a distance R from the rim, the circle leaves out an angle of 2 arcsin R/2 ≤ R + R³/7 of it, and beyond 2
  // all of π. With z R/R³ dR, for a height z, that makes z (ln 4/z + 1); 2z are for the gap, by which a foot
  // is moved.
  for (const double angle : {0.1, 1.0, 2.0, 3.0}) {
    const double gap = 0x1p-40, rho = 1 + gap * std::cos(angle);
    const Point from{0.6 * rho, 0.8 * rho, gap * std::sin(angle)};
    const DoubleDouble distance =
        length(PreciseVector(Vec3{from.x, from.y, 0}));  // which is rounded otherwise
    const double expected = 2 * polar_angle(from.z, static_cast<double>(distance - DoubleDouble(1)));
    CHECK(std::abs(DiskView(from, {0, 0, 0}, {0, 0, 1}, 1).solid_angle() - expected) <=
          from.z * (std::log(4 / from.z) + 3) + 0x1p-45);
  }
}

TEST_CASE("directions to a disk are uniform in its solid angle") {
  const Vec3 normal = normalize(Vec3{1, -2, 2});
  const Frame frame = frame_around(normal);
  const Point center{0.25, 0.5, -1};
  struct {
    double rho, h;
  } const rows[] = {{0, 1},         {0.5, 0.3}, {0.5, -0.05}, {0.9, 0.1}, {1.2, 0.1},
                    {1.001, 0.001}, {2, -0.5},  {3, 0.01},    {50, 20}};
  for (const auto& [rho, h] : rows) {
    CAPTURE(rho, h);
    const double radius = 1.5;
    const Point from = center + (rho * radius) * frame.x + (h * radius) * normal;
    const DiskView view(from, center, -3.0 * normal, radius);
    const auto off = [&](const Point& p) {
      return std::max({length(p - center) / radius - 1, std::abs(dot(p - center, normal)), 0.0});
    };
    check_directions(view, from, off, in_plane(normal, of_disk));
    CHECK(wrong_solid_angles(view, 15, of_disk, 40) == 0);
    // Rings of the disk, and halves to both sides of the plane through point and axis.
    std::array<int, 5> rings{};
    int left = 0;
    Random random(16);
    constexpr int count = 1500;
    for (int i = 0; i < count; ++i) {
      const double u = random.interior(), v = random.interior();
      const auto [direction, distance, density] = view.sample(u, v);
      const Vec3 w = from + distance * direction - center;
      const double r = std::min(length(w) / radius, 0.999999);
      ++rings[static_cast<std::size_t>(r * 5)];
      left += dot(w, frame.y) > 0;
    }
    CHECK(std::abs(left - count / 2.0) < 5 * std::sqrt(count / 4.0));
    if (std::abs(h) < 0.05) continue;  // the reference has too few midpoints
    const auto counted = [&](int i) { return rings[static_cast<std::size_t>(i)]; };
    const auto expected = [&, size = rho, above = std::abs(h)](int i) {
      return count * solid_angle_of_disk_by_area(above, size, 0.2 * (i + 1), 0.2 * i) / view.solid_angle();
    };
    CHECK(chi_squared_over_bound(5, counted, expected) < 1);
  }
}
