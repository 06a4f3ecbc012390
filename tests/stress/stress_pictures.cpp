// Checks the tutorial's scene at other scales and positions: transparency and shadow are compared with exact
// arithmetic.
//
//   stress_pictures [--every N] [--csv FILE]
//
// Checks every Nth pixel (13th) of 640×480 for each scale and offset, and of 3840×2160 for some. The answers
// of the scene to the integrators are judged by exact arithmetic for the ray, and the shadow segment, as they
// are given in doubles. The resulting pixels are compared with the picture of tests/reference/, which shows
// the scene of the tutorial: a scale or an offset must change nothing. Exits with 1 if a single answer is
// wrong, or a pixel is off by more than one level of 255, encoded with gamma 2.2.

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <protostar/camera.hpp>
#include <protostar/encode.hpp>
#include <protostar/integrators/shadow.hpp>
#include <protostar/integrators/transparency.hpp>
#include <vector>

#include "csv.hpp"
#include "options.hpp"
#include "oracle/sorted_hits.hpp"
#include "reference/pictures.hpp"
#include "scenes/three_spheres.hpp"

using namespace protostar;

namespace {

struct Tally {
  std::uint64_t pixels = 0, crossings = 0, segments = 0;
  std::uint64_t wrong_answers = 0, off_by_one = 0, off_by_more = 0;

  void add(const Tally& other) {
    pixels += other.pixels, crossings += other.crossings, segments += other.segments;
    wrong_answers += other.wrong_answers, off_by_one += other.off_by_one, off_by_more += other.off_by_more;
  }
};

// ---- The scene

/// Map of a point p of the tutorial to scale · p + offset, on all three axes.
struct Placement {
  double scale, offset;

  [[nodiscard]] Point of(const Point& p) const { return scale * p + Vec3{offset}; }
};

/// Scene, its spheres in the order of the tutorial, and its camera.
struct Model {
  std::vector<Sphere> spheres;
  Scene<Sphere> scene;
  Camera camera;
};

/// Returns the model at a placement. The light's power grows with the square of the distances, so the picture
/// keeps its brightness.
Model placed(const Placement& placement) {
  Model model;
  for (const auto& [sphere, color] : the_three_spheres)
    model.spheres.push_back({placement.of(sphere.center), placement.scale * sphere.radius});
  // From back to front, so that the closest hit is not the sphere that is tested first.
  for (std::size_t i = model.spheres.size(); i-- > 0;)
    model.scene.add(model.spheres[i], the_three_spheres[i].color);
  const auto& [position, power] = light_of_the_three_spheres;
  model.scene.add(PointLight{.position = placement.of(position),
                             .power = power * static_cast<float>(placement.scale * placement.scale)});
  model.camera.position = placement.of(Camera{}.position);
  return model;
}

/// Returns the number of a hit's sphere, which is identified by its color.
int sphere_of(const Intersection& hit) {
  const auto found = std::find_if(the_three_spheres.begin(), the_three_spheres.end(),
                                  [&](const ColoredSphere& each) { return each.color == hit.color(); });
  return static_cast<int>(found - the_three_spheres.begin());
}

// ---- The answers

/// Scene for an integrator that traces one camera ray. It returns the answers of the scene, and judges each.
class Judge {
 public:
  Judge(const Model& model, const Ray& ray, Tally& tally)
      : model_(model), truth_(hits(ray, -1, infinity)), tally_(tally) {}

  [[nodiscard]] std::optional<Intersection> intersect(const Ray& ray, Interval range) const {
    const auto first = model_.scene.intersect(ray, range);
    expect(first.has_value() == !truth_.empty() && (!first || sphere_of(*first) == truth_.front().surface));
    return first;
  }

  void crossings(const Ray& ray, Interval range, const auto& visit) const {
    std::vector<Intersection> found;
    model_.scene.crossings(ray, range, [&](const Intersection& crossing) {
      found.push_back(crossing);
      visit(crossing);
    });
    tally_.crossings += found.size();
    std::stable_sort(found.begin(), found.end());
    expect(std::equal(found.begin(), found.end(), truth_.begin(), truth_.end(),
                      [](const Intersection& a, const exact::Hit& b) { return sphere_of(a) == b.surface; }));
  }

  /// Returns whether the segment from the camera ray's closest hit to the light is occluded.
  [[nodiscard]] bool occluded(const Ray& segment, Interval range) const {
    ++tally_.segments;
    const bool answer = model_.scene.occluded(segment, range);
    expect(!truth_.empty() && answer == !hits(segment, truth_.front().surface, range.max).empty());
    return answer;
  }

  [[nodiscard]] const std::vector<Light>& lights() const { return model_.scene.lights(); }

 private:
  /// Returns the crossings of a ray with 0 < t < end, in order of t; the ray leaves sphere left, if that is
  /// not -1.
  [[nodiscard]] std::vector<exact::Hit> hits(const Ray& ray, int left, double end) const {
    std::vector<exact::Hit> result;
    for (int i = 0; i < static_cast<int>(model_.spheres.size()); ++i)
      add_hits(result, ray, model_.spheres[static_cast<std::size_t>(i)], i, i == left, end);
    sort(result);
    return result;
  }

  void expect(bool right) const {
    if (!right) ++tally_.wrong_answers;
  }

  const Model& model_;
  std::vector<exact::Hit> truth_;  ///< true hits of the camera ray
  Tally& tally_;
};
static_assert(Traceable<Judge>);

// ---- The pixels

using Codes = std::array<std::uint8_t, 3>;

int distance(const Codes& a, const Codes& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

Codes codes(const Color& light) {
  static const Encoder encode(Gamma{2.2}, 255);
  const auto code = [](float x) { return static_cast<std::uint8_t>(encode(x)); };
  return {code(light.r), code(light.g), code(light.b)};
}

Codes codes(const reference::Vector& light) {
  const auto code = [](reference::Real x) { return reference::encode(x, 2.2L); };
  return {code(light.x), code(light.y), code(light.z)};
}

/// Pixel of both pictures according to the reference.
struct Pixel {
  int x, y;
  Codes transparency, shadow;
};

std::vector<Pixel> every(std::uint64_t step, int width, int height) {
  std::vector<Pixel> pixels;
  const std::uint64_t w = static_cast<std::uint64_t>(width), count = w * static_cast<std::uint64_t>(height);
  for (std::uint64_t i = 0; i < count; i += step) {
    const int x = static_cast<int>(i % w), y = static_cast<int>(i / w);
    const reference::Whole ray = reference::through_pixel(x, y, width, height);
    pixels.push_back({x, y, codes(reference::transparency(ray)), codes(reference::shadow(ray))});
  }
  return pixels;
}

Tally judge(const Placement& placement, const std::vector<Pixel>& pixels, int width, int height) {
  const Model model = placed(placement);
  Tally tally;
  for (const Pixel& pixel : pixels) {
    const Ray ray = model.camera.through_pixel(pixel.x, pixel.y, width, height);
    const Judge scene(model, ray, tally);
    const std::uint64_t wrong_before = tally.wrong_answers;
    const int off =
        std::max(distance(codes(TransparencyIntegrator{}.radiance(ray, scene)), pixel.transparency),
                 distance(codes(ShadowIntegrator{}.radiance(ray, scene)), pixel.shadow));
    ++tally.pixels;
    if (tally.wrong_answers > wrong_before)
      std::fprintf(stderr, "scale %g, offset %g, %dx%d: pixel (%d, %d) has wrong answers\n", placement.scale,
                   placement.offset, width, height, pixel.x, pixel.y);
    if (off == 1) ++tally.off_by_one;
    if (off > 1) {
      ++tally.off_by_more;
      std::fprintf(stderr, "scale %g, offset %g, %dx%d: pixel (%d, %d) is off by %d levels\n",
                   placement.scale, placement.offset, width, height, pixel.x, pixel.y, off);
    }
  }
  return tally;
}

void print(const Tally& tally) {
  std::printf("%10" PRIu64 "%11" PRIu64 "%10" PRIu64 "%15" PRIu64 "%12" PRIu64 "%9" PRIu64 "\n", tally.pixels,
              tally.crossings, tally.segments, tally.wrong_answers, tally.off_by_one, tally.off_by_more);
  std::fflush(stdout);
}

int stress(int argc, char** argv) {
  const Options options(argc, argv, {"--every", "--csv"});
  const std::uint64_t step = std::max<std::uint64_t>(options.number("--every", 13), 1);
  Tally all;
  CsvFile csv(options.text("--csv"),
              "scale,offset,size,pixels,crossings,segments,wrong answers,off by one,by more");
  const auto write = [&](const auto& scale, const auto& offset, const std::string& size, const Tally& tally) {
    csv.row(scale, offset, size, tally.pixels, tally.crossings, tally.segments, tally.wrong_answers,
            tally.off_by_one, tally.off_by_more);
  };
  const auto report = [&](const Placement& placement, const std::vector<Pixel>& pixels, int width,
                          int height) {
    const Tally tally = judge(placement, pixels, width, height);
    std::printf("%-9g%-8g%4dx%-4d", placement.scale, placement.offset, width, height);
    print(tally);
    write(placement.scale, placement.offset, std::to_string(width) + "x" + std::to_string(height), tally);
    all.add(tally);
  };

  std::printf("%-9s%-8s%-9s%10s%11s%10s%15s%12s%9s\n", "scale", "offset", "size", "pixels", "crossings",
              "segments", "wrong answers", "off by one", "by more");
  const std::vector<Pixel> small = every(step, 640, 480);
  for (const double scale : {1.0, 1e-3, 1.0 / 32, 7.0, 1e3, 1e6})
    for (const double offset : {0.0, 100.0, 1e3, 65537.0}) report({scale, offset}, small, 640, 480);
  const std::vector<Pixel> large = every(step, 3840, 2160);
  for (const Placement& placement : {Placement{1, 0}, Placement{1e-3, 65537}})
    report(placement, large, 3840, 2160);
  std::printf("%-26s", "all");
  print(all);
  write("all", "", "", all);
  return all.wrong_answers > 0 || all.off_by_more > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return stress(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stress_pictures: %s\n", error.what());
    return 2;
  }
}
