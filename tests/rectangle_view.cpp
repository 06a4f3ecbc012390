// Rectangles as lights, seen from several points at once.
#include <array>
#include <cmath>
#include <cstddef>
#include <protostar/sampling/rectangle_view.hpp>
#include <protostar/simd/simd.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/random.hpp"
#include "support/wrong_cases.hpp"

using namespace protostar;

TEST_CASE("directions to a rectangle from several points have the bits of those from each") {
  Random random(21);
  WrongCases wrong(random);
  constexpr auto lanes = static_cast<std::size_t>(simd::double_lanes);
  for (int i = 0; i < 1500; ++i) {
    // Rectangles of all sizes; points near and far, on both sides of the plane, in it, and on the lines of
    // the edges.
    const double size = std::exp2(random.real(-4, 4) + (i % 10 == 9 ? 480 * random.real(-1, 1) : 0));
    const Vec3 x = random.direction(), y = normalize(cross(x, random.direction())), z = cross(x, y);
    const RectangleLight light(size * random.point(1), size * x, size * random.real(0.1, 2) * y);
    std::vector<Point> from(1 + static_cast<std::size_t>(i) % lanes);
    FewNumbers u{}, v{};
    for (std::size_t k = 0; k < from.size(); ++k) {
      const double off = std::exp2(random.real(-40, 10)), along = i % 7 == 1 ? 0 : random.real(-2, 3);
      const double height = i % 7 == 2 ? 0 : random.real(-1, 1) * off;
      from[k] = light.position + size * (along * x + random.real(-2, 3) * y + height * z);
      u[k] = random.interior(), v[k] = random.interior();
    }
    std::array<LightSample, lanes> drawn;
    RectangleView::sample_each(light, from, u, v, drawn);
    for (std::size_t k = 0; k < from.size(); ++k) {
      const LightSample alone = RectangleView(from[k], light).sample(u[k], v[k]);
      wrong.add(drawn[k].direction != alone.direction || drawn[k].distance != alone.distance ||
                    drawn[k].density != alone.density,
                size, from[k], light.position, u[k], v[k]);
    }
  }
  CHECK(wrong == 0);
}
