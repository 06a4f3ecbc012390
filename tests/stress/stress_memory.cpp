// Pictures for which there is not enough memory: each request for memory of the thread that draws fails in
// its turn. std::bad_alloc has to reach the caller, all memory has to be given back, and other threads have
// to stop.
#include <protostar/parallel.hpp>
#include <protostar/protostar.hpp>
#include <protostar/surfaces/mesh.hpp>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <new>
#include <string>
#include <thread>

#include "support/meshes.hpp"

using namespace protostar;

namespace {

std::atomic<long> blocks = 0;     ///< blocks of memory in use
thread_local long requests = -1;  ///< requests of this thread until one fails; negative: none does

[[nodiscard]] void* block(std::size_t bytes, std::size_t alignment) {
  if (requests == 0) throw std::bad_alloc();
  if (requests > 0) --requests;
  void* const memory = std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  ++blocks;
  return memory;
}

void give_back(void* memory) {
  if (memory != nullptr) --blocks;
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t bytes) { return block(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return block(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give_back(memory); }

namespace {

int failures = 0;

void expect(bool holds, const std::string& what, long request) {
  if (holds) return;
  ++failures;
  std::cout << what << " after request " << request << "\n";
}

/// Calls work with each request for memory failing in turn, until none does; judge(request) looks at what a
/// failure leaves behind.
void without_memory(const std::string& name, const auto& work, const auto& judge) {
  long request = 0;
  for (bool is_done = false; !is_done; ++request) {
    const long before = blocks;
    requests = request;
    try {
      work();
      is_done = true;
    } catch (const std::bad_alloc&) {
    }
    requests = -1;
    const long kept = blocks - before;
    expect(kept == 0, name + ": " + std::to_string(kept) + " blocks are not given back", request);
    if (!is_done) judge(request);
  }
  std::cout << name << ": " << request - 1 << " requests\n";
}

void draw(const std::string& name, const auto& scene, const auto& integrator, const RenderOptions& options) {
  Image image(70, 40);
  const Camera camera = Camera::perspective({0.1, 0.2, -4}, {0.01, 0, 1}, {0, 1, 0}, 60);
  const auto picture = [&] { render(image, camera, scene, integrator, options); };
  picture();  // what the standard library makes once is there
  without_memory(name, picture, [](long) {});
}

/// Threads that have started stop if the next one cannot be started.
void start_threads() {
  std::atomic<int> done = 0;
  constexpr int count = 1000;
  without_memory(
      "threads",
      [&] {
        done = 0;
        protostar::detail::for_each_in_parallel(count, {.threads = 4}, [&](int) {
          ++done;
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        });
      },
      [&](long request) { expect(done < count, "threads go on to the end", request); });
}

}  // namespace

int main() {
  start_threads();
  Scene<Sphere, Mesh> mesh;
  mesh.add(Mesh(meshes::torus(40, 20)), Color{1, 0.5f, 0.2f});
  for (int i = 0; i < 40; ++i) mesh.add(Sphere{{-2 + 0.1 * i, 1.5, 2}, 0.2}, Color{0.2f, 0.4f, 1});
  mesh.add(PointLight{.position = {-3, 3, -4}, .power = Color{600}});
  draw("a mesh", mesh, ShadowIntegrator{}, {.threads = 2});
  draw("a mesh, with samples", mesh, ColorIntegrator{}, {.samples = 4, .threads = 1});

  Scene<Sphere, Plane> spheres;
  for (int i = 0; i < 3000; ++i)
    spheres.add(Sphere{{-2 + 0.1 * (i % 40), -2 + 0.1 * (i / 40), 2 + 0.001 * i}, 0.06},
                Color{0.2f, 0.4f, 1});
  spheres.add(Plane{.normal = {0, 1, 0}, .distance = -2.5}, Color{1});
  spheres.add(PointLight{.position = {-3, 3, -4}, .power = Color{600}});
  draw("spheres", spheres, WhittedIntegrator{}, {.threads = 2});
  return failures == 0 ? 0 : 1;
}
