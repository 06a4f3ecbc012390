// Draws a horizontal gradient, from black to white (§2.2.2, Fig. 1).
#include <algorithm>
#include <protostar/image.hpp>

#include "support/stage.hpp"

using namespace protostar;

int main(int argc, char** argv) {
  const StageDefaults defaults{.integrator = "gradient",
                               .width = 100,
                               .height = 100,
                               .transfer = Linear{},
                               .plain = true,
                               .fills_whole = true};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    Image image = stage.image();
    const float last = static_cast<float>(std::max(image.width() - 1, 1));
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) image(x, y) = Color{static_cast<float>(x) / last};
    stage.save(image);
  });
}
