// Checks that a long OBJ file is read completely, and measures the time.
//
//   stress_obj [--lines N]
//
// Writes N lines (200,000) to a temporary file: a grid whose last column and row are joined to the first,
// each point with a normal and texture coordinates, and as many quadrangles. Exits with 1 if a vertex or a
// triangle is not read as it was written.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <protostar/io/obj.hpp>
#include <stdexcept>
#include <string>

#include "options.hpp"
#include "support/files.hpp"

using namespace protostar;

namespace {

constexpr std::uint32_t width = 100;

/// Returns the corners of the quadrangle at a grid point, as numbers of grid points.
std::array<std::uint32_t, 4> corners_at(std::uint32_t place, std::uint32_t height) {
  const std::uint32_t x = place % width, y = place / width;
  const std::uint32_t next_x = (x + 1) % width, next_y = (y + 1) % height;
  return {y * width + x, y * width + next_x, next_y * width + next_x, next_y * width + x};
}

void write(const std::filesystem::path& path, std::uint32_t height) {
  std::ofstream file(path, std::ios::binary);
  for (std::uint32_t i = 0; i < width * height; ++i)
    file << "v " << i % width << ' ' << i / width << " 0.1\nvn 0.25 -" << i << " 1\nvt " << i << " 0.5\n";
  for (std::uint32_t i = 0; i < width * height; ++i) {
    file << 'f';
    for (const std::uint32_t corner : corners_at(i, height))
      file << ' ' << corner + 1 << '/' << corner + 1 << '/' << corner + 1;
    file << '\n';
  }
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

/// Returns the number of triangle corners that are not as they were written. A vertex may have any number:
/// its normal tells the grid point.
std::size_t wrong_in(const MeshData& data, std::uint32_t height) {
  const std::size_t places = std::size_t{width} * height;
  if (data.vertices.size() != places || data.normals.size() != places || data.uvs.size() != places ||
      data.triangles.size() != 2 * places)
    return 4 * places;
  std::size_t wrong = 0;
  for (std::uint32_t i = 0; i < places; ++i) {
    const auto [a, b, c, d] = corners_at(i, height);
    const std::array<std::uint32_t, 6> meant{a, b, c, a, c, d};
    for (std::size_t k = 0; k < 6; ++k) {
      const std::uint32_t vertex = data.triangles[2 * std::size_t{i} + k / 3][k % 3], place = meant[k];
      const double number = place;
      wrong += data.vertices[vertex] != Point{place % width, place / width, 0.1} ||
               data.normals[vertex] != Vec3{0.25, -number, 1} || data.uvs[vertex] != Uv{number, 0.5};
    }
  }
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::uint64_t lines = Options(argc, argv, {"--lines"}).number("--lines", 200'000);
    const std::uint64_t rows = std::max<std::uint64_t>(lines / (4 * width), 3);  // four lines a grid point
    if (rows > 125'000)  // 2 GB; load_obj reads up to 2^31 bytes
      throw std::invalid_argument("--lines: at most 50,000,000");
    const auto height = static_cast<std::uint32_t>(rows);

    const TemporaryFolder folder;
    const std::filesystem::path path = folder / "long.obj";
    write(path, height);
    const auto begin = std::chrono::steady_clock::now();
    const MeshData data = load_obj(path);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    const std::size_t wrong = wrong_in(data, height);
    std::printf("%llu lines, %llu bytes: %.2f s\n%s\n", 4ull * width * height,
                static_cast<unsigned long long>(std::filesystem::file_size(path)), time.count(),
                wrong == 0 ? "all right" : "not what was written");
    return wrong == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stress_obj: %s\n", error.what());
    return 2;
  }
}
