// Algorithms to intersect a ray and a sphere: time, and errors of their answers.
#include <optional>
#include <protostar/camera.hpp>

#include "bench_error.hpp"
#include "stress/corpora/corpus.hpp"
#include "stress/corpora/spheres.hpp"
#include "stress/exact.hpp"
#include "stress/oracle/surface_roots.hpp"
#include "stress/usual.hpp"
#include "workload.hpp"

using namespace protostar;
using bench::number, bench::Table, bench::Times, bench::Work;
using exact::Quad;

namespace {

// ---- Kernels: errors

struct Errors {
  double tests = 0, wrong = 0;
  std::vector<double> t;  // in ulp of float, for the hits that are right

  [[nodiscard]] double wrong_per_million() const { return 1e6 * wrong / tests; }
  [[nodiscard]] double quantile(double share) const {
    std::vector<double> sorted = t;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(share * static_cast<double>(t.size() - 1))];
  }
};

/// Returns |t − truth| in units of the last place that a float has there.
double float_ulps(double t, Quad truth) {
  int exponent = 0;
  std::frexp(static_cast<double>(truth), &exponent);
  const Quad error = Quad(t) - truth;
  return std::ldexp(static_cast<double>(error < 0 ? -error : error), 24 - exponent);
}

/// Adds an answer, the first t > 0 or infinity. A root is wrong if it is closer to the other one, unless both
/// are so close to each other that float hardly tells them apart.
void judge(Errors& errors, const exact::Roots& roots, double t) {
  const auto size = [](Quad x) { return x < 0 ? -x : x; };
  const auto first =
      std::find_if(roots.begin(), roots.end(), [](const exact::Root& root) { return root.t > 0; });
  ++errors.tests;
  const bool hits = t < infinity;
  if (hits != (first != roots.end())) {
    ++errors.wrong;
  } else if (hits) {
    const bool other = std::any_of(roots.begin(), roots.end(), [&](const exact::Root& root) {
      return size(root.t - first->t) > Quad(0x1p-20) * size(first->t) &&
             size(Quad(t) - root.t) < size(Quad(t) - first->t);
    });
    if (other)
      ++errors.wrong;
    else
      errors.t.push_back(float_ulps(t, first->t));
  }
}

/// Returns the nearest float. Goes through a volatile, since g++ 12 at -O2 drops the rounding of pairs of
/// doubles that are converted to float and back.
double rounded(double x) {
  const volatile float nearest = static_cast<float>(x);
  return nearest;
}
Vec3 rounded(const Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

template <class T>
usual::Ray<T> in(const Ray& ray) {
  return {usual::Vector<T>(ray.origin), usual::Vector<T>(ray.direction)};
}
template <class T>
usual::Sphere<T> in(const Sphere& sphere) {
  return {usual::Vector<T>(sphere.center), static_cast<T>(sphere.radius)};
}

// ---- Kernels: time

/// Runs the closest-hit loop of a kernel over a scene for every ray. Returns the number of hits, so that no
/// work is optimized away.
template <class T, auto kernel>
int closest_hits(const std::vector<usual::Ray<T>>& rays, const std::vector<usual::Sphere<T>>& spheres) {
  int hits = 0;
  for (const usual::Ray<T>& ray : rays) {
    T nearest = usual::miss<T>;
    const usual::Sphere<T>* seen = nullptr;
    for (const usual::Sphere<T>& sphere : spheres)
      if (const T t = kernel(ray, sphere); t < nearest) {
        nearest = t;
        seen = &sphere;
      }
    bench::keep(nearest);
    if (seen) ++hits;
  }
  return hits;
}

/// Rays and spheres in float, in double and as a scene. The rays are so few that they stay in the cache, and
/// are followed several times.
struct Loop {
  int repetitions;
  std::vector<Ray> rays;
  Scene<Sphere> scene;
  std::vector<usual::Ray<double>> double_rays;
  std::vector<usual::Sphere<double>> double_spheres;
  std::vector<usual::Ray<float>> float_rays;
  std::vector<usual::Sphere<float>> float_spheres;

  Loop(const bench::Workload& work, int width, int height, int times) : repetitions(times) {
    for (const bench::FloatSphere& s : work.spheres) {
      const Sphere sphere{Point(s.center), s.radius};
      scene.add(sphere, Color{1});
      double_spheres.push_back(in<double>(sphere));
      float_spheres.push_back(in<float>(sphere));
    }
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        rays.push_back(work.camera.through_pixel(x, y, width, height));
        double_rays.push_back(in<double>(rays.back()));
        float_rays.push_back(in<float>(rays.back()));
      }
  }
  [[nodiscard]] double tests() const {
    return static_cast<double>(repetitions) * static_cast<double>(rays.size()) *
           static_cast<double>(float_spheres.size());
  }
};

/// Runs the library's own loop, which decides the order exactly as well, and returns an Intersection.
int closest_hits_of_scene(const Loop& loop) {
  int hits = 0;
  for (const Ray& ray : loop.rays) {
    const auto hit = loop.scene.intersect(ray);
    bench::keep(hit);
    if (hit) ++hits;
  }
  return hits;
}

/// Returns the library's root, for the same loop as the other kernels.
double certified(const usual::Ray<double>& ray, const usual::Sphere<double>& sphere) {
  return certified_roots(Sphere{sphere.center, sphere.radius}, Ray{ray.origin, ray.direction})
      .first_in(Interval{})
      .value_or(infinity);
}

struct Kernel {
  const char* name;
  double (*first)(const Ray&, const Sphere&);  // t > 0, infinity for a miss
  int (*closest)(const Loop&);
};
template <auto kernel>
Kernel float_kernel(const char* name) {
  return {name,
          [](const Ray& ray, const Sphere& sphere) {
            return static_cast<double>(kernel(in<float>(ray), in<float>(sphere)));
          },
          [](const Loop& loop) { return closest_hits<float, kernel>(loop.float_rays, loop.float_spheres); }};
}
template <auto kernel>
Kernel double_kernel(const char* name) {
  return {
      name, [](const Ray& ray, const Sphere& sphere) { return kernel(in<double>(ray), in<double>(sphere)); },
      [](const Loop& loop) { return closest_hits<double, kernel>(loop.double_rays, loop.double_spheres); }};
}
const std::vector<Kernel> kernels{
    float_kernel<usual::quadratic<float>>("float, tutorial"),
    float_kernel<usual::geometric>("geometric"),
    float_kernel<usual::gems>("RT Gems 7"),
    double_kernel<usual::quadratic<double>>("double"),
    double_kernel<certified>("certified roots"),
    Kernel{"Scene::intersect",
           [](const Ray& ray, const Sphere& sphere) { return sphere.intersect(ray).value_or(infinity); },
           closest_hits_of_scene}};

// ---- Kernels: the table

std::vector<Errors> errors_on(const std::vector<Case<Sphere> (*)(Random&)>& corpora, int each) {
  std::vector<Errors> errors(kernels.size());
  Random random(1);
  for (const auto next : corpora)
    for (int i = 0; i < each;) {
      Case<Sphere> c = next(random);
      c.ray = {rounded(c.ray.origin), rounded(c.ray.direction)};
      c.surface = {rounded(c.surface.center), rounded(c.surface.radius)};
      const exact::Roots roots = exact::roots(c.ray, c.surface, false);
      for (std::size_t k = 0; k < kernels.size(); ++k)
        judge(errors[k], roots, kernels[k].first(c.ray, c.surface));
      ++i;
    }
  return errors;
}

Times times_of(const bench::Options& options, const Loop& loop) {
  std::vector<Work> works;
  for (const Kernel& kernel : kernels)
    works.emplace_back([&loop, closest = kernel.closest] {
      for (int i = 0; i < loop.repetitions; ++i) bench::keep(closest(loop));
    });
  return {options, works};
}

}  // namespace

void errors_of_kernels(const bench::Options& options) {
  bench::Workload sparse = bench::workload(100);
  for (bench::FloatSphere& sphere : sparse.spheres) sphere.radius *= 0.2f;
  const Loop few(sparse, 64, 48, options.quick ? 1 : 6);
  const Loop half(bench::workload(3), 64, 48, options.quick ? 1 : 100);
  const auto share = [](const Loop& loop) {
    return number(100.0 * closest_hits_of_scene(loop) / static_cast<double>(loop.rays.size())) + " %";
  };
  std::printf("few: 100 spheres, met by %s of the rays; half: 3 spheres, met by %s\n", share(few).c_str(),
              share(half).c_str());
  const Times few_times = times_of(options, few), half_times = times_of(options, half);

  // Cases of the tutorial's scene; and lines that are nearly tangent, start far away, or on the sphere or
  // next to it.
  const int tests = options.quick ? 100 : 200'000;
  const std::vector<Errors> usual = errors_on({corpora::tutorial}, tests);
  const std::vector<Errors> hard = errors_on({corpora::grazing, corpora::far_away, corpora::origins}, tests);

  const auto measure = [&](std::size_t k) {
    return bench::Measure{1e9 * half_times.seconds(k) / half.tests(),
                          1e6 * (usual[k].wrong + hard[k].wrong) / (usual[k].tests + hard[k].tests)};
  };
  std::vector<bench::Measure> all;
  for (std::size_t k = 0; k < kernels.size(); ++k) all.push_back(measure(k));

  Table table(options,
              {"kernel", "few: ns/test", "to float", "half: ns/test", "to float", "tutorial: wrong/M",
               "t p99.9", "t max", "hard: wrong/M", "t p99.9", "t max", "front"});
  for (std::size_t k = 0; k < kernels.size(); ++k)
    table.row({kernels[k].name, number(1e9 * few_times.seconds(k) / few.tests()),
               number(few_times.ratio(k, 0)), number(all[k].time), number(half_times.ratio(k, 0)),
               number(usual[k].wrong_per_million()), number(usual[k].quantile(0.999), 2),
               number(usual[k].quantile(1), 2), number(hard[k].wrong_per_million()),
               number(hard[k].quantile(0.999), 2), number(hard[k].quantile(1), 2),
               bench::is_on_front(all[k], all) ? "yes" : ""});
}
