// Solution: the number of wrong pixels of 08_naive, for several offsets and for two sizes of the picture.
//
// g++ -O2 -std=c++20 -I../../include -I../.. 08_offsets.cpp -o 08_offsets -pthread && ./08_offsets
#include <cstdio>
#include <cstdlib>
#include <protostar/protostar.hpp>

#include "stages/naive.hpp"
using namespace protostar;

// Returns how many pixels of a picture are more than a level of 255 off the exact ones.
int wrong_pixels(const Image& image, const Image& exact) {
  const Encoder encode(Gamma{2.2}, 255);
  int count = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      bool is_wrong = false;
      for (int c = 0; c < 3; ++c) is_wrong |= std::abs(encode(image(x, y)[c]) - encode(exact(x, y)[c])) > 1;
      count += is_wrong;
    }
  return count;
}

int main() {
  for (const int height : {480, 960}) {
    Image exact(height / 3 * 4, height), image = exact;
    render(exact, Camera{}, three_spheres(), TransparencyIntegrator{});
    std::printf("%dx%d\n", exact.width(), exact.height());
    for (const float offset : {1e-5f, 1e-4f, 1e-3f, 1e-2f, 1e-1f}) {
      render(image, Camera{}, [&](const Ray& ray) { return naive::transparency(naive::Ray(ray), offset); });
      std::printf("  offset %g: %d wrong\n", offset, wrong_pixels(image, exact));
    }
  }
}
