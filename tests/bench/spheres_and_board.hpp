// Spheres and a checker board with Phong's highlights, mirrors and glass, computed as in the article behind
// stage 13_whitted: values in a list, float, an offset, a ray for each share of light.
//
// It is written from the article's text and shares no code with the library.
#pragma once

#include "tutorial.hpp"

namespace tutorial {

/// Scene of the four spheres in front of their board, and three lights of the same brightness at any
/// distance.
struct SpheresAndBoard {
  /// True if a share of 0 takes no ray. The article casts both rays from every hit.
  bool skips_what_weighs_nothing = false;

  void render(Image& image) const;

 private:
  vec3 radiance(const Ray& ray, int depth) const;
};

}  // namespace tutorial
