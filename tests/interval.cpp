#include <limits>
#include <protostar/interval.hpp>

#include "support/catch.hpp"

using namespace protostar;

TEST_CASE("an interval is open: neither end belongs to it") {
  const Interval interval{.min = 1, .max = 2};
  CHECK(interval.contains(1.5));
  CHECK_FALSE(interval.contains(1));
  CHECK_FALSE(interval.contains(2));
  CHECK_FALSE(interval.contains(0));
  CHECK_FALSE(interval.contains(3));
}

TEST_CASE("the default interval contains all finite t above 0") {
  CHECK(Interval{}.contains(std::numeric_limits<double>::denorm_min()));
  CHECK(Interval{}.contains(std::numeric_limits<double>::max()));
  CHECK_FALSE(Interval{}.contains(0));
  CHECK_FALSE(Interval{}.contains(infinity));
}

TEST_CASE("NaN belongs to no interval, and an interval with a NaN end is empty") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(Interval{}.contains(nan));
  CHECK_FALSE(Interval{.min = nan}.contains(1));
  CHECK_FALSE(Interval{.max = nan}.contains(1));
}
