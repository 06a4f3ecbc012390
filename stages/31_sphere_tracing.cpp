// Draws the three spheres by steps as long as the way is free (§3.2), and counts wrong pixels.
#include "naive_march.hpp"

int main(int argc, char** argv) {
  const StageDefaults defaults{
      .integrator = "sphere tracing",
      .numbers = {{.name = "--epsilon",
                   .help = "Distance from a surface at which a ray ends, in scene units",
                   .value = 1e-3,
                   .positive = true}}};

  return run_stage(argc, argv, defaults, [](Stage& stage) {
    naive_march::draw(stage, [](const auto& ray, double epsilon, const auto& tell) {
      return naive_march::sphere_tracing(ray, epsilon, tell);
    });
  });
}
