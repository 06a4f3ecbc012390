// Compares the codes of light with their definition, in long double, and measures their cost.
//
//   stress_encode [--all]
//
// The short form checks both sides of every code's threshold, random powers, and powers so close to a float
// that double-double leaves them in doubt. --all evaluates the definition at every float from 0 to 1, for
// minutes. Exits with 1 if a single code or comparison is wrong.

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <protostar/encode.hpp>
#include <string_view>
#include <vector>

#include "stress/exact.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {

int failures = 0;

void check(bool right, const char* what, double at) {
  if (right) return;
  if (++failures <= 20) std::printf("WRONG: %s at %a\n", what, at);
}

// ---- The definition

/// Returns the value that light is encoded as, from 0 to 1, with 11 bits more than double has.
long double encoded(const Transfer& transfer, float light) {
  struct {
    long double x;
    long double operator()(Srgb) const {
      return x <= 0.0031308L ? 12.92L * x : 1.055L * std::pow(x, 1 / 2.4L) - 0.055L;
    }
    long double operator()(Linear) const { return x; }
    long double operator()(Gamma gamma) const {
      return std::pow(x, 1 / static_cast<long double>(gamma.exponent));
    }
  } const curve{light};
  return std::visit(curve, transfer);
}

/// Returns the nearest code. Checks that the error of long double tells a value from the midpoint between two
/// codes: it always does, with room to spare, except at the middle of the scale, which is exact.
int nearest_code(long double value, int max_code) {
  const long double x = max_code * value + 0.5L, code = std::floor(x);
  check(value == 0.5L || std::min(x - code, code + 1 - x) > 0x1p-58L * max_code, "no room to tell",
        static_cast<double>(value));
  return static_cast<int>(code);
}

// ---- Codes

struct Named {
  const char* name;
  Transfer transfer;
};

/// Checks both sides of each threshold. Codes and their definition rise with light, so if they agree there,
/// they agree at all floats.
void check_thresholds(const Named& named, int max_code) {
  const Encoder encode(named.transfer, max_code);
  int undecided = 0;
  for (int code = 1; code <= max_code; ++code) {
    const float at = encode.threshold(code), below = std::nextafter(at, -1.0f);
    for (const float light : {at, below}) {
      const int expected = light > 0 ? nearest_code(encoded(named.transfer, light), max_code) : 0;
      check(encode(light) == expected, named.name, static_cast<double>(light));
    }
    const DoubleDouble light(
        std::visit([&](auto curve) { return decode(curve, 2 * code - 1, 2 * max_code); }, named.transfer));
    for (const float side : {at, below})
      if (std::abs((light - static_cast<double>(side)).hi) <= 0x1p-57 * light.hi) ++undecided;
  }
  std::printf("%-12s %5d: both sides of each threshold; double-double leaves %d open\n", named.name, max_code,
              undecided);
}

/// Checks the definition itself, at every float.
void check_all_floats(const Named& named) {
  const Encoder narrow(named.transfer, 255), wide(named.transfer, 65535);
  constexpr auto last = std::bit_cast<std::uint32_t>(1.0f);
  for (std::uint32_t bits = 0; bits <= last; ++bits) {
    const float light = std::bit_cast<float>(bits);
    const long double value = encoded(named.transfer, light);
    check(narrow(light) == nearest_code(value, 255), named.name, static_cast<double>(light));
    check(wide(light) == nearest_code(value, 65535), named.name, static_cast<double>(light));
  }
  std::printf("%-12s 255 and 65535: all %u floats from 0 to 1\n", named.name, last + 1);
}

// ---- Powers

/// Checks powers by long double, whose x^y has an error of about 2^-63 (1 + |y log2 x|), which limits this
/// check.
void check_powers() {
  Random random(5);
  long double largest = 0;
  for (int i = 0; i < 200000; ++i) {
    const double x = std::ldexp(random.real(1, 2), static_cast<int>(random.bits() % 1000) - 500);
    const double near_1 = 1 + random.real(-1, 1) * std::ldexp(1, -static_cast<int>(random.bits() % 50));
    for (const double base : {x, near_1}) {
      const double reach = 150 / std::max(std::abs(std::log2(base)), 1e-290), y = random.real(-reach, reach);
      const DoubleDouble power = pow(DoubleDouble(base), DoubleDouble(y));
      const long double expected = std::pow(static_cast<long double>(base), static_cast<long double>(y));
      const long double found = static_cast<long double>(power.hi) + static_cast<long double>(power.lo);
      largest = std::max(largest, std::abs(found / expected - 1));
    }
  }
  check(largest < 0x1p-57L, "the error of a power", static_cast<double>(largest));
  for (int n = -1000; n < 1024; ++n) {
    check(pow(DoubleDouble(2), DoubleDouble(n)).hi == std::ldexp(1, n), "2^n", n);
    check(pow(DoubleDouble(0.5), DoubleDouble(-n)).lo == 0, "2^n", n);
  }
  std::printf("powers: largest relative error 2^%.1f, of 2^-57\n", static_cast<double>(std::log2(largest)));
}

/// Checks (a²)^(1/2 + e) against a, and (a²)^(3/2 + e) against a³, for an e of one ulp: their order is known,
/// and they differ by as little as 2^-76 of themselves.
void check_close_comparisons() {
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    const double gap = std::ldexp(1, static_cast<int>(random.bits() % 24) - 24);  // from 2^-24 to 1/2
    const double a = std::bit_cast<float>(static_cast<std::uint32_t>(
        std::bit_cast<std::uint32_t>(static_cast<float>(1 - gap)) | (random.bits() % 2)));
    if (!(a < 1)) continue;
    for (const double third : {0.0, 1.0}) {
      const double y = 0.5 + third, x = a, z = 1 + 2 * third;
      check(power_exceeds(a * a, 1, std::nextafter(y, 0), x, z), "a power that is greater", a);
      check(!power_exceeds(a * a, 1, std::nextafter(y, 9), x, z), "a power that is less", a);
    }
  }
  for (const double exponent : {1.0, 2.0, 3.0, 40.0}) {
    const double x = std::ldexp(1, -static_cast<int>(exponent));
    check(!power_exceeds(255, 510, exponent, x, 1), "a power that is equal", exponent);
    check(power_exceeds(255, 510, std::nextafter(exponent, 0), x, 1), "½ to a little less", exponent);
    check(!power_exceeds(255, 510, std::nextafter(exponent, 99), x, 1), "½ to a little more", exponent);
  }
  std::printf("comparisons that double-double cannot make\n");
}

/// Returns ln x to 100 bits, by the series of the inverse hyperbolic tangent.
exact::Quad logarithm(exact::Quad x) {
  const auto series = [](exact::Quad z) {
    exact::Quad sum = 0, power = z;
    for (int k = 1; k < 120; k += 2, power *= z * z) sum += power / k;
    return 2 * sum;
  };
  int halvings = 0;
  for (; x < 0.75; x *= 2) ++halvings;
  return series((x - 1) / (x + 1)) - halvings * series(exact::Quad(1) / 3);
}

/// Checks exponents for which the light of a code is so close to a float that double-double leaves in doubt
/// on which side it is, and would guess some sides wrong.
void check_close_exponents() {
  Random random(8);
  int near_by = 0, guessed_wrongly = 0;
  for (int i = 0; i < 60000; ++i) {
    const float light = static_cast<float>(i % 256 == 0 ? 1 - random.real(0, 1e-6) : random.real(0.1, 1));
    const int code = 1 + static_cast<int>(random.bits() % 255);
    if (code == 128 || light == 1) continue;
    const int n = 2 * code - 1, d = 510;
    const exact::Quad log_light = logarithm(exact::Quad(light)), log_value = logarithm(exact::Quad(n) / d);
    const double exponent = static_cast<double>(log_light / log_value);
    const DoubleDouble excess = pow(quotient(n, d), DoubleDouble(exponent)) - static_cast<double>(light);
    if (std::abs(excess.hi) > 0x1p-61 * static_cast<double>(light)) continue;
    ++near_by;
    const bool exceeds = exact::Quad(exponent) * log_value > log_light;
    if (exceeds != (excess.sign() > 0)) ++guessed_wrongly;
    check(power_exceeds(n, d, exponent, static_cast<double>(light), 1) == exceeds, "a comparison", exponent);
    check(Encoder(Gamma{exponent}, 255).threshold(code) == (exceeds ? std::nextafter(light, 2.0f) : light),
          "a threshold next to a float", exponent);
  }
  check(guessed_wrongly > 0, "no case that needs exact arithmetic", guessed_wrongly);
  std::printf("%d exponents that lead next to a float; double-double would be wrong about %d\n", near_by,
              guessed_wrongly);
}

// ---- Time

/// Measures a million values, most of them in [0, 1]: the least time of many runs, since others use the
/// machine as well.
void measure() {
  Random random(7);
  std::vector<float> light(1 << 20);
  for (float& x : light) x = static_cast<float>(random.real(-0.02, 1.05));
  std::vector<unsigned char> codes(light.size());
  const auto nanoseconds = [](auto&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count();
  };
  for (const int max_code : {255, 65535}) {
    double table = 1e12, value = 1e12;
    unsigned sum = 0;  // printed, so that the work is not optimized away
    for (int run = 0; run < 10; ++run)
      table = std::min(table, nanoseconds([&] { sum += Encoder(Srgb{}, max_code)(0.5f); }));
    const Encoder encode(Srgb{}, max_code);
    for (int run = 0; run < 40; ++run) {
      value = std::min(value, nanoseconds([&] {
                         for (std::size_t i = 0; i < light.size(); ++i)
                           codes[i] = static_cast<unsigned char>(encode(light[i]));
                       }));
      for (const unsigned char code : codes) sum += code;
    }
    std::printf("sRGB %5d: %.2f ns a value, %.2f ms for the table (sum %u)\n", max_code,
                value / static_cast<double>(light.size()), table * 1e-6, sum);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool all = argc == 2 && std::string_view(argv[1]) == "--all";
  if (argc > 1 && !all) {
    std::fprintf(stderr, "usage: stress_encode [--all]\n");
    return 2;
  }
  const Named transfers[] = {{"sRGB", Srgb{}},          {"linear", Linear{}},
                             {"gamma 2.2", Gamma{}},    {"gamma 1", Gamma{1}},
                             {"gamma 2", Gamma{2}},     {"gamma 1.8", Gamma{1.8}},
                             {"gamma 2.4", Gamma{2.4}}, {"gamma 0.45", Gamma{0.45}},
                             {"gamma 100", Gamma{100}}, {"gamma 0.001", Gamma{0.001}}};
  for (const Named& named : transfers)
    for (const int max_code : {255, 65535}) check_thresholds(named, max_code);
  check_powers();
  check_close_comparisons();
  check_close_exponents();
  if (all)
    for (const Named& named : {transfers[0], transfers[1], transfers[2]}) check_all_floats(named);
  measure();
  std::printf(failures == 0 ? "all right\n" : "%d wrong\n", failures);
  return failures == 0 ? 0 : 1;
}
