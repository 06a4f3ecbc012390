#include <protostar/sampling/disk_view.hpp>
#include <protostar/sampling/glossy_lobes.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "support/catch.hpp"
#include "support/chi_squared.hpp"
#include "support/jacobian.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

static_assert(GlossyLobe<PhongLobe> && GlossyLobe<GgxLobe>);

namespace {

/// Returns a direction to a viewer by the cosine to the normal.
Vec3 viewer_at(double z) {
  const double r = std::sqrt((1 - z) * (1 + z));
  return {r * std::cos(0.7), r * std::sin(0.7), z};
}

/// Directions by their place around the mirror direction of a view: s from 0 to 1 gives the angle π s⁴ to it,
/// so that quadrature with equal steps of s resolves narrow lobes, and t from 0 to 1 turns around it.
struct AroundMirror {
  Frame frame;

  explicit AroundMirror(const Vec3& view) : frame(frame_around({-view.x, -view.y, view.z})) {}

  static double angle(double s) { return std::numbers::pi * s * s * s * s; }

  Vec3 at(double s, double t) const {
    const double a = angle(s), turn = 2 * std::numbers::pi * (t - 0.5);
    return frame({std::sin(a) * std::cos(turn), std::sin(a) * std::sin(turn), std::cos(a)});
  }

  /// Returns the solid angle per area of (s, t).
  static double area(double s) {
    return std::sin(angle(s)) * 4 * std::numbers::pi * s * s * s * 2 * std::numbers::pi;
  }

  /// Returns the integral of a function of directions over a rectangle of (s, t), by midpoints.
  double integral(const auto& f, int n, int m, double s0, double s1, double t0, double t1) const {
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) {
        const double s = s0 + (s1 - s0) * (i + 0.5) / n;
        sum += f(at(s, t0 + (t1 - t0) * (j + 0.5) / m)) * area(s);
      }
    return sum * (s1 - s0) * (t1 - t0) / n / m;
  }
};

/// Returns χ² of directions that a lobe drew, over its bound, in cells of equal steps around the mirror
/// direction, against the integral of the density in each cell.
double chi_squared_of_lobe(const auto& lobe, const Vec3& view, std::uint64_t seed) {
  constexpr int rings = 16, turns = 8, count = 10000;
  const AroundMirror around(view);
  std::vector<int> counts(rings * turns);
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const double u = random.interior(), v = random.interior();
    const Vec3 d = around.frame.local(lobe.sample(view, u, v).direction);
    const double angle = std::atan2(std::sqrt(d.x * d.x + d.y * d.y), d.z);
    const double s = std::sqrt(std::sqrt(angle / std::numbers::pi));
    const double t = std::atan2(d.y, d.x) / (2 * std::numbers::pi) + 0.5;
    const int ring = std::clamp(static_cast<int>(s * rings), 0, rings - 1);
    ++counts[static_cast<std::size_t>(ring * turns + std::clamp(static_cast<int>(t * turns), 0, turns - 1))];
  }
  const auto density = [&](const Vec3& d) { return lobe.density(view, d); };
  const auto counted = [&](int i) { return counts[static_cast<std::size_t>(i)]; };
  const auto expected = [&](int i) {
    const double s = static_cast<double>(i / turns) / rings, t = static_cast<double>(i % turns) / turns;
    return count * around.integral(density, 12, 6, s, s + 1.0 / rings, t, t + 1.0 / turns);
  };
  return chi_squared_over_bound(rings * turns, counted, expected);
}

// Roundings of the length of a direction, u = 2^-53. A frame's vectors are off by 8u (warp.hpp), and a view's
// length by 4.5u: squares of a length in it by 16u, 9u and, for two products, 16u, half of which is the
// length's. A local direction is off by 5u (warp.cpp), the sum of three terms by 3u, and the length computed
// by 2.5u.
constexpr double length_roundings = 20.5 + 5 + 3 + 2.5;

// A relative error of one rounding to float, and 2^8 roundings of double.
constexpr double of_float = 0x1p-24 + 0x1p-45;

/// Checks a lobe for one view: density, samples, weights, and exchange of view and light. Directions and
/// densities have at most some roundings of u = 2^-53; density_roundings(light) is a function.
void check_lobe(const auto& lobe, double z, double largest_weight, double roundings,
                const auto& density_roundings) {
  CAPTURE(z);
  const Vec3 view = viewer_at(z);
  CHECK(chi_squared_of_lobe(lobe, view, 1) < 1);

  constexpr double u_double = 0x1p-53;
  const auto direction_of = [&](double u, double v) { return lobe.sample(view, u, v).direction; };
  double largest = 0;
  Random random(2);
  WrongCases wrong(random);
  for (int i = 0; i < 5000; ++i) {
    const double u = random.interior(), v = random.interior();
    const auto [direction, density, weight] = lobe.sample(view, u, v);
    const double w = weight.g, most = density_roundings(direction) * u_double;
    largest = std::max(largest, w);
    wrong.add(!(std::abs(length(direction) - 1) <= length_roundings * u_double), "length", u, v, direction);
    wrong.add(!(density > 0 && std::abs(lobe.density(view, direction) / density - 1) <= most), "density", u,
              v, density, lobe.density(view, direction));
    if (!is_at_diagonal(u, v) && std::min({u, 1 - u, v, 1 - v}) > 0.01) {
      const Estimated one = times_density(direction_of, density, u, v, roundings);
      wrong.add(!one.is_one(), "Jacobian", u, v, one.value, one.error);
    }
    wrong.add((direction.z > 0) != (w > 0), "below the surface", u, v);
    const double reflected = lobe.reflection(view, direction).g, value = lobe.value(view, direction).g;
    if (!(direction.z > 0)) continue;
    wrong.add(!(std::abs(reflected / density / w - 1) <= 2 * of_float + 2 * most), "weight", u, v, w,
              reflected / density);
    wrong.add(!(std::abs(value * direction.z / reflected - 1) <= 2 * of_float), "value", u, v, value,
              reflected);
    // Exchanged, view and light have half of their sum in common, to the last bit.
    wrong.add(!(std::abs(lobe.value(direction, view).g / value - 1) <= 2 * of_float), "exchanged", u, v);
  }
  CHECK(wrong == 0);
  CHECK(largest <= largest_weight * (1 + of_float));
}

/// Returns the share of light from everywhere that a white GGX lobe reflects to a viewer.
double ggx_share(double roughness, const Vec3& view) {
  constexpr int m = 64;
  const GgxLobe lobe{.roughness = roughness};
  double sum = 0;
  for (int k = 0; k < m * m; ++k) sum += lobe.sample(view, (k % m + 0.5) / m, (k / m + 0.5) / m).weight.g;
  return sum / (m * m);
}

}  // namespace

TEST_CASE("Phong's lobe: its density, samples, weights and albedo are of one piece") {
  for (const double exponent : {0.0, 12.5, 300.0})
    for (const double z : {1.0, 0.2}) {
      CAPTURE(exponent);
      // n 2^-51, as the lobe promises, and 2^-51 for the factors. Local directions are off by 16u (warp.cpp),
      // a frame by 13u.
      check_lobe(PhongLobe{.exponent = exponent}, z, (exponent + 2) / (exponent + 1), 16 + 13,
                 [&](const Vec3&) { return 4 * exponent + 4; });
    }
}

TEST_CASE("a GGX lobe: its density, samples, weights and albedo are of one piece") {
  for (const double roughness : {0.2, 0.6, 1.0})
    for (const double z : {1.0, 0.2}) {
      CAPTURE(roughness);
      // A normal, of a direction stretched by 1/α, is off by 16u/α, a mirrored direction by twice as much. D
      // has 12u, and changes by 2/α of itself with the angle of the normal: halfway to a light that is off by
      // 5u, it is off by 6u over the length of its sum with the view.
      const GgxLobe lobe{.color = Color{0.9f, 0.3f, 0.1f}, .roughness = roughness};
      const double alpha = lobe.width();
      check_lobe(lobe, z, 1, 2 * 16 / alpha,
                 [=](const Vec3& light) { return 12 + 2 / alpha * 6 / length(viewer_at(z) + light); });
    }
}

TEST_CASE("at normal incidence Phong's lobe reflects its color's share, for every exponent") {
  for (const double exponent : {0.0, 1.0, 30.0}) {
    const PhongLobe lobe{.color = Color{0.8f}, .exponent = exponent};
    const auto reflection = [&](double z) {
      return double{lobe.reflection({0, 0, 1}, {std::sqrt((1 - z) * (1 + z)), 0, z}).g};
    };
    double sum = 0;  // Gauss and Legendre's rule is exact to more digits for powers up to 31 in quarters
    for (const double from : {0.0, 0.25, 0.5, 0.75}) sum += detail::gauss_legendre(reflection, from, 0.25);
    CHECK(std::abs(2 * std::numbers::pi * sum / double{0.8f} - 1) <= of_float);
  }
  // (n + 2)/2π · cosⁿ, with n = 0 as on a diffuse surface.
  const auto value = [](double exponent) {
    return double{PhongLobe{.exponent = exponent}.value({0, 0, 1}, {0.6, 0, 0.8}).g};
  };
  CHECK(std::abs(value(0) * std::numbers::pi - 1) <= of_float);
  CHECK(std::abs(value(2) * std::numbers::pi / 1.28 - 1) <= of_float);
}

TEST_CASE("a Phong lobe with an exponent of a million is as narrow as a mirror, and has digits") {
  const PhongLobe lobe{.exponent = 1e6};
  const Vec3 view = viewer_at(0.5);
  Random random(3);
  WrongCases wrong(random);
  // A number u gives cos θ = u^(1/(n + 1)). Since θ²/2 ≤ −ln cos θ, θ² ≤ 2 ln(1/u)/n, and u is at least
  // 2^-33.
  const double widest = std::sqrt(2 * 33 * std::numbers::ln2 / lobe.exponent);
  for (int i = 0; i < 1000; ++i) {
    const auto [light, density, weight] = lobe.sample(view, random.interior(), random.interior());
    wrong.add(!(length(light - Vec3{-view.x, -view.y, view.z}) < widest), light);
    wrong.add(!(std::abs(lobe.density(view, light) / density - 1) <= (1e6 + 1) * 0x1p-51), light, density);
    const double gain = (lobe.exponent + 2) / (lobe.exponent + 1);
    wrong.add(!(std::abs(weight.g / (gain * light.z) - 1) <= of_float), light, weight.g);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a GGX lobe by hand: head on, its value is F/(4π α²), and Schlick's F grows to 1") {
  // D = 1/(π α²), G = 1, α = 1/4.
  const GgxLobe lobe{.color = Color{0.5f, 0.25f, 0}, .roughness = 0.5};
  const Color head_on = lobe.value({0, 0, 1}, {0, 0, 1});
  CHECK(std::abs(double{head_on.r} * std::numbers::pi / 4 / 0.5 - 1) <= of_float);
  CHECK(head_on.g == head_on.r / 2);
  CHECK(head_on.b == 0);
  // For α = 1, D = 1/π everywhere. Light and view at 60 degrees on opposite sides have F = F0 + (1 − F0)/32,
  // G = 1/(1 + Λ + Λ) with Λ = (√(1 + tan² 60°) − 1)/2 = 1/2.
  const double r = std::sqrt(0.75);
  const Color rough = GgxLobe{.color = Color{0.5f}, .roughness = 1}.value({r, 0, 0.5}, {-r, 0, 0.5});
  CHECK(std::abs(rough.g / ((0.5 + 0.5 / 32) / std::numbers::pi * 0.5) - 1) <= of_float);
}

TEST_CASE("a lobe without roughness is a mirror, with the color's share and 1 at grazing angles") {
  const GgxLobe mirror{.color = Color{0.5f}, .roughness = 0};
  Random random(4);
  WrongCases wrong(random);
  // Normals are tilted by at most α |h.xy|/h.z (VisibleNormals::sample), where h is the sum of a unit vector
  // and the stretched view w, and h.z = (1 − v) (1 + w.z). The sum is at most 2 long: the tilt is at most
  // 2/(1 − v) α. For a view of z > .01, w is upright but for |w.xy| < 10^-4, so that |h.xy|/h.z is √(v/(1 −
  // v)) but for 10^-4/(2 (1 − v)), which is .05 for v ≤ .999. Reflected light turns twice as far.
  const double width = GgxLobe::least_width;
  // D is 1/(π α² (1 + t²)²) at a tilt of t α; the density is D over twice z + √(z² + α² (1 − z²)), which is
  // at least α. The quotient is least for a view at the horizon, where t comes to 2000: 1.1e4.
  const double least_density = 1e4;
  for (int i = 0; i < 2000; ++i) {
    const double z = i % 2 == 0 ? random.real(0.01, 1) : std::exp2(random.real(-40, 0));
    const double v = random.real(0, 0.999);
    const Vec3 view = viewer_at(z);
    const auto [light, density, weight] = mirror.sample(view, random.interior(), v);
    const double tilt = (z > 0.01 ? std::sqrt(v / (1 - v)) + 0.06 : 2 / (1 - v)) * width;
    wrong.add(!(length(light - Vec3{-view.x, -view.y, view.z}) < 2 * tilt), view, light);
    wrong.add(!(density > least_density && std::isfinite(density)), view, density);
    // The cosine to a tilted normal differs by the tilt at most, and the slope of Schlick's ½ (1 − cos)⁵ is
    // at most 5/2. G/G1 is 1 but for α²/z² < 10^-8, and floats are rounded by 2^-24.
    const double rest = std::pow(1 - z, 5);
    if (z > 0.01)
      wrong.add(!(std::abs(weight.g - (0.5 + 0.5 * rest)) < 2.5 * tilt + 0x1p-23), view, weight.g);
  }
  CHECK(wrong == 0);
  const Vec3 view = viewer_at(0.3);
  // Beside the mirror direction, only the distribution's tail is left: D = α²/(π sin⁴ θ) and G = 1, but for
  // shares of α² over squares of cosine and sine, which are above 2^-8.
  const Vec3 beside = normalize(Vec3{-view.x, -view.y, view.z} + 0.2 * Vec3{0, 1, 0}), sum = view + beside;
  const double square = dot(sum, sum), sine2 = (sum.x * sum.x + sum.y * sum.y) / square;
  const double F = 0.5 + 0.5 * std::pow(1 - std::sqrt(square) / 2, 5);
  const double tail = F * width * width / (std::numbers::pi * sine2 * sine2) / (4 * view.z);
  CHECK(std::abs(mirror.reflection(view, beside).g / tail - 1) <= of_float + 4 * width * width * 0x1p8);
}

TEST_CASE("lobes have numbers, and none below 0, for views and lights at the horizon and below") {
  Random random(5);
  WrongCases wrong(random);
  const auto direction = [&](int kind) -> Vec3 {
    if (kind == 0) return normalize(Vec3{random.real(-1, 1), random.real(-1, 1), 0});
    if (kind == 1) return normalize(Vec3{1, 0, std::exp2(random.real(-1074, -1))});
    if (kind == 2) return normalize(Vec3{-1, 0, std::exp2(random.real(-1074, -1))});
    if (kind == 3) return {0, 0, 1};
    return random.direction();
  };
  const auto is_good = [](const Color& c) { return is_light(c); };
  const auto check = [&](const auto& lobe, const Vec3& view, const Vec3& light) {
    const bool is_above = view.z >= 0 && light.z > 0;
    wrong.add(!is_good(lobe.value(view, light)), "value", view, light);
    wrong.add(!is_good(lobe.reflection(view, light)), "reflection", view, light);
    wrong.add(!is_above && lobe.reflection(view, light) != Color{0}, "through the surface", view, light);
    wrong.add(!is_above && lobe.value(view, light) != Color{0}, "value through the surface", view, light);
    const double density = lobe.density(view, light);
    wrong.add(!(density >= 0 && std::isfinite(density)), "density", view, light, density);
    const auto sample = lobe.sample(view, random.interior(), random.interior());
    wrong.add(!is_good(sample.weight) || !(sample.density >= 0 && std::isfinite(sample.density)), "sample",
              view);
    wrong.add(!(std::abs(length(sample.direction) - 1) <= length_roundings * 0x1p-53), "length", view,
              sample.direction);
    wrong.add(!(sample.direction.z > 0 && view.z >= 0) && sample.weight != Color{0}, "weight", view);
  };
  for (int i = 0; i < 5000; ++i) {
    const Vec3 view = direction(i % 5), light = direction(i / 5 % 5);
    for (const double roughness : {0.0, 0.01, 0.5, 1.0})
      for (const float color : {0.0f, 0.5f, 1.0f, 3e38f / 4})
        check(GgxLobe{.color = Color{color}, .roughness = roughness}, view, light);
    for (const double exponent : {0.0, 0.5, 50.0, 1e6}) check(PhongLobe{.exponent = exponent}, view, light);
  }
  CHECK(wrong == 0);
}

TEST_CASE("a rough GGX lobe reflects as much of light from everywhere as its comment says") {
  struct Row {
    double roughness, share;
  };
  for (const auto& [roughness, share] : {Row{0, 1}, Row{0.5, 0.88}, Row{1, 0.41}}) {
    double sum = 0;
    constexpr int n = 64;
    for (int i = 0; i < n; ++i)  // views in proportion to the cosine
      sum += ggx_share(roughness, viewer_at(std::sqrt((i + 0.5) / n)));
    CHECK(std::abs(sum / n - share) < 0.005);  // which has two digits
  }
}

TEST_CASE("docs/stages/22_glossy.md: what the roughest white metal reflects, by the view") {
  struct Row {
    double cosine, share;
  };
  const double degree = std::numbers::pi / 180;
  for (const auto& [cosine, share] :
       {Row{1, 0.31}, Row{0.5, 0.45}, Row{std::cos(80 * degree), 0.67}, Row{0, 1}})
    CHECK(std::abs(ggx_share(1, viewer_at(cosine)) - share) < 0.005);  // which has two digits
}

// These values would differ between machines if functions of the C library took part.
TEST_CASE("lobes have the same bits on every machine") {
  const GgxLobe ggx{.color = Color{0.9f, 0.3f, 0.1f}, .roughness = 0.6};
  const auto [light, density, weight] = ggx.sample({0.6, 0, 0.8}, 0.3, 0.6);
  CHECK(light.x == -0x1.40baa83332bd5p-1);
  CHECK(density == 0x1.71ca51edba563p-3);
  CHECK(weight.b == 0x1.826bap-4f);
  CHECK(PhongLobe{.exponent = 7.5}.sample({0.6, 0, 0.8}, 0.3, 0.6).direction.x == -0x1.78d4a0f51710dp-1);
}
