// Decisions of rays in whole numbers, in which no rounding has a part: the same, even where a compiler fuses
// multiplications with additions. (A picture is not, in its last bits, as the camera's rays are not.)
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

/// Small whole numbers, so that surfaces touch, coincide and are touched by rays again and again, all
/// exactly.
class Grid {
 public:
  explicit Grid(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t below(std::uint64_t n) { return engine_() % n; }
  double whole(int size) {
    return static_cast<double>(below(static_cast<std::uint64_t>(2 * size + 1))) - size;
  }
  Vec3 vector(int size) { return {whole(size), whole(size), whole(size)}; }
  Vec3 direction(int size) {
    for (;;)
      if (const Vec3 v = vector(size); v != Vec3{0}) return v;
  }

 private:
  std::mt19937_64 engine_;
};

/// Scenes of a few surfaces, and what rays decide in them: what is first, whether anything is in the way,
/// which surfaces are crossed and in which order. A surface's color is its number. Scaled by powers of two,
/// and moved by as much as stays exact, the decisions must not change, as they are all written.
void save_decisions(const std::string& path) {
  std::ofstream file(path);
  Grid grid(1);
  for (int round = 0; round < 400; ++round) {
    const double scale = std::ldexp(1, 40 * (round % 3) - 40), shift = round % 2 == 0 ? 0 : 1 << 20;
    const auto place = [&](const Vec3& v) { return scale * (v + Vec3{shift}); };
    Scene<Sphere, Plane> scene;
    std::vector<Departure> departures{{}};
    for (int i = 0; i < 6; ++i) {
      const Color number{static_cast<float>(i)};
      if (i < 4) {
        const Sphere sphere{.center = place(grid.vector(3)),
                            .radius = scale * (1 + static_cast<double>(grid.below(3)))};
        scene.add(sphere, number);
        departures.push_back(sphere.departure());
      } else {
        const Vec3 normal = grid.direction(2);
        const Plane plane{.normal = normal,
                          .distance = scale * grid.whole(4) + dot(normal, Vec3{scale * shift})};
        scene.add(plane, number);
        departures.push_back(plane.departure());
      }
    }
    for (int i = 0; i < 100; ++i) {
      const Ray ray{place(grid.vector(5)), scale * grid.direction(4),
                    departures[grid.below(departures.size())]};
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
