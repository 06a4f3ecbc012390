// Counts the undecided rays of the pictures of the stages that march, which must be none.
//
//   undecided_rays
//
// Draws the scenes of stages 33 to 38 with their shadows, at the stages' size of 640×480, and prints for each
// the number of rays that double-double does not decide (RenderStatistics). Exits with 1 if there are any.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <protostar/integrators/shadow.hpp>
#include <protostar/protostar.hpp>

#include "scenes/blended_balls.hpp"
#include "scenes/field_shapes.hpp"
#include "scenes/folded_rows.hpp"
#include "scenes/marched_spheres.hpp"
#include "scenes/sponge.hpp"

using namespace protostar;

namespace {

/// Draws a scene, and prints its name and the number of its undecided rays, which it returns.
std::uint64_t undecided_in(const char* name, const AnyScene& scene) {
  Image image(640, 480);
  RenderStatistics statistics;
  render(image, Camera{}, scene, ShadowIntegrator{}, RenderOptions{.statistics = &statistics});
  std::printf("%-16s %" PRIu64 " undecided\n", name, statistics.undecided);
  return statistics.undecided;
}

}  // namespace

int main() try {
  const auto count = undecided_in("marched_spheres", marched_spheres()) +
                     undecided_in("field_shapes", field_shapes()) +
                     undecided_in("blended_balls", blended_balls()) +
                     undecided_in("folded_rows", folded_rows()) + undecided_in("sponge", sponge());
  return count == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception& error) {
  std::fprintf(stderr, "undecided_rays: %s\n", error.what());
  return EXIT_FAILURE;
}
