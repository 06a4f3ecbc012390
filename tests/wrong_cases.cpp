// Counts of wrong cases, which other tests rely on.
#include "support/wrong_cases.hpp"

#include <protostar/surfaces/sphere.hpp>
#include <sstream>

#include "support/catch.hpp"

using namespace protostar;

TEST_CASE("a count of wrong cases tells the first of them, with its seed and all digits") {
  Random random(21);
  WrongCases wrong(random);
  const auto text = [&] {
    std::ostringstream out;
    out << wrong;
    return out.str();
  };
  wrong.add(false, "right");
  CHECK(wrong == 0);
  CHECK(text() == "0");
  random.bits();
  wrong.add(true, Sphere{.center = {0.1, 2, 3}, .radius = 0.5}, "t", 1 / 3.0);
  wrong.add(true, "a later one");
  CHECK(wrong == 2);
  CHECK_FALSE(wrong == 0);
  CHECK(text() ==
        "2 (the first: seed 21 after 1 numbers (center {0.10000000000000001, 2, 3}, radius 0.5) t "
        "0.33333333333333331)");
}
