// Compares ways to march along camera rays: by steps of one length, sphere tracing (Hart 1996), enhanced
// sphere tracing (Keinert et al. 2014), and the certified march; the last two also in packets.
//
//   bench_marching [--runs N] [--csv FILE] [--quick]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <protostar/accel/packet.hpp>
#include <protostar/exact/functions.hpp>
#include <protostar/fields/operations.hpp>
#include <protostar/fields/shapes.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/distance_field.hpp>
#include <protostar/surfaces/sphere.hpp>
#include <string>
#include <vector>

#include "marching_ways.hpp"
#include "support.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

using namespace protostar;
using bench::MarchedRay, bench::no_hit, bench::number, bench::Table, bench::Times, bench::Work;

namespace {

constexpr auto lanes = static_cast<std::size_t>(simd::double_lanes);

/// Rays of one packet.
struct Packet {
  simd::Vectors origin, direction;
  simd::Doubles begin, end;
};

/// Camera rays from one eye, in packets.
struct CameraRays {
  std::vector<MarchedRay> single;
  std::vector<Packet> packets;
  double far = 0;  ///< largest parameter at which a ray leaves the ball

  /// Takes the rays through side × side pixels, one at random in each, that enter the ball of a radius. They
  /// start where they enter it, and end where they leave it, so that all ways march the same part of a ray.
  CameraRays(double radius, int side) {
    Random random(11);
    const Point eye(2.1, 1.7, 3.1);
    const Vec3 forward = normalize(-eye), right = normalize(cross(forward, Vec3{0, 1, 0}));
    const Vec3 up = cross(right, forward);
    const auto on_film = [&](int pixel) { return 0.8 * ((pixel + random.interior()) / side - 0.5); };
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double u = on_film(x), v = on_film(y);
        const Vec3 direction = normalize(forward + u * right + v * up);
        const double along = dot(eye, direction), D = along * along - dot(eye, eye) + radius * radius;
        if (!(D > 0)) continue;
        const double half = std::sqrt(D);
        single.push_back(
            {{.origin = eye + (-along - half) * direction, .direction = direction}, {0, 2 * half}});
        far = std::max(far, 2 * half);
      }
    single.resize(single.size() / lanes * lanes);
    for (std::size_t i = 0; i < single.size(); i += lanes) {
      Packet packet{Vec3{0}, Vec3{0}, 0.0, 0.0};
      for (std::size_t k = 0; k < lanes; ++k) {
        const auto lane = static_cast<int>(k);
        const auto& [ray, span] = single[i + k];
        packet.origin.x.set(lane, ray.origin.x);
        packet.origin.y.set(lane, ray.origin.y);
        packet.origin.z.set(lane, ray.origin.z);
        packet.direction.x.set(lane, ray.direction.x);
        packet.direction.y.set(lane, ray.direction.y);
        packet.direction.z.set(lane, ray.direction.z);
        packet.begin.set(lane, span.min), packet.end.set(lane, span.max);
      }
      packets.push_back(packet);
    }
  }
};

/// Answers of a way to all rays, and the number of its evaluations.
struct Answers {
  std::vector<double> t;
  std::uint64_t evaluations = 0;
};
using Way = std::function<void(const CameraRays&, Answers&)>;

/// Returns the way that calls march(ray, evaluations) for each ray.
Way one_by_one(auto march) {
  return [march](const CameraRays& rays, Answers& to) {
    std::uint64_t evaluations = 0;
    for (std::size_t i = 0; i < rays.single.size(); ++i) to.t[i] = march(rays.single[i], evaluations);
    to.evaluations = evaluations;
  };
}

/// Returns the way that calls march(packet, evaluations) for each packet.
Way in_packets(auto march) {
  return [march](const CameraRays& rays, Answers& to) {
    std::uint64_t evaluations = 0;
    for (std::size_t i = 0; i < rays.packets.size(); ++i)
      march(rays.packets[i], evaluations).store(&to.t[i * lanes]);
    to.evaluations = evaluations;
  };
}

/// Wrong answers, per million rays, and the error of the hits that are right, relative to t and at least to
/// 1; without a hit that is right the error is none.
struct Errors {
  double missed = 0, not_there = 0, off = 0;
  std::optional<double> rms;

  Errors(const std::vector<double>& found, const std::vector<double>& truth) {
    double asked = 0, hits = 0, squares = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (std::isnan(truth[i])) continue;
      ++asked;
      missed += found[i] < 0 && truth[i] >= 0;
      not_there += found[i] >= 0 && truth[i] < 0;
      if (found[i] < 0 || truth[i] < 0) continue;
      const double error = std::abs(found[i] - truth[i]) / std::max(1.0, truth[i]);
      off += error > 1e-6;
      ++hits, squares += error * error;
    }
    for (double* const count : {&missed, &not_there, &off}) *count *= 1e6 / std::max(asked, 1.0);
    if (hits > 0) rms = std::sqrt(squares / hits);
  }
};

/// Measures all ways for a field. truth(ray, span) returns t of the first crossing, no_hit, or NaN if it does
/// not know.
template <class F>
void measure(const bench::Options& options, Table& table, const std::string& name, const F& field,
             double radius, int side, const auto& truth) {
  const Marched<F> surface(field, Bounds{Point(-radius), Point(radius)});
  const CameraRays rays(radius, options.quick ? 6 : side);
  const std::size_t count = rays.single.size();
  std::vector<double> true_t;
  for (const auto& [ray, span] : rays.single) true_t.push_back(truth(ray, span));

  struct Row {
    std::string name;
    Way way;
    std::size_t reference;  ///< row that its time and its evaluations are compared with
  };
  std::vector<Row> rows;
  const auto add_epsilon = [&](const char* way, double epsilon, const auto& march) {
    rows.push_back({way + number(epsilon), one_by_one([&field, epsilon, march](const auto& ray, auto& n) {
                      return march(field, ray, epsilon, n);
                    }),
                    0});
  };
  const auto enhanced = [](const F& f, const auto& ray, double e, auto& n) {
    return bench::enhanced(f, ray, e, n);
  };
  add_epsilon("enhanced ", 1e-6, enhanced);
  rows.push_back({"certified", one_by_one([&surface](const MarchedRay& marched, std::uint64_t& n) {
                    MarchCounts counts;
                    const MarchedRoot root = surface.march(marched.ray, {0, marched.span.max}, counts);
                    n += counts.evaluations();
                    return root.answer == MarchedRoot::Answer::miss ? no_hit : root.t();
                  }),
                  0});
  // Evaluations of packets are those of their rays, which the rows above count.
  rows.push_back({"enhanced 1e-06, packets", in_packets([&field](const Packet& packet, std::uint64_t&) {
                    return bench::enhanced(field, packet.origin, packet.direction, packet.begin, packet.end,
                                           1e-6);
                  }),
                  2});
  rows.push_back({"certified, packets", in_packets([&surface, &rays](const Packet& packet, std::uint64_t&) {
                    const simd::RayPacket of_rays(packet.origin, packet.direction);
                    const auto first = simd::first_crossings(surface, of_rays, true, Interval{0, rays.far});
                    return select(first.met, first.t, simd::Doubles(no_hit));
                  }),
                  2});
  for (const double epsilon : {1e-3, 1e-4, 1e-5}) add_epsilon("enhanced ", epsilon, enhanced);
  for (const double epsilon : {1e-3, 1e-4, 1e-5, 1e-6})
    add_epsilon("sphere tracing ", epsilon, [](const F& f, const auto& ray, double e, auto& n) {
      return bench::sphere_tracing(f, ray, e, n);
    });
  for (const double step : {0.1, 0.01})
    add_epsilon("fixed step ", step, [](const F& f, const auto& ray, double length, auto& n) {
      return bench::fixed_step(f, ray, length, n);
    });

  std::vector<Answers> answers(rows.size(), Answers{std::vector<double>(count)});
  std::vector<Work> works;
  for (std::size_t i = 0; i < rows.size(); ++i)
    works.emplace_back([&, i] {
      rows[i].way(rays, answers[i]);
      bench::keep(answers[i]);
    });
  const Times times(options, works);
  const auto a_ray = [&](double all) { return all / static_cast<double>(count); };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Errors errors(answers[i].t, true_t);
    const auto of = static_cast<double>(answers[i].evaluations);
    table.row({name + ", " + rows[i].name, of > 0 ? number(a_ray(of)) : "",
               of > 0 ? number(of / static_cast<double>(answers[0].evaluations)) : "",
               number(a_ray(1e9 * times.shortest(i))), number(times.ratio(i, rows[i].reference)),
               number(errors.missed), number(errors.not_there), number(errors.off),
               errors.rms ? number(*errors.rms) : "-"});
  }
}

void marching(const bench::Options& options) {
  Table table(options, {"field and way", "evaluations", "share", "ns/ray", "times", "missed/M", "false/M",
                        "off/M", "error of t"});
  const auto of_surface = [](const auto& surface) {
    return [surface](const Ray& ray, Interval) { return first_t(surface, ray, {}).value_or(no_hit); };
  };
  const auto narrowed = [](const auto& field) {
    return [field](const Ray& ray, Interval span) {
      const TrueRoot root = true_first_root(field, ray, span.min, span.max);
      return root.answer == TrueRoot::Answer::miss  ? no_hit
             : root.answer == TrueRoot::Answer::hit ? root.t
                                                    : std::nan("");
    };
  };
  constexpr int many = 400, some = 100;  // rays with a true answer in closed form are many
  const auto narrow = [&](const char* name, const auto& field, double radius) {
    measure(options, table, name, field, radius, some, narrowed(field));
  };
  const Vec3 box(2, 1.4, 1);
  measure(options, table, "sphere", fields::Sphere{1}, 1.1, many, of_surface(Sphere{Point(0), 1}));
  narrow("torus", fields::Torus{1, 0.3}, 1.4);
  measure(options, table, "box", fields::Box{box}, 1.4, many, of_surface(Box{-0.5 * box, 0.5 * box}));
  narrow("rounded box", fields::RoundedBox{box, 0.1}, 1.4);
  using fields::Moved, fields::blend;
  const auto ball = [](const Point& center, double ball_radius) {
    return Moved{fields::Sphere{ball_radius}, center};
  };
  narrow(
      "blend",
      blend(blend(ball({-0.6, 0, 0}, 0.6), ball({0.6, 0.1, 0}, 0.5), 0.3), ball({0.1, 0.7, 0.3}, 0.4), 0.3),
      1.4);
  narrow("gyroid", fields::intersect(fields::Gyroid{1, 0.3}, fields::Sphere{1.4}), 1.5);
  narrow("sponge", fields::MengerSponge{2, 4}, 1.75);
  measure(options, table, "shell", fields::Shell{fields::Sphere{1}, 2e-6}, 1.1, many,
          of_surface(Sphere{Point(0), 1 + 1e-6}));
}

}  // namespace

int main(int argc, char** argv) { return bench::run(argc, argv, marching); }
