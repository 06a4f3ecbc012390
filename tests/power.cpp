#include <protostar/numeric/power.hpp>

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "support/long_double.hpp"
#include "support/random.hpp"

using namespace protostar;

TEST_CASE("an n-th power has a relative error below n units of roundoff") {
  CHECK(whole_power(0.0, 0) == 1);
  CHECK(whole_power(0.0, 1) == 0);
  CHECK(whole_power(1.0, 65536) == 1);
  CHECK(whole_power(0.3, 1) == 0.3);
  CHECK(whole_power(0.5, 3) == 0.125);
  CHECK(whole_power(0.75, 4) == 0.31640625);
  CHECK(whole_power(0.5, 1000) == 0x1p-1000);
  CHECK(whole_power(0.5, 2000) == 0);
  if (!long_double_judges()) return;
  Random random(6);
  for (const int n : {2, 3, 5, 10, 50, 125, 1425, 4095, 60001}) {
    double most = 0;
    for (int i = 0; i < 2000; ++i) {
      const double x = std::exp2(-random.real(0, 300.0 / n));
      const long double power = std::pow(static_cast<long double>(x), n);
      most = std::max(most, static_cast<double>(std::abs(whole_power(x, n) / power - 1)));
    }
    CAPTURE(n, most);
    CHECK(most < n * 0x1p-53);
  }
}
