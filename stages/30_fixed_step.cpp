// Draws the three spheres by steps of one length along each ray (§3.2), and counts wrong pixels.
#include "naive_march.hpp"

int main(int argc, char** argv) {
  const StageDefaults defaults{.integrator = "fixed step",
                               .numbers = {{.name = "--epsilon",
                                            .help = "Length of a step, in scene units",
                                            .value = 0.25,
                                            .positive = true}}};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    naive_march::draw(stage, [](const auto& ray, double epsilon, const auto& tell) {
      return naive_march::fixed_step(ray, epsilon, tell);
    });
  });
}
