#include <array>
#include <protostar/accel/candidates.hpp>
#include <protostar/accel/visibility.hpp>
#include <protostar/camera.hpp>
#include <protostar/pixel_grid.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/sphere.hpp>

#include "figures.hpp"
#include "svg.hpp"

using namespace protostar;

namespace figures {

namespace {

constexpr int image_size = 48;
constexpr Tile middle{16, 16, 32, 32};

/// Spheres with their centers in the plane y = 0, which is seen from above; the two in the middle first.
const Sphere all_spheres[] = {
    {.center = {-0.55, 0, 4.4}, .radius = 0.75}, {.center = {0.3, 0, 7.2}, .radius = 1.1},
    {.center = {-3, 0, 5.4}, .radius = 0.9},     {.center = {3.3, 0, 6.4}, .radius = 0.8},
    {.center = {2.6, 0, 3.6}, .radius = 0.6},    {.center = {-1.9, 0, 2.6}, .radius = 0.5},
    {.center = {-0.9, 0, -0.6}, .radius = 0.4}};
const Box box{.min = {0.65, -0.35, 3.9}, .max = {1.15, 0.35, 4.4}};
constexpr int index_of_box = std::size(all_spheres);

constexpr Paint paints[] = {Paint::blue, Paint::green};

/// Returns the drawing's place of a point, seen from above: z upwards.
Place from_above(const Point& p) { return {196 + 46 * p.x, 432 - 46 * p.z}; }
double in_pixels(double length) { return 46 * length; }

void draw_from_above(Drawing& drawing, const simd::Candidates& kept, const simd::PixelRays& rays) {
  std::array<bool, std::size(all_spheres) + 1> is_kept{};
  for (int i = 0; i < kept.size(); ++i) is_kept.at(static_cast<std::size_t>(kept.index(i))) = true;

  // A side of the frustum runs through the apex, at a right angle to its normal.
  const auto side = [&](int column) {
    const auto normal = rays.left_edge(column, &simd::PixelRays::Edge::normal);
    const Vec3 along = normalize(Vec3{-normal.z, 0, normal.x});
    return along.z > 0 ? along : -along;
  };
  const Point apex = rays.camera().position;
  const Point left = apex + 9.0 * side(middle.x0), right = apex + 9.0 * side(middle.x1);
  drawing.polygon({from_above(apex), from_above(left), from_above(right)}, Paint::orange, Fill::soft);
  for (std::size_t i = 0; i < std::size(all_spheres); ++i)
    drawing.circle(from_above(all_spheres[i].center), in_pixels(all_spheres[i].radius),
                   !is_kept[i] ? Paint::gray : paints[i], is_kept[i] ? Fill::soft : Fill::none,
                   is_kept[i] ? Stroke::thin : Stroke::dashed);
  const simd::SphereAround around = simd::sphere_around(box);
  const Paint paint = is_kept[index_of_box] ? Paint::red : Paint::gray;
  drawing.circle(from_above(around.center), in_pixels(around.radius), paint, Fill::none, Stroke::dashed);
  const Place corner = from_above({box.min.x, 0, box.max.z});
  drawing.rectangle(corner, in_pixels(box.max.x - box.min.x), in_pixels(box.max.z - box.min.z), paint,
                    Fill::soft);
  drawing.circle(from_above(apex), 5, Paint::ink, Fill::full);
  const Place camera = from_above(apex);
  drawing.words({camera.x + 14, camera.y + 6}, "camera");
  drawing.words({196, 24}, "The tile's frustum, from above", Anchor::middle, Paint::ink, true);
  drawing.words({200, 468}, "dashed gray: culled", Anchor::start, Paint::gray);
}

void draw_pixels(Drawing& drawing, const simd::Candidates& kept, const simd::PixelRays& rays) {
  using simd::RayBlock;
  constexpr double left = 410, top = 40, size = 14;
  constexpr std::size_t side = 16;
  std::array<std::array<int, side>, side> seen{};  // block by block, the size of which is the machine's
  for (int y = middle.y0; y < middle.y1; y += RayBlock::height)
    for (int x = middle.x0; x < middle.x1; x += RayBlock::width) {
      simd::CandidatePositions places;
      places.add_first(kept.size());
      const auto [first, others, tested] = simd::seen_by(rays.block_directions(x, y), kept, places, false);
      const auto is_sure = others == simd::WideIndices(simd::no_surface_index);
      const auto indices = select(is_sure, first, simd::WideIndices(simd::doubtful_index));
      for (int i = 0; i < simd::float_lanes; ++i)
        seen.at(static_cast<std::size_t>(y + i / RayBlock::width - middle.y0))
            .at(static_cast<std::size_t>(x + i % RayBlock::width - middle.x0)) = indices[i];
    }
  for (std::size_t y = 0; y < side; ++y)
    for (std::size_t x = 0; x < side; ++x) {
      const int index = seen[y][x];
      const bool is_nothing = index == simd::no_surface_index;
      drawing.rectangle({left + size * static_cast<double>(x), top + size * static_cast<double>(y)}, size,
                        size,
                        is_nothing                      ? Paint::gray
                        : index == simd::doubtful_index ? Paint::red
                                                        : paints[static_cast<std::size_t>(index)],
                        is_nothing ? Fill::none : Fill::soft);
    }
  drawing.words({left + 8 * size, 24}, "Visibility buffer", Anchor::middle, Paint::ink, true);
  double y = top + 16 * size + 22;
  const auto legend = [&](Paint paint, Fill fill, const char* words) {
    drawing.rectangle({left, y}, size, size, paint, fill);
    drawing.words({left + 26, y + 13}, words);
    y += 28;
  };
  legend(Paint::gray, Fill::none, "surely nothing");
  legend(paints[0], Fill::soft, "surely the near sphere");
  legend(paints[1], Fill::soft, "surely the far sphere");
  legend(Paint::red, Fill::soft, "in doubt: the box is");
  drawing.words({left + 26, y + 7}, "asked about in double");
}

}  // namespace

std::string tile() {
  const Camera camera;
  const simd::PixelRays rays(camera, PixelGrid(image_size, image_size), image_size, image_size);
  simd::Candidates all, kept;
  for (std::size_t i = 0; i < std::size(all_spheres); ++i)
    all.add(static_cast<int>(i), rays.viewpoint(), simd::sphere_around(all_spheres[i]));
  all.add(index_of_box, rays.viewpoint(), simd::sphere_around(box));
  kept.add(all, simd::Frustum(rays, middle));

  Drawing drawing(640, 480, "How a tile finds what its pixels see");
  draw_from_above(drawing, kept, rays);
  draw_pixels(drawing, kept, rays);
  return drawing.text();
}

}  // namespace figures
