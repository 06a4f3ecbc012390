// Stage 09_shadow in the tutorial's way, as a program of its own: tutorial_shadow FILE
#include "tutorial.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  tutorial::Image image(640, 480);
  tutorial::ShadowIntegrator{}.render(image, tutorial::Camera{}, tutorial::three_spheres());
  image.correct_gamma();
  image.save_ppm(argv[1]);
}
