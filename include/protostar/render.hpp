// The loop over the pixels (§2.2.5), in tiles, by several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "camera.hpp"
#include "image.hpp"
#include "scene.hpp"

#if !defined(__cpp_lib_jthread)
#error "protostar needs std::jthread and std::stop_token: libstdc++ 10 or newer"
#endif

namespace protostar::inline PROTOSTAR_ABI {

/// How render works. An exception that progress throws ends the render and reaches its caller; after a stop,
/// progress does not come to 1.
struct RenderOptions {
  int threads = 0;            ///< how many work, the caller among them; 0: one for each core
  std::stop_token stop = {};  ///< asked for, render returns early; other pixels stay as they were
  std::function<void(double done)> progress = {};  ///< called in the caller's thread with a share from 0 to 1
};

/// What gives the light that a ray brings: any function of a ray.
template <class F>
concept Radiance = std::is_invocable_r_v<Color, const F&, const Ray&>;

/// What gives the light that a ray brings in a scene: a struct with radiance(ray, scene), or a function of
/// both.
template <class I, class S>
concept Integrator = std::is_invocable_r_v<Color, const I&, const Ray&, const S&> ||
    requires(const I& integrator, const Ray& ray, const S& scene) {
  { integrator.radiance(ray, scene) } -> std::convertible_to<Color>;
};

namespace detail {

/// Calls work(i) for every i in [0, count), by as many threads as the options say. They take what comes next,
/// so that none waits for another. The first exception ends all of them and is thrown in the caller's thread.
/// The work's type is forgotten, so that a unit that renders twice compiles this once.
inline void for_each_in_parallel(int count, const RenderOptions& options,
                                 const std::function<void(int)>& work) {
  if (options.threads < 0)
    throw std::invalid_argument("RenderOptions: threads must be 0 (all cores) or more");
  const int wanted =
      options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());

  std::atomic<int> next = 0, done = 0;
  std::exception_ptr failure;
  std::once_flag failed;
  const auto fail = [&](const std::exception_ptr& exception) {
    std::call_once(failed, [&] { failure = exception; });
    next = count;
  };
  const auto run = [&](const auto& after_each) {
    try {
      for (int i = next++; i < count && !options.stop.stop_requested(); i = next++) {
        work(i);
        ++done;
        after_each();
      }
    } catch (...) {
      fail(std::current_exception());
    }
  };
  int told = 0;
  const auto tell = [&] {
    told = done;
    if (options.progress) options.progress(static_cast<double>(told) / count);
  };
  {
    std::vector<std::jthread> helpers;  // joined at the end of this block
    try {
      for (int i = 1; i < std::min(wanted, count); ++i) helpers.emplace_back([&] { run([] {}); });
    } catch (const std::system_error& error) {
      fail(std::make_exception_ptr(
          std::system_error(error.code(), "render: cannot start " + std::to_string(wanted) + " threads")));
    }
    run(tell);
  }
  if (failure) std::rethrow_exception(failure);
  if (told < done) tell();  // a helper was the last
}

}  // namespace detail

/// Fills an image with what a camera sees, one ray through each pixel's center; radiance says what a ray
/// brings, and is called from several threads at once. The picture is the same for any number of threads.
///
/// Throws std::invalid_argument for an invalid camera or a negative number of threads, and whatever radiance
/// throws.
void render(Image& image, const Camera& camera, const Radiance auto& radiance,
            const RenderOptions& options = {}) {
  camera.validate();
  constexpr int side = 32;  // of a tile, in pixels
  const int columns = (image.width() + side - 1) / side, rows = (image.height() + side - 1) / side;
  detail::for_each_in_parallel(columns * rows, options, [&](int tile) {
    const int x0 = tile % columns * side, y0 = tile / columns * side;
    const int x1 = std::min(x0 + side, image.width()), y1 = std::min(y0 + side, image.height());
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        image(x, y) = radiance(camera.through_pixel(x, y, image.width(), image.height()));
  });
}

/// Fills an image with what a camera sees of a scene, through an integrator. Errors as above.
template <Traceable S, Integrator<S> I>
void render(Image& image, const Camera& camera, const S& scene, const I& integrator,
            const RenderOptions& options = {}) {
  const auto radiance = [&](const Ray& ray) -> Color {
    if constexpr (std::is_invocable_r_v<Color, const I&, const Ray&, const S&>)
      return integrator(ray, scene);
    else
      return integrator.radiance(ray, scene);
  };
  render(image, camera, radiance, options);
}

}  // namespace protostar::inline PROTOSTAR_ABI
