// Writes decisions about rays, which are the same even if a compiler fuses multiplications with additions.
// (The last bits of a picture are not, as those of the camera's rays are not.)
//
//   decisions FILE

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <protostar/scene.hpp>
#include <protostar/surfaces/plane.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

using namespace protostar;

namespace {

/// Random small whole numbers, so that surfaces often touch and coincide, and rays are often tangent; some
/// are off by very little. Each double is rounded at most once here, which no compiler changes.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t below(std::uint64_t n) { return engine_() % n; }
  double whole(int size) {
    return static_cast<double>(below(static_cast<std::uint64_t>(2 * size + 1))) - size;
  }
  double near_whole(int size) {
    const double number = whole(size),
                 noise = static_cast<double>(static_cast<std::int64_t>(engine_()) >> 11);
    return below(3) == 0 ? number + std::ldexp(noise, -60 - static_cast<int>(below(40))) : number;
  }
  Vec3 vector(int size) { return {near_whole(size), near_whole(size), near_whole(size)}; }
  Vec3 direction(int size) {
    for (;;)
      if (const Vec3 v = vector(size); v != Vec3{0}) return v;
  }

 private:
  std::mt19937_64 engine_;
};

/// Writes decisions about rays among a few surfaces, of three sizes, at the origin and far away from it: the
/// closest hit, any hit in 0 < t < 1, and the order of all crossings. A surface's color is its number.
void save_decisions(const std::string& path) {
  std::ofstream file(path);
  Numbers numbers(1);
  for (int round = 0; round < 400; ++round) {
    const double scale = std::ldexp(1, 40 * (round % 3) - 40), shift = round % 2 == 0 ? 0 : 1 << 20;
    const auto place = [&](const Vec3& v) { return scale * (v + Vec3{shift}); };
    Scene<Sphere, Plane> scene;
    std::vector<Departure> departures{{}};
    for (int i = 0; i < 6; ++i) {
      const Color number{static_cast<float>(i)};
      if (i < 4) {
        const Sphere sphere{.center = place(numbers.vector(3)),
                            .radius = scale * (4 + numbers.near_whole(3))};
        scene.add(sphere, number);
        departures.push_back(sphere.departure());
      } else {
        const Vec3 normal = numbers.direction(2);
        const double sum = normal.x + normal.y + normal.z;  // the shift is along (1, 1, 1)
        const Plane plane{.normal = normal, .distance = scale * (sum * shift + numbers.whole(4))};
        scene.add(plane, number);
        departures.push_back(plane.departure());
      }
    }
    for (int i = 0; i < 100; ++i) {
      const Ray ray{place(numbers.vector(5)), scale * numbers.direction(4),
                    departures[numbers.below(departures.size())]};
      const auto first = scene.intersect(ray, Interval{});
      std::vector<Intersection> crossings;
      scene.crossings(ray, Interval{-infinity, infinity},
                      [&](const Intersection& crossing) { crossings.push_back(crossing); });
      std::stable_sort(crossings.begin(), crossings.end());
      file << (first ? static_cast<int>(first->color().r) : -1)
           << (scene.occluded(ray, Interval{0, 1}) ? " shadow" : " light");
      for (const Intersection& crossing : crossings) file << ' ' << crossing.color().r;
      file << '\n';
    }
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  save_decisions(argv[1]);
}
