// Measures many spheres against Embree: camera rays, rays of every direction, occlusion, shadows; building,
// memory.
//
//   bench_spheres [--threads N] [--runs N] [--csv FILE] [--quick]
//
// Rates are millions of rays a second. Both get the same rays, which are made of floats; only "render" makes
// its own, in double. Embree is judged by the best of its three modes. Its answers are in float, so a few
// differ from ours, which are exact.
#include <malloc.h>

#include <optional>
#include <protostar/accel/render_tiles.hpp>
#include <protostar/image.hpp>
#include <protostar/integrators/diffuse.hpp>
#include <protostar/integrators/shadow.hpp>

#include "embree.hpp"
#include "support.hpp"

using namespace protostar;
using bench::Embree, bench::FloatRay, bench::Index, bench::Mode, bench::number, bench::pixels_by_tile,
    bench::Table, bench::Times, bench::Work;

namespace {

/// Shows as red which sphere is visible, by the address of its material: like Embree's answer, it does not
/// read the material.
struct IndexIntegrator {
  using TakesPackets = IndexIntegrator;

  const Material* first;

  [[nodiscard]] Color radiance(const Ray& ray, const Traceable auto& scene) const {
    const auto hit = scene.intersect(ray, Interval{});
    return hit ? shade(*hit, scene) : background(ray, scene);
  }
  template <class R>
  [[nodiscard]] typename R::Light background(const R&, const auto&) const {
    return typename R::Light(Color{0});
  }
  template <class Hit>
  [[nodiscard]] typename Hit::Light shade(const Hit& hit, const auto&) const {
    return typename Hit::Light(Color{static_cast<float>(&hit.material() - first), 1, 1});  // exact up to 2^24
  }
};

constexpr double too_long = 10;  // seconds a run, beyond which a work is left out

struct Answers {
  std::vector<Index> embree, ours;
};

Ray in_double(const FloatRay& ray) { return {Point(ray.origin), Vec3(ray.direction)}; }

/// Comparison of both on one scene.
template <Traceable S>
class Contest {
 public:
  Contest(Table& table, const bench::Options& options, const bench::Workload& work,
          const Scene<Sphere>& plain, const S& scene)
      : table_(table),
        options_(options),
        work_(work),
        plain_(plain),
        scene_(scene),
        embree_(work.spheres, options.threads),
        image_(options.quick ? 64 : 1024, options.quick ? 64 : 1024) {}

  void run() {
    const std::vector<FloatRay> camera_rays = primary();
    const IndexIntegrator index{plain_.materials<Sphere>().data()};
    row(
        "primary, render", camera_rays, &Embree::closest, true, image_seconds(index), [&] { draw(index); },
        [&](std::vector<Index>& seen) { read_image(seen, [](Color c) { return static_cast<Index>(c.r); }); });
    row_of_single("primary, single", camera_rays, true);
    row_of_single("incoherent", incoherent(), false);
    shadow_rows();
  }

 private:
  using Query = void (Embree::*)(Mode, bool, const std::vector<FloatRay>&, std::size_t, std::size_t,
                                 std::vector<Index>&) const;

  // ---- Rays

  std::vector<FloatRay> primary() const {
    std::vector<FloatRay> rays;
    for (const auto& [x, y] : pixels_by_tile(image_.width())) {
      const Ray ray = work_.camera.through_pixel(x, y, image_.width(), image_.height());
      rays.push_back({glm::vec3(ray.origin), glm::vec3(ray.direction)});
    }
    return rays;
  }

  std::vector<FloatRay> incoherent() const {
    Random random(1);
    std::vector<FloatRay> rays(static_cast<std::size_t>(image_.width() * image_.height()));
    for (FloatRay& ray : rays) {
      ray.origin = work_.corner + glm::vec3(random.point(0.5) + 0.5) * work_.size;
      ray.direction = glm::vec3(random.direction());
    }
    return rays;
  }

  /// Returns rays to the light from every visible point that faces it; in float they need an offset. The
  /// pixels of the rays are added to where.
  std::vector<FloatRay> to_light(std::vector<std::pair<int, int>>& where) const {
    const float offset = 1e-5f * (work_.spheres.size() == 3 ? 100.0f : 1.0f);
    std::vector<FloatRay> rays;
    for (const auto& [x, y] : pixels_by_tile(image_.width())) {
      const auto hit =
          scene_.intersect(work_.camera.through_pixel(x, y, image_.width(), image_.height()), Interval{});
      if (!hit) continue;
      const Vec3 normal = hit->facing_normal(), to = work_.light.position - hit->point();
      if (!(dot(normal, to) > 0)) continue;
      const float distance = static_cast<float>(length(to));
      rays.push_back({glm::vec3(hit->point() + static_cast<double>(offset) * normal),
                      glm::vec3(normalize(to)), distance - offset});
      where.emplace_back(x, y);
    }
    return rays;
  }

  // ---- The library

  void draw(const auto& integrator) {
    render(image_, work_.camera, scene_, integrator, RenderOptions{.threads = options_.threads});
  }

  /// Returns the approximate time of a picture, from the tiles that are done after half a second.
  double image_seconds(const auto& integrator) {
    std::stop_source enough;
    double seconds = 0, share = 0;
    const auto start = std::chrono::steady_clock::now();
    const auto look = [&](double done) {
      seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      share = done;
      if (seconds > 0.5) enough.request_stop();
    };
    render(image_, work_.camera, scene_, integrator,
           {.threads = options_.threads, .stop = enough.get_token(), .progress = look});
    return seconds / share;
  }

  void read_image(std::vector<Index>& seen, const auto& index_of) const {
    seen.clear();
    for (const auto& [x, y] : pixels_by_tile(image_.width()))
      seen.push_back(image_(x, y) == Color{0} ? bench::nothing : index_of(image_(x, y)));
  }

  void closest(const std::vector<FloatRay>& rays, std::size_t begin, std::size_t end,
               std::vector<Index>& hits) const {
    for (std::size_t i = begin; i < end; ++i) {
      const auto hit = scene_.intersect(in_double(rays[i]), Interval{});
      hits[i] = hit ? index_of(*hit) : bench::nothing;
    }
  }

  /// Returns the index of the sphere that is hit.
  Index index_of(const Intersection& hit) const {
    return static_cast<Index>(&hit.material() - plain_.materials<Sphere>().data());
  }

  void any(const std::vector<FloatRay>& rays, std::size_t begin, std::size_t end,
           std::vector<Index>& hits) const {
    for (std::size_t i = begin; i < end; ++i)
      hits[i] = scene_.occluded(in_double(rays[i]), Interval{0, static_cast<double>(rays[i].max)})
                    ? 0
                    : bench::nothing;
  }

  // ---- Rows

  void row_of_single(const std::string& name, const std::vector<FloatRay>& rays, bool coherent) {
    compare_single(name, rays, coherent, &Embree::closest,
                   [this](auto&&... arguments) { closest(arguments...); });
  }

  /// Compares rays that both are given one by one.
  void compare_single(const std::string& name, const std::vector<FloatRay>& rays, bool coherent, Query query,
                      const auto& ours) {
    std::vector<Index> hits(rays.size());
    const std::size_t sample = std::min<std::size_t>(rays.size(), 256);
    const double expected = bench::seconds_of([&] { ours(rays, std::size_t{0}, sample, hits); }) *
                            static_cast<double>(rays.size()) / static_cast<double>(sample);
    row(
        name, rays, query, coherent, expected / options_.threads,
        [&] {
          bench::in_parts(rays.size(), options_.threads,
                          [&](std::size_t begin, std::size_t end) { ours(rays, begin, end, hits); });
        },
        [&](std::vector<Index>& answers) { answers = hits; });
  }

  /// Compares occlusion from given points, and the shadow rays of the shadow integrator: the time that its
  /// picture takes longer than one without shadows.
  void shadow_rows() {
    if (too_slow("occlusion and shadow rays", image_seconds(ShadowIntegrator{}))) return;
    std::vector<std::pair<int, int>> where;
    const std::vector<FloatRay> rays = to_light(where);
    compare_single("occlusion, single", rays, true, &Embree::any,
                   [this](auto&&... arguments) { any(arguments...); });

    std::vector<Index> hits(rays.size());
    std::vector<Work> works = embree_works(rays, &Embree::any, true, hits);
    // The first of three pictures is not counted: it finds caches and tables of pages as Embree's rays left
    // them.
    works.emplace_back([&] { draw(DiffuseIntegrator{}); });
    works.emplace_back([&] { draw(DiffuseIntegrator{}); });
    works.emplace_back([&] { draw(ShadowIntegrator{}); });
    const Times times(options_, works);
    const std::size_t diffuse = works.size() - 2, shadow = works.size() - 1;
    std::vector<double> ours;
    for (std::size_t run = 0; run < times[shadow].size(); ++run)
      ours.push_back(times[shadow][run] - times[diffuse][run]);

    std::vector<Index> lit;
    for (const auto& [x, y] : where) lit.push_back(image_(x, y) == Color{0} ? 0 : bench::nothing);
    print("shadow rays, render", rays.size(), times, ours, {hits, lit}, 50);
  }

  void row(const std::string& name, const std::vector<FloatRay>& rays, Query query, bool coherent,
           double expected_seconds, const Work& ours, const auto& read_answers) {
    if (too_slow(name, expected_seconds)) return;
    Answers answers;
    answers.embree.resize(rays.size());
    std::vector<Work> works = embree_works(rays, query, coherent, answers.embree);
    works.push_back(ours);
    const Times times(options_, works);
    read_answers(answers.ours);
    print(name, rays.size(), times, times[works.size() - 1], answers);
  }

  bool too_slow(const std::string& name, double expected_seconds) const {
    if (expected_seconds <= too_long) return false;
    std::printf("%s: left out, a run would take %.0f s\n", labelled(name).c_str(), expected_seconds);
    return true;
  }

  std::vector<Work> embree_works(const std::vector<FloatRay>& rays, Query query, bool coherent,
                                 std::vector<Index>& hits) const {
    std::vector<Work> works;
    if (!Embree::is_there) return works;
    for (const Mode mode : {Mode::single, Mode::packet, Mode::stream})
      if (mode != Mode::stream || Embree::has_streams)
        works.emplace_back([this, &rays, query, coherent, &hits, mode] {
          bench::in_parts(rays.size(), options_.threads, [&](std::size_t begin, std::size_t end) {
            (embree_.*query)(mode, coherent, rays, begin, end, hits);
          });
        });
    return works;
  }

  /// Prints the row of a work, in which Embree's modes come first.
  ///
  /// In float a ray needs an offset to leave a surface, of up to a hundredth of a small sphere, and ours have
  /// none. Hence one in fifty answers to rays that leave a surface may differ, and one in a thousand others.
  void print(const std::string& name, std::size_t rays, const Times& times, const std::vector<double>& ours,
             const Answers& answers, std::size_t one_in = 1000) {
    const auto rate = [&](double seconds) { return number(static_cast<double>(rays) / seconds * 1e-6); };
    const std::size_t modes = !Embree::is_there ? 0 : Embree::has_streams ? 3 : 2;
    Table::Cells cells{labelled(name), std::to_string(rays)};
    std::size_t best = 0;
    for (std::size_t mode = 0; mode < 3; ++mode) {
      cells.push_back(mode < modes ? rate(times.seconds(mode)) : "-");
      if (mode < modes && times.seconds(mode) < times.seconds(best)) best = mode;
    }
    cells.push_back(rate(bench::median(ours)));

    std::vector<double> ratios;
    for (std::size_t run = 0; run < ours.size(); ++run) ratios.push_back(times[best][run] / ours[run]);
    const auto hits = [](const std::vector<Index>& all) {
      return all.size() - static_cast<std::size_t>(std::count(all.begin(), all.end(), bench::nothing));
    };
    std::size_t differ = 0;
    for (std::size_t i = 0; i < rays; ++i) differ += answers.embree[i] != answers.ours[i] ? 1 : 0;
    if (modes && differ > rays / one_in)  // more than rounding explains: they do not do the same work
      throw std::runtime_error(labelled(name) + ": " + std::to_string(differ) +
                               " answers differ from Embree's");
    cells.push_back(modes ? number(bench::median(ratios)) : "-");
    cells.push_back(std::to_string(hits(answers.ours)));
    cells.push_back(modes ? std::to_string(hits(answers.embree)) : "-");
    cells.push_back(modes ? std::to_string(differ) : "-");
    table_.row(cells);
  }

  std::string labelled(const std::string& name) const {
    return std::to_string(work_.spheres.size()) + " " + name;
  }

  Table& table_;
  const bench::Options& options_;
  const bench::Workload& work_;
  const Scene<Sphere>& plain_;
  const S& scene_;
  Embree embree_;
  Image image_;
};

/// Returns the number of bytes that the program has allocated.
double allocated() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

/// Measures the time to build the hierarchy, and the memory that it adds to the scene's or, for Embree, the
/// device's together with the spheres that the caller has to keep for it.
void build(Table& table, const bench::Options& options, const bench::Workload& work) {
  const auto scene = bench::scene_of(work);
  const Times times(options, {[&] { bench::keep(Embree(work.spheres, options.threads)); },
                              [&] { bench::keep(bench::traced(scene, options.threads)); }});
  const double before = allocated();
  const auto& traced = bench::traced(scene, options.threads);
  const double ours = allocated() - before;
  bench::keep(traced);
  const double theirs = static_cast<double>(Embree(work.spheres, options.threads).bytes()) +
                        static_cast<double>(work.spheres.size() * sizeof(bench::FloatSphere));
  const bool both = Embree::is_there;
  table.row({std::to_string(work.spheres.size()), both ? number(1e3 * times.seconds(0)) : "-",
             number(1e3 * times.seconds(1)), both ? number(times.ratio(0, 1)) : "-",
             both ? number(1e-6 * theirs) : "-", number(1e-6 * ours)});
}

void spheres(const bench::Options& options) {
  if (!Embree::is_there) std::printf("Embree is not installed, so there is nothing to compare with\n");
  if (!bench::is_accelerated) std::printf("the scene is a plain list: every ray tests every sphere\n");
  const std::vector<std::size_t> counts =
      options.quick ? std::vector<std::size_t>{3, 100} : std::vector<std::size_t>{3, 1000, 100000, 1000000};
  {
    Table table(options, {"spheres and rays", "rays", "Embree single", "packet", "stream", "protostar",
                          "times faster", "hits", "Embree's", "differ"});
    for (const std::size_t count : counts) {
      const bench::Workload work = bench::workload(count);
      const auto scene = bench::scene_of(work);
      const auto& traced = bench::traced(scene, options.threads);
      Contest(table, options, work, scene, traced).run();
    }
  }
  if (!bench::is_accelerated) return;
  Table table(options,
              {"spheres to build", "Embree ms", "protostar ms", "times faster", "Embree MB", "protostar MB"});
  for (const std::size_t count : counts) build(table, options, bench::workload(count));
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, spheres); }
