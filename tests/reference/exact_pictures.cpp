// Compares goldens with pictures that exact arithmetic draws, without the library.
//
//   exact_pictures
//
// It prints a line for each golden, and ends with 1 if one is further off than rounding explains.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <future>
#include <string>
#include <vector>

#include "../compare_images/picture.hpp"
#include "../compare_images/read_image.hpp"
#include "carved_solids.hpp"
#include "endless_floor.hpp"
#include "mesh.hpp"
#include "pictures.hpp"
#include "primitives.hpp"
#include "soft_shadows.hpp"
#include "whitted.hpp"

namespace {

using namespace reference;

const std::string source_dir = PROTOSTAR_SOURCE_DIR;

/// A golden and its reference picture. Naive stages have none: they are wrong on purpose. Nor have stages
/// whose rays take numbers of a sampler besides places: the closed forms of tests/lens.cpp and
/// tests/moving.cpp judge these. Fields of 34 to 38 have no equation: tests/marched.cpp judges hits on them,
/// and the plain ray tracers, with a march of their own, draw the same pictures (tests/plain/check).
struct Golden {
  std::string name;
  Picture (*exact)();
  int undecided = 0;  ///< number of pixels that may be more than a level off the reference, inexact there
};

template <Vector (*light_along)(Whole)>
Picture of_scene() {
  return picture(640, 480, light_along);
}

/// Number of pixels that look exactly at the lines x = ±4 between squares of the board: rounding decides
/// between these.
constexpr int lines_between_squares = 20;

const Golden goldens[] = {
    {"01_gradient", [] { return gradient(100, 100); }},
    {"02_sphere", of_scene<sphere_alone>},
    {"03_scene", of_scene<binary>},
    {"04_depth", of_scene<depth>},
    {"05_normal", of_scene<normals>},
    {"06_color", of_scene<flat_color>},
    {"07_diffuse", of_scene<diffuse>},
    {"07_diffuse_linear", [] { return picture(640, 480, diffuse, 1); }},
    {"08_transparency", of_scene<transparency>},
    {"09_shadow", of_scene<shadow>},
    {"10_phong",
     [] {
       return picture({{dull_ivory, rubber, rubber, dull_ivory}});
     }},
    {"11_mirror",
     [] {
       return picture({{ivory, mirror, rubber, mirror}, true});
     },
     lines_between_squares},
    {"12_glass",
     [] {
       return picture({{ivory, glass, rubber, glass}, true});
     },
     lines_between_squares},
    {"13_whitted",
     [] {
       return picture({{ivory, glass, rubber, mirror}, true});
     },
     lines_between_squares},
    {"14_primitives", of_scene<primitives_along>},
    {"15_csg", of_scene<carved_solids_along>},
    {"16_environment",
     [] {
       return picture({{ivory, glass, rubber, mirror}, true, true});
     },
     lines_between_squares},
    {"17_mesh", [] { return Knot(source_dir + "/scenes/knot.obj").picture(640, 480); }},
    {"18_antialiasing", [] { return endless_floor(4); }},
    {"18_antialiasing_1", [] { return endless_floor(0); }},
    {"19_soft_shadows", [] { return soft_shadows(16); }},
    {"19_soft_shadows_1", [] { return soft_shadows(1); }},
    {"27_normal_map",
     [] {
       return picture({{bumpy_ivory, ribbed_rubber, ribbed_rubber, bumpy_ivory}});
     }},
    {"33_certified", of_scene<diffuse>},
};

/// Returns the number of pixels that differ by more than one level in a channel.
int pixels_beyond_a_level(const Picture& a, const Picture& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    if (difference({1, 1, {a.pixels[i]}}, {1, 1, {b.pixels[i]}}).largest > 1) ++count;
  return count;
}

/// Prints how far a golden is off its reference; returns whether rounding explains it. A single level may
/// come from rounding light to float, which moves it by 2^-24 of itself and its code, at most 255, by 255/2.2
/// · 2^-24 = 7e-6 of a level: a few of the 921,600 codes of a picture cross the middle between two levels.
bool agrees(const Golden& golden, const Picture& exact) {
  const Picture stored = read_image(source_dir + "/tests/golden/" + golden.name + ".png");
  if (!same_size(stored, exact)) {
    std::printf("%s: the golden is %d x %d, not %d x %d\n", golden.name.c_str(), stored.width, stored.height,
                exact.width, exact.height);
    return false;
  }
  const Difference found = difference(stored, exact);
  std::printf("%s: %d pixels differ from exact arithmetic, by at most %d levels\n", golden.name.c_str(),
              found.pixels, found.largest);
  return pixels_beyond_a_level(stored, exact) <= golden.undecided && found.pixels < 10 + golden.undecided;
}

}  // namespace

int main() try {
  // References take seconds; the cores share them.
  std::vector<std::future<Picture>> references;
  for (const Golden& golden : goldens) references.push_back(std::async(std::launch::async, golden.exact));
  bool all_agree = true;
  for (std::size_t i = 0; i < references.size(); ++i)
    if (!agrees(goldens[i], references[i].get())) {
      std::printf("FAILED: %s\n", goldens[i].name.c_str());
      all_agree = false;
    }
  return all_agree ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "exact_pictures: %s\n", error.what());
  return 1;
}
