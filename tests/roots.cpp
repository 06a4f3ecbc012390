#include <algorithm>
#include <cmath>
#include <limits>
#include <protostar/numeric/roots.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/common.hpp"
#include "support/random.hpp"

using namespace protostar;

namespace {}  // namespace

TEST_CASE("roots are sorted, and first_in returns the first one inside a range") {
  const Roots roots{1, 3};
  CHECK(list(roots) == std::vector<double>{1, 3});
  CHECK(roots.first_in({}) == 1.0);
  CHECK(roots.first_in({.min = 1}) == 3.0);
  CHECK(roots.first_in({.min = 2}) == 3.0);
  CHECK_FALSE(roots.first_in({.min = 1, .max = 3}));
  CHECK_FALSE(roots.first_in({.min = 3}));
  CHECK(list(Roots{2}) == std::vector<double>{2});
  CHECK(list(Roots{}).empty());
  CHECK_FALSE(Roots{}.first_in({.min = -infinity}));
}

TEST_CASE("a quadratic has two roots, one twice, or none") {
  // A t² − 2 b t + c = 0
  CHECK(list(quadratic_roots(1, 2, 3, 1)) == std::vector<double>{1, 3});
  CHECK(list(quadratic_roots(1, -2, 3, 1)) == std::vector<double>{-3, -1});
  CHECK(list(quadratic_roots(4, 4, 3, 4)) == std::vector<double>{0.5, 1.5});
  CHECK(list(quadratic_roots(1, 0, -4, 4)) == std::vector<double>{-2, 2});
  CHECK(list(quadratic_roots(1, 2, 4, 0)) == std::vector<double>{2, 2});
  CHECK(list(quadratic_roots(1, 0, 0, 0)) == std::vector<double>{0, 0});
  CHECK(list(quadratic_roots(1, 1, 2, -1)).empty());
  CHECK(list(quadratic_roots(1, 1, 1, std::numeric_limits<double>::quiet_NaN())).empty());
}

TEST_CASE("latest(t) is an upper bound of the roots that may precede t, at any scale") {
  const double denorm = std::numeric_limits<double>::denorm_min();
  for (const double t : {denorm, 3 * denorm, 1e-310, std::numeric_limits<double>::min(), 1e-30, 1.0, 1e300}) {
    CHECK(upper_bound_of(t) > t);
    CHECK(upper_bound_of(t) >= (1 + 2 * Roots::relative_error) * t);
    CHECK(upper_bound_of(-t) > -t);
  }
}

TEST_CASE("neither root of a quadratic loses digits, however different their sizes are") {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    // Roots of similar size to roots of which one is 10^11 times the other.
    const double A = random.real(0.5, 2), b = std::exp(random.real(0, 12)), c = random.real(0.1, 0.4);
    const long double D = static_cast<long double>(b) * b - static_cast<long double>(A) * c;
    const long double far = (b + std::sqrt(D)) / A, near = c / (far * A);
    for (const int sign : {1, -1}) {
      const auto t = list(quadratic_roots(A, sign * b, c, static_cast<double>(D)));
      REQUIRE(t.size() == 2);
      worst = std::max(worst, std::abs(static_cast<double>(t[sign > 0 ? 0 : 1] * sign / near - 1)));
      worst = std::max(worst, std::abs(static_cast<double>(t[sign > 0 ? 1 : 0] * sign / far - 1)));
    }
  }
  // With u = 2^-53, D is off by u, its root by 1.5u, the sum q by 2.5u and a quotient with it by 3.5u; the
  // comparison rounds by u.
  CHECK(worst <= 4.501 * 0x1p-53);
}
