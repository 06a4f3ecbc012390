// Paths of some pixels on their way together: each takes a step, then each takes the next.
//
// All paths of a wave have come equally far, so that they take the same set of their samplers, and its
// numbers and the directions to which they lead are drawn in lanes; so are directions to rectangles that
// shine, and in scenes of few surfaces the rays of the paths and those to area lights are traced in lanes.
// All else is done path by path: without the lanes, a wave takes as long as its paths one after the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <utility>

#include "../intersection.hpp"
#include "../interval.hpp"
#include "../pixel_grid.hpp"
#include "../sampling/pixel_sampler.hpp"
#include "../sampling/warp_lanes.hpp"
#include "../simd/prefetch.hpp"
#include "../simd/words.hpp"
#include "../uninitialized.hpp"
#include "packet.hpp"
#include "packet_integrator.hpp"
#include "packet_pixels.hpp"
#include "pixel_rays.hpp"

namespace protostar::inline PROTOSTAR_ABI::simd {

/// Paths of an integrator that follows them (FollowsPaths), and the light of the packets in which they began.
template <class I>
class PathWave {
 public:
  /// Largest number of packets: enough that lanes are full after some bounces as well, and few, so that their
  /// paths and hits take little memory.
  static constexpr std::size_t most_starting_packets = 64 / double_lanes;

  /// Begins the path of pixel (x, y) of the image, which is a lane of a packet of the wave, at the first hit
  /// of its camera ray. A packet's number is below most_starting_packets.
  void begin(const Ray& ray, const SurfaceCrossing& first, int x, int y, std::size_t packet, int lane) {
    new (&hits_[count_]) std::optional<Intersection>(std::in_place, ray, first);
    new (&paths_[count_]) typename I::Path;
    pixels_[count_] = {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                       packet * lanes + static_cast<std::size_t>(lane)};
    on_the_way_[count_] = count_;
    ++count_;
  }

  /// Sets the light of all lanes of a packet; follow() replaces it where a path has begun.
  void set(std::size_t packet, const Colors& light) {
    light.r.store(&light_[0][packet * lanes]);
    light.g.store(&light_[1][packet * lanes]);
    light.b.store(&light_[2][packet * lanes]);
  }

  /// Returns the light of a packet, once follow() has returned.
  [[nodiscard]] Colors light(std::size_t packet) const {
    const auto load = [&](std::size_t channel) { return Floats::load(&light_[channel][packet * lanes]); };
    return {load(0), load(1), load(2)};
  }

  /// Follows all paths to their ends, with the numbers of sample i of their pixels. Throws std::logic_error
  /// if the integrator was made for another scene.
  void follow(const I& integrator, const auto& scene, const PixelGrid& grid, int i) {
    const auto finish = [&](std::size_t k, const Color& light) {
      for (int channel = 0; channel < 3; ++channel)
        light_[static_cast<std::size_t>(channel)][pixels_[k].number] = light[channel];
    };
    if (count_ > 0) integrator.require(scene);
    for (std::uint32_t set = 1; count_ > 0; ++set) {
      std::array<Drawn, most_starting_packets> drawn;
      for (std::size_t first = 0; first < count_; first += lanes)
        drawn[first / lanes] = draw(grid, i, set, first, std::min(lanes, count_ - first));
      const auto path = [&](std::size_t k) -> auto& { return paths_[on_the_way_[k]]; };
      const auto hit = [&](std::size_t k) -> const Intersection& { return *hits_[on_the_way_[k]]; };
      const auto numbers = [&](std::size_t k) { return drawn[k / lanes][k % lanes]; };
      std::array<bool, most> goes_on;
      if constexpr (MeetsTogether<I>)
        integrator.meet_each(count_, path, hit, numbers, scene, goes_on);
      else
        for (std::size_t k = 0; k < count_; ++k)
          goes_on[k] = integrator.meet(path(k), hit(k), scene, [&] { return numbers(k); });

      std::size_t on_the_way = 0;
      for (std::size_t k = 0; k < count_; ++k)
        if (goes_on[k])
          on_the_way_[on_the_way++] = on_the_way_[k];
        else
          finish(on_the_way_[k], path(k).sum);
      count_ = on_the_way;
      on_the_way = 0;
      for (std::size_t first = 0; first < count_; first += lanes) {
        const std::size_t some = std::min(lanes, count_ - first);
        scene.intersect_each(
            some, [&](std::size_t lane) -> const Ray& { return paths_[on_the_way_[first + lane]].ray; },
            [&](std::size_t lane) { return &hits_[on_the_way_[first + lane]]; });
        for (std::size_t lane = 0; lane < some; ++lane) {
          const std::size_t k = on_the_way_[first + lane];
          if (hits_[k]) {
            on_the_way_[on_the_way++] = k;
            prefetch_whole(hits_[k]->material());  // read at the path's next vertex
          } else {
            finish(k, integrator.leave(paths_[k], scene));
          }
        }
      }
      count_ = on_the_way;
    }
  }

 private:
  static constexpr std::size_t lanes = static_cast<std::size_t>(double_lanes),
                               most = most_starting_packets * lanes;

  /// Pixel of the image, and the number of its lane in all packets.
  struct Pixel {
    std::uint32_t x, y;
    std::size_t number;
  };

  /// I::Numbers, one in each lane: those of a set, and the local directions to which they lead.
  struct Drawn {
    double numbers[4][lanes], hemisphere[3][lanes];

    [[nodiscard]] typename I::Numbers operator[](std::size_t lane) const {
      return {{numbers[0][lane], numbers[1][lane], numbers[2][lane], numbers[3][lane]},
              {hemisphere[0][lane], hemisphere[1][lane], hemisphere[2][lane]}};
    }
  };

  /// Draws a set of numbers for some of the paths, one in each lane.
  [[nodiscard]] Drawn draw(const PixelGrid& grid, int i, std::uint32_t set, std::size_t first,
                           std::size_t some) const {
    std::array<std::uint32_t, lanes> x{}, y{};
    for (std::size_t lane = 0; lane < some; ++lane) {
      const Pixel& pixel = pixels_[on_the_way_[first + lane]];
      x[lane] = pixel.x, y[lane] = pixel.y;
    }
    const SampleSet<Doubles> numbers = grid.samplers(Words::load(x.data()), Words::load(y.data()), i)(set);
    const Vectors hemisphere = cosine_hemisphere(numbers[0], numbers[1]);
    Drawn drawn;
    for (std::size_t d = 0; d < 4; ++d) numbers[d].store(drawn.numbers[d]);
    hemisphere.x.store(drawn.hemisphere[0]);
    hemisphere.y.store(drawn.hemisphere[1]);
    hemisphere.z.store(drawn.hemisphere[2]);
    return drawn;
  }

  std::size_t count_ = 0;
  std::array<std::size_t, most> on_the_way_;
  std::array<Pixel, most> pixels_;
  Uninitialized<typename I::Path, most> paths_;
  Uninitialized<std::optional<Intersection>, most> hits_;
  std::array<std::array<float, most>, 3> light_;
};

/// Follows the paths of sample i of the pixels of some packets in a part of a tile, and calls give(k, light)
/// with the light of packet k. A path begins at the closest hit of its camera ray. For packet k, packets[k]
/// is the pixel of its first lane, ray_numbers[k] are those of its camera rays, and closest[k] what they hit
/// first.
template <class I, class View>
[[gnu::noinline]] void follow_paths(const I& integrator, const View& view, const PixelRays& rays_of,
                                    const Tile& part, int i, std::span<const PacketStart> packets,
                                    const PacketRays* ray_numbers, const typename View::Closest* closest,
                                    const auto& give) {
  PathWave<I> wave;
  for (std::size_t first = 0; first < packets.size(); first += wave.most_starting_packets) {
    const std::size_t count = std::min(wave.most_starting_packets, packets.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      const PacketStart start = packets[first + k];
      view.set_packet_position(start.x, start.y, i);
      const CameraPacket rays = rays_of.packet(part, start.x, start.y, i, ray_numbers[first + k]);
      const auto begin = [&](const Ray& ray, const SurfaceCrossing& hit, int lane) {
        wave.begin(ray, hit, start.x + lane, start.y, k, lane);
      };
      const LaneMask met = view.each_hit(rays, closest[first + k], begin);
      wave.set(k, any(rays.active && !met) ? Colors(integrator.background(rays, view)) : Colors(Color{0}));
    }
    wave.follow(integrator, view, rays_of.pixels(), i);
    for (std::size_t k = 0; k < count; ++k) give(first + k, wave.light(k));
  }
}

}  // namespace protostar::inline PROTOSTAR_ABI::simd
