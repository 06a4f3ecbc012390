// Checks that a debug build reports an intersect that answers outside of its range, once and with the name of
// its type, and leaves it out. g++ compiles it without run-time type information, which its library does not
// need.
#include <cstdio>
#include <cstring>
#include <protostar/scene.hpp>

#ifdef NDEBUG
#error "This program is for a debug build, without NDEBUG"
#endif

using namespace protostar;

namespace {

/// A surface that is met at t = 5 in every range.
struct Everywhere {
  std::optional<double> intersect(const Ray&, Interval) const { return 5; }
  Vec3 normal_at(Point) const { return {0, 0, -1}; }
};

}  // namespace

int main() {
  const char* const name = "out_of_range.txt";
  if (std::freopen(name, "w", stderr) == nullptr) return 1;
  Scene<Everywhere> scene;
  scene.add(Everywhere{}, Color{1});
  const bool is_hit = scene.occluded(Ray{}, {0, 10});
  std::fflush(stderr);
  std::FILE* const file = std::fopen(name, "r");
  char text[2000] = "";
  if (file == nullptr || std::fread(text, 1, sizeof text - 1, file) != 0) return 2;  // t = 5 is in the range
  const bool is_left_out = !scene.occluded(Ray{}, {0, 1}) && !scene.occluded(Ray{}, {0, 2});
  std::fflush(stderr);
  std::rewind(file);
  const std::size_t length = std::fread(text, 1, sizeof text - 1, file);
  text[length] = '\0';
  std::fclose(file);
  const bool is_told = std::strstr(text, "Everywhere: intersect returned t = 5") != nullptr &&
                       std::strstr(text, "0 < t < 1 ") != nullptr;
  const bool is_told_once = std::strchr(text, '\n') == text + length - 1;
  return is_hit && is_left_out && is_told && is_told_once ? 0 : 3;
}
