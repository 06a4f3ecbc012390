#include <bit>
#include <cmath>
#include <limits>
#include <protostar/encode.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/errors.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

namespace {
/// Returns the code by definition, in long double: from the transfer curve itself, which the library inverts.
int defined_code(const Transfer& transfer, int max_code, float light) {
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
  if (!(light > 0)) return 0;
  if (light >= 1) return max_code;
  return static_cast<int>(std::floor(max_code * std::visit(curve, transfer) + 0.5L));
}

std::string name(const Transfer& transfer) {
  struct {
    std::string operator()(Srgb) const { return "sRGB"; }
    std::string operator()(Linear) const { return "linear"; }
    std::string operator()(Gamma gamma) const { return "gamma " + std::to_string(gamma.exponent); }
  } const text;
  return std::visit(text, transfer);
}

const std::vector<Transfer> transfers{Srgb{},      Linear{},     Gamma{2.2},  Gamma{1},
                                      Gamma{0.45}, Gamma{100.0}, Gamma{0.01}, Gamma{1e-5}};

/// Counts deviations from the definition on both sides of each threshold. Codes and definition both rise with
/// light, so if they agree on both sides of each threshold they agree for all floats.
WrongCases wrong_thresholds(const Transfer& transfer, int max_code) {
  const Encoder encode(transfer, max_code);
  WrongCases wrong;
  for (int code = 1; code <= max_code; ++code) {
    const float at = encode.threshold(code), below = std::nextafter(at, -1.0f);
    for (const float light : {at, below})
      wrong.add(encode(light) != defined_code(transfer, max_code, light), "light", light, "has code",
                encode(light));
    wrong.add(!(encode(below) < code && code <= encode(at)), "code", code, "begins at", at);
  }
  return wrong;
}
}  // namespace

TEST_CASE("each 8-bit code begins at the float that its definition gives") {
  for (const Transfer& transfer : transfers) {
    INFO(name(transfer));
    CHECK(wrong_thresholds(transfer, 255) == 0);
  }
}

TEST_CASE("each 16-bit code begins at the float that its definition gives") {
  for (const Transfer& transfer : transfers) {
    INFO(name(transfer));
    CHECK(wrong_thresholds(transfer, 65535) == 0);
  }
}

TEST_CASE("the codes of random light are those of the definition") {
  Random random(14);
  for (const Transfer& transfer : transfers)
    for (const int max_code : {255, 65535}) {
      INFO(name(transfer) << ", maximum " << max_code);
      const Encoder encode(transfer, max_code);
      WrongCases wrong(random);
      for (int i = 0; i < 20000; ++i) {
        // Half of the numbers are uniform in [0, 1), half uniform among the floats in it.
        const float light = i % 2 == 0 ? static_cast<float>(random.real(0, 1))
                                       : std::bit_cast<float>(static_cast<std::uint32_t>(
                                             random.bits() % std::bit_cast<std::uint32_t>(1.0f)));
        wrong.add(encode(light) != defined_code(transfer, max_code, light), light);
      }
      CHECK(wrong == 0);
    }
}

TEST_CASE("colors that are encoded together have the codes of each channel alone") {
  Random random(15);
  for (const Transfer& transfer : transfers)
    for (const int max_code : {255, 65535}) {
      INFO(name(transfer) << ", maximum " << max_code);
      const Encoder encode(transfer, max_code);
      std::vector<Color> light;
      for (int i = 0; i < 1001; ++i) {
        const auto channel = [&] { return static_cast<float>(random.real(-0.1, 1.1)); };
        light.push_back({channel(), channel(), channel()});
      }
      light.push_back({std::numeric_limits<float>::quiet_NaN(), -0.0f, 1});
      light.push_back({std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), 0});
      std::vector<std::uint16_t> codes(3 * light.size() + 1, 7);
      encode(light.data(), static_cast<int>(light.size()), codes.data());
      WrongCases wrong(random);
      for (std::size_t i = 0; i < light.size(); ++i)
        for (int k = 0; k < 3; ++k)
          wrong.add(codes[3 * i + static_cast<std::size_t>(k)] != encode(light[i][k]), light[i][k]);
      CHECK(wrong == 0);
      CHECK(codes.back() == 7);
    }
}

TEST_CASE("light of round values has the expected codes") {
  struct {
    Transfer transfer;
    int max_code;
    float light;
    int expected;
  } const rows[] = {
      {Linear{}, 255, 0.5f, 128},  // 127.5 is a tie, rounded up
      {Linear{}, 255, 0.25f, 64},   {Linear{}, 65535, 0.5f, 32768}, {Srgb{}, 255, 0.5f, 188},
      {Srgb{}, 255, 0.18f, 118},    {Srgb{}, 255, 0.002f, 7},       {Gamma{2.2}, 255, 0.5f, 186},
      {Gamma{2.2}, 255, 0.01f, 31}, {Gamma{1}, 255, 0.25f, 64},     {Gamma{2}, 255, 0.25f, 128},
      {Gamma{0.5}, 255, 0.5f, 64},
  };
  for (const auto& row : rows) {
    INFO(name(row.transfer) << " of " << row.light);
    CHECK(Encoder(row.transfer, row.max_code)(row.light) == row.expected);
  }
}

TEST_CASE("negative light and NaN have code 0, light of 1 and above has the maximum") {
  for (const Transfer& transfer : transfers)
    for (const int max_code : {255, 65535}) {
      INFO(name(transfer) << ", maximum " << max_code);
      const Encoder encode(transfer, max_code);
      CHECK(encode.max_code() == max_code);
      for (const float dark :
           {float_nan, -float_nan, -1.0f, -0.0f, 0.0f, -float_infinity,
            -std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::lowest()})
        CHECK(encode(dark) == 0);
      for (const float bright :
           {1.0f, std::nextafter(1.0f, 2.0f), 2.0f, std::numeric_limits<float>::max(), float_infinity})
        CHECK(encode(bright) == max_code);
    }
}

TEST_CASE("the smallest floats above 0 have the codes of the definition") {
  constexpr float tiny = std::numeric_limits<float>::denorm_min();
  CHECK(Encoder(Srgb{}, 65535)(tiny) == 0);
  CHECK(Encoder(Linear{}, 65535)(tiny) == 0);
  CHECK(Encoder(Gamma{2.2}, 65535)(tiny) == 0);
  CHECK(Encoder(Gamma{100}, 255)(tiny) == 91);  // 255 · 2^-1.49
  for (const float light : {tiny, 2 * tiny, 100 * tiny, std::numeric_limits<float>::min()})
    CHECK(Encoder(Gamma{100}, 65535)(light) == defined_code(Gamma{100}, 65535, light));
}

TEST_CASE("decoding inverts the transfer curves") {
  CHECK(decode(Srgb{}, 0) == 0);
  CHECK(decode(Srgb{}, 1) == 1);  // 1.055/1.055
  // With u = 2^-53, the base is off by 3u, its power by 2.4 times that and u: by less than 2u of 1.
  CHECK(std::abs(decode(Srgb{}, 0.5) - 0.21404114048223255) <= 0x1p-52);
  CHECK(decode(Srgb{}, 0.04) == 0.04 / 12.92);
  CHECK(decode(Linear{}, 0.3) == 0.3);
  CHECK(decode(Gamma{2}, 0.5) == 0.25);
}

TEST_CASE("with a gamma near the maximum of double all light above 0 has the maximum code") {
  for (const double exponent : {1e300, 1e307, 3e307, 1e308, std::numeric_limits<double>::max()})
    for (const int max_code : {255, 65535}) {
      const Encoder encode(Gamma{exponent}, max_code);
      CHECK(encode(0.0f) == 0);
      CHECK(encode(1.0f) == max_code);
      CHECK(encode(std::numeric_limits<float>::denorm_min()) == max_code);  // a root of so high an order is 1
    }
}

TEST_CASE("a gamma exponent that is not finite and greater than 0 is refused") {
  constexpr double huge = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -0.0, -1.0, huge, -huge, std::numeric_limits<double>::quiet_NaN()})
    CHECK_THAT(message_of<std::invalid_argument>([&] { Encoder(Gamma{bad}, 255); }),
               ContainsSubstring("Encoder: gamma must be finite and greater than 0; it is "));
}

TEST_CASE("the maximum code of an encoder is from 1 to 65535") {
  CHECK_THROWS_AS(Encoder(Linear{}, 0), std::invalid_argument);
  CHECK_THROWS_AS(Encoder(Linear{}, -1), std::invalid_argument);
  CHECK_THROWS_AS(Encoder(Linear{}, 65536), std::invalid_argument);
  for (const int even : {2, 256, 65534}) CHECK_THROWS_AS(Encoder(Linear{}, even), std::invalid_argument);
  CHECK(Encoder(Linear{}, 3)(0.5f) == 2);
  CHECK(Encoder(Linear{}, 1)(0.5f) == 1);
  CHECK(Encoder(Linear{}, 1)(0.49f) == 0);
}

TEST_CASE("a color is encoded channel by channel", "[encode]") {
  const Encoder encode(Gamma{2.2}, 255);
  const auto codes = encode(Color{0.1f, 0.5f, 2});
  CHECK(codes[0] == encode(0.1f));
  CHECK(codes[1] == encode(0.5f));
  CHECK(codes[2] == 255);
}
