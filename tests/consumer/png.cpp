// Saves a PNG with protostar::png.
#include <protostar/io/png.hpp>
using namespace protostar;
int main() {
  Image image(4, 3);
  image(1, 2) = Color{1};
  save_png(image, "out.png");
}
