// The plain ray tracer, step 01: a picture, and the file that holds it.
//
// g++ -O2 -std=c++20 01_gradient.cpp -o 01_gradient && ./01_gradient
//
// writes the picture to out.ppm. The page docs/stages/01_gradient.md explains the step.
#include <algorithm>
#include <fstream>
#include <vector>

// Three numbers: here the red, green and blue light of a color.
struct Vec {
  double x = 0, y = 0, z = 0;
};

using Color = Vec;

// A picture: the light of each pixel, row by row from the top, each row from the left.
struct Image {
  int width, height;
  std::vector<Color> pixels = std::vector<Color>(width * height);

  Color& at(int x, int y) { return pixels[y * width + x]; }
};

// Turns light, from 0 for black to 1 for white, into the nearest whole number from 0 to 255.
int code(double light) { return static_cast<int>(255 * std::clamp(light, 0.0, 1.0) + 0.5); }

// Saves the picture as a PPM file, which is a text: "P3", the size, the largest number, then all pixels.
void save(const Image& image) {
  std::ofstream file("out.ppm");
  file << "P3\n" << image.width << ' ' << image.height << "\n255\n";
  for (const Color& c : image.pixels) file << code(c.x) << ' ' << code(c.y) << ' ' << code(c.z) << '\n';
}

int main() {
  Image image{100, 100};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double light = static_cast<double>(x) / (image.width - 1);  // 0 on the left, 1 on the right
      image.at(x, y) = {light, light, light};
    }
  save(image);
}
