// The plain ray tracer, step 26: hundreds of balls below a sky that lights them, and a tree.
//
// g++ -O2 -std=c++20 26_weekend.cpp -o 26_weekend && ./26_weekend
//
// writes the picture to out.ppm. The page docs/stages/26_weekend.md explains the step.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

// Three numbers: a point, a direction, or the red, green and blue light of a color.
struct Vec {
  double x = 0, y = 0, z = 0;
};

using Color = Vec;
using Point = Vec;

Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
Vec operator*(const Vec& a, const Vec& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

// The dot product: |a| |b| times the cosine of the angle between a and b. dot(a, a) is |a|².
double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double length(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec normalize(const Vec& a) { return 1 / length(a) * a; }

// The cross product: a vector at right angles to both a and b.
Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// A picture: the light of each pixel, row by row from the top, each row from the left.
struct Image {
  int width, height;
  std::vector<Color> pixels = std::vector<Color>(width * height);

  Color& at(int x, int y) { return pixels[y * width + x]; }
};

// Turns light, from 0 for black to 1 for white, into the nearest whole number from 0 to 255.
// A screen shows the number k with the light (k/255)^2.2, so the number is 255 · light^(1/2.2).
int code(double light) {
  return static_cast<int>(255 * std::pow(std::clamp(light, 0.0, 1.0), 1 / 2.2) + 0.5);
}

// Saves the picture as a PPM file, which is a text: "P3", the size, the largest number, then all pixels.
void save(const Image& image) {
  std::ofstream file("out.ppm");
  file << "P3\n" << image.width << ' ' << image.height << "\n255\n";
  for (const Color& c : image.pixels) file << code(c.x) << ' ' << code(c.y) << ' ' << code(c.z) << '\n';
}

// A ray: the points origin + t · direction with t > 0. The direction has length 1, so t is the distance.
struct Ray {
  Point origin;
  Vec direction;
};

Point point_at(const Ray& ray, double t) { return ray.origin + t * ray.direction; }

// The eye of the camera, and the directions to the right, upwards and forwards from it. The field of view is
// the angle between the upper and the lower edge of the picture.
const Point eye{13, 2, 3};
const Vec forward = normalize(Point{0, 0, 0} - eye), right = normalize(cross(forward, {0, 1, 0}));
const Vec up = cross(right, forward);
const double field_of_view = 20;

// The lens is a disk around the eye, of this radius. What is at the distance focus along forward is sharp.
const double focus = 10, aperture = focus * std::tan(0.3 * std::numbers::pi / 180);

// The ray from the eye through a place of the picture, x pixels from its left edge and y from its upper edge.
Ray camera_ray(const Image& image, double x, double y) {
  const double half = std::tan(field_of_view / 2 * std::numbers::pi / 180);
  const double u = (2 * x - image.width) / image.height;
  const double v = (image.height - 2 * y) / image.height;
  return {eye, normalize(u * half * right + v * half * up + forward)};
}

// The t of a ray that hits nothing.
const double infinity = std::numeric_limits<double>::infinity();

// A point at which the line of a ray crosses a surface. The normal is at right angles to the surface there.
struct Crossing {
  double t;
  Vec normal;
};

// A surface is a function: it takes a ray and returns all crossings, in their order along the ray.
using Crossings = std::vector<Crossing>;
using Surface = std::function<Crossings(const Ray&)>;

// The solutions of a t² + b t + c = 0. For a = 0 this is no quadratic equation, and there is one at most.
std::vector<double> roots(double a, double b, double c) {
  if (a == 0) return {-c / b};
  const double D = b * b - 4 * a * c;
  if (D < 0) return {};
  const double t1 = (-b - std::sqrt(D)) / (2 * a), t2 = (-b + std::sqrt(D)) / (2 * a);
  return {std::min(t1, t2), std::max(t1, t2)};
}

// A sphere: the points p with |p - center| = radius.
Surface sphere(Point center, double radius) {
  return [=](const Ray& ray) {
    const Vec v = ray.origin - center;
    Crossings result;
    for (const double t :
         roots(dot(ray.direction, ray.direction), 2 * dot(ray.direction, v), dot(v, v) - radius * radius))
      result.push_back({t, point_at(ray, t) - center});
    return result;
  };
}

// A quadric: the points p with f(p) = squares · p² + 2 linear · p + constant = 0, where p² = (x², y², z²).
Surface quadric(Vec squares, Vec linear, double constant) {
  return [=](const Ray& ray) {
    const Vec o = ray.origin, d = ray.direction;
    Crossings result;
    for (const double t : roots(dot(squares, d * d), 2 * (dot(squares, o * d) + dot(linear, d)),
                                dot(squares, o * o) + 2 * dot(linear, o) + constant))
      result.push_back({t, squares * point_at(ray, t) + linear});  // half of the gradient of f
    return result;
  };
}

// A box: the points between three pairs of parallel planes. The ray is inside of it from the last plane
// through which it enters to the first one through which it leaves.
Surface box(Point low, Point high) {
  return [=](const Ray& ray) -> Crossings {
    Crossing enters{-infinity, {}}, leaves{infinity, {}};
    for (const Vec& axis : {Vec{1, 0, 0}, Vec{0, 1, 0}, Vec{0, 0, 1}}) {
      const double t1 = dot(axis, low - ray.origin) / dot(axis, ray.direction);
      const double t2 = dot(axis, high - ray.origin) / dot(axis, ray.direction);
      if (std::min(t1, t2) > enters.t) enters = {std::min(t1, t2), axis};
      if (std::max(t1, t2) < leaves.t) leaves = {std::max(t1, t2), axis};
    }
    if (enters.t > leaves.t) return {};
    return {enters, leaves};
  };
}

// A part of the plane through a point: the points p at which the outline contains p - point. The ray crosses
// the plane if normal · (o + t d - point) = 0.
Surface flat(Point point, Vec normal, std::function<bool(const Vec&)> contains) {
  return [=](const Ray& ray) -> Crossings {
    const double t = dot(normal, point - ray.origin) / dot(normal, ray.direction);
    if (!contains(point_at(ray, t) - point)) return {};
    return {{t, normal}};
  };
}

Surface plane(Point point, Vec normal) {
  return flat(point, normal, [](const Vec&) { return true; });
}

Surface disk(Point center, Vec normal, double radius) {
  return flat(center, normal, [=](const Vec& v) { return length(v) <= radius; });
}

// The numbers α and β with v = α a + β b, for a vector v in the plane of a and b.
std::pair<double, double> coordinates(const Vec& v, const Vec& a, const Vec& b) {
  const Vec n = cross(a, b);
  return {dot(cross(v, b), n) / dot(n, n), dot(cross(a, v), n) / dot(n, n)};
}

Surface parallelogram(Point corner, Vec a, Vec b) {
  return flat(corner, cross(a, b), [=](const Vec& v) {
    const auto [alpha, beta] = coordinates(v, a, b);
    return 0 <= alpha && alpha <= 1 && 0 <= beta && beta <= 1;
  });
}

Surface triangle(Point p, Point q, Point r) {
  return flat(p, cross(q - p, r - p), [=](const Vec& v) {
    const auto [alpha, beta] = coordinates(v, q - p, r - p);
    return 0 <= alpha && 0 <= beta && alpha + beta <= 1;
  });
}

enum class Kind { matte, metal, glass };

// A ball in the scene. Metal blurs what it mirrors by its fuzz. Glass has no color: it sends all light on.
struct Object {
  Point center;
  double radius;
  Kind kind;
  Color color;
  double fuzz = 0;
  Surface surface = sphere(center, radius);
};

// A list of numbers that looks random, and is always the same one.
double next_number(double least, double most) {
  static std::uint64_t state = 2016;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return least + (most - least) * static_cast<double>(state >> 40) / (1 << 24);
}

Color next_color(double least) {
  const double r = next_number(least, 1), g = next_number(least, 1), b = next_number(least, 1);
  return {r, g, b};
}

// The balls: the ground, small ones of all kinds, each near a place of a grid, and three large ones.
std::vector<Object> all_balls() {
  std::vector<Object> balls{{{0, -1000, 0}, 1000, Kind::matte, {0.5, 0.5, 0.5}}};
  for (int a = -11; a < 11; ++a)
    for (int b = -11; b < 11; ++b) {
      const double chosen = next_number(0, 1), x = a + next_number(0, 0.9), z = b + next_number(0, 0.9);
      const Point center{x, 0.2, z};
      if (length(center - Point{4, 0.2, 0}) <= 0.9) continue;  // it would touch the third large ball
      if (chosen < 0.8) {
        const Color one = next_color(0);
        balls.push_back({center, 0.2, Kind::matte, one * next_color(0)});
      } else if (chosen < 0.95) {
        const Color light = next_color(0.5);
        balls.push_back({center, 0.2, Kind::metal, light, next_number(0, 0.5)});
      } else {
        balls.push_back({center, 0.2, Kind::glass, {}});
      }
    }
  balls.push_back({{0, 1, 0}, 1, Kind::glass, {}});
  balls.push_back({{-4, 1, 0}, 1, Kind::matte, {0.4, 0.2, 0.1}});
  balls.push_back({{4, 1, 0}, 1, Kind::metal, {0.7, 0.6, 0.5}});
  return balls;
}

std::vector<Object> objects = all_balls();

// A part of a tree: a box around the balls from first to last, last not included. It has two halves, or one
// ball.
struct Part {
  Point low, high;
  int first, last;
  std::vector<Part> halves;
};

// Sorts the balls of a part along the longer level side of its box, and gives each half a box.
Part tree(int first, int last) {
  Part part{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}, first, last, {}};
  for (int i = first; i < last; ++i) {
    const auto [x, y, z] = objects[i].center;
    const double R = objects[i].radius;
    part.low = {std::min(part.low.x, x - R), std::min(part.low.y, y - R), std::min(part.low.z, z - R)};
    part.high = {std::max(part.high.x, x + R), std::max(part.high.y, y + R), std::max(part.high.z, z + R)};
  }
  if (last - first == 1) return part;
  const Vec size = part.high - part.low;
  const Vec axis = size.x > size.z ? Vec{1, 0, 0} : Vec{0, 0, 1};
  std::sort(objects.begin() + first, objects.begin() + last,
            [&](const Object& a, const Object& b) { return dot(axis, a.center) < dot(axis, b.center); });
  const int middle = (first + last) / 2;
  part.halves = {tree(first, middle), tree(middle, last)};
  return part;
}

const Part all = tree(0, static_cast<int>(objects.size()));

// Returns true if a ray meets a box before t: if it is between all three pairs of planes somewhere.
bool meets(const Ray& ray, const Part& part, double t) {
  double enters = 0, leaves = t;
  const auto between = [&](double low, double high, double origin, double direction) {
    const double t1 = (low - origin) / direction, t2 = (high - origin) / direction;
    enters = std::max(enters, std::min(t1, t2));
    leaves = std::min(leaves, std::max(t1, t2));
  };
  between(part.low.x, part.high.x, ray.origin.x, ray.direction.x);
  between(part.low.y, part.high.y, ray.origin.y, ray.direction.y);
  between(part.low.z, part.high.z, ray.origin.z, ray.direction.z);
  return enters <= leaves;
}

// The light of a ray that hits nothing: from white to blue, by the height of its direction.
Color sky(const Vec& direction) {
  const double blue = 0.5 + 0.5 * direction.y;
  return {1 - 0.5 * blue, 1 - 0.3 * blue, 1};
}

// A hit of a ray on a surface.
struct Hit {
  double t = infinity;  // the distance along the ray
  Point point;
  Vec normal;  // the direction at a right angle to the surface there, of length 1
  const Object* object = nullptr;
};

// Looks for a closer hit of the ray in a part of the tree. A box that the ray does not meet is left out, with
// all that is in it.
void find_closest(const Ray& ray, const Part& part, Hit& closest) {
  if (!meets(ray, part, closest.t)) return;
  for (const Part& half : part.halves) find_closest(ray, half, closest);
  if (!part.halves.empty()) return;
  const Object& object = objects[part.first];
  for (const Crossing& crossing : object.surface(ray))
    if (0 < crossing.t && crossing.t < closest.t)
      closest = {crossing.t, point_at(ray, crossing.t), normalize(crossing.normal), &object};
}

// The closest hit of the ray. If it hits nothing, t stays infinity.
Hit closest_hit(const Ray& ray) {
  Hit closest;
  find_closest(ray, all, closest);
  return closest;
}

// The normal on the side from which the ray comes.
Vec facing(const Vec& normal, const Ray& ray) {
  return dot(normal, ray.direction) <= 0 ? normal : -1 * normal;
}

// A ray that goes on from a hit starts this far from the surface. It starts at a rounded point, which may lie
// on the wrong side of the surface; without the offset, the ray may hit that surface again. The offset has a
// price: it skips all that is thinner, and it is too small for a scene of large numbers. No single number is
// right, and the library has none.
const double epsilon = 1e-4;

// A number between 0 and 1 that looks random. It is another one for each pixel, each sample i and each which,
// and for these it is always the same one: the whole numbers are stirred until no order is left.
double random_number(int x, int y, int i, int which) {
  std::uint32_t stirred = 1;
  for (const int number : {x, y, i, which}) {
    stirred = (stirred ^ static_cast<std::uint32_t>(number)) * 0x9e3779b1;
    stirred = (stirred ^ stirred >> 15) * 0x85ebca77;
    stirred = stirred ^ stirred >> 13;
  }
  return (stirred + 0.5) / 4294967296;  // 2^32
}

// A sample: ray i of the pixel (x, y), and the random numbers of that ray.
struct Sample {
  int x, y, i;

  double number(int which) const { return random_number(x, y, i, which); }
};

// The direction at an angle of this cosine from the axis, after a part of a turn around it.
Vec direction_around(const Vec& axis, double cosine, double turn) {
  const double sine = std::sqrt(1 - cosine * cosine), angle = 2 * std::numbers::pi * turn;
  const Vec other = std::abs(axis.x) < 0.5 ? Vec{1, 0, 0} : Vec{0, 1, 0};
  const Vec a = normalize(cross(axis, other)), b = cross(axis, a);
  return sine * std::cos(angle) * a + sine * std::sin(angle) * b + cosine * axis;
}

// A direction out of a surface, for two numbers between 0 and 1. It is the more likely, the larger its cosine
// is.
Vec direction_out(const Vec& normal, double u, double v) {
  return direction_around(normal, std::sqrt(1 - u), v);
}

// The share of light that glass mirrors (Fresnel), by the cosines before and behind its surface. The sine
// behind it is ratio times that before it.
double mirrored_share(double before, double behind, double ratio) {
  const double s = (ratio * before - behind) / (ratio * before + behind);
  const double p = (before - ratio * behind) / (before + ratio * behind);
  return (s * s + p * p) / 2;
}

// The ray that goes on from glass: it is mirrored or bent, by chance, each as often as light is.
Ray through_glass(const Hit& hit, const Ray& ray, double number) {
  const Vec normal = facing(hit.normal, ray);
  const double ratio = dot(hit.normal, ray.direction) <= 0 ? 1 / 1.5 : 1.5;
  const double before = -dot(normal, ray.direction);
  const double square = 1 - ratio * ratio * (1 - before * before);  // of the cosine behind the surface
  if (square <= 0 || number < mirrored_share(before, std::sqrt(square), ratio))
    return {hit.point + epsilon * normal, ray.direction + 2 * before * normal};
  return {hit.point - epsilon * normal,
          ratio * (ray.direction + before * normal) - std::sqrt(square) * normal};
}

// The ray that goes on from metal: the mirrored direction, moved by fuzz in any direction.
Ray off_metal(const Hit& hit, const Ray& ray, double u, double v) {
  const Vec normal = facing(hit.normal, ray);
  const Vec mirrored = ray.direction - 2 * dot(normal, ray.direction) * normal;
  const Vec anywhere = direction_around(normal, 1 - 2 * u, v);
  return {hit.point + epsilon * normal, normalize(mirrored + hit.object->fuzz * anywhere)};
}

// Paths end by chance after this number of bounces, and not before.
const int sure_bounces = 3;

// No path goes on longer. In glass, light may be mirrored for long.
const int most_bounces = 100;

// The light along a ray, as one path finds it. It goes on from surface to surface in directions drawn by
// chance, until it leads into the sky. The weight is the share of the sky's light that comes to the eye.
Color path(Ray ray, const Sample& sample) {
  Color weight{1, 1, 1};
  int which = 4;
  for (int bounce = 0; bounce <= most_bounces; ++bounce) {
    const Hit hit = closest_hit(ray);
    if (hit.t == infinity) return weight * sky(ray.direction);
    if (hit.object->kind == Kind::glass) {
      ray = through_glass(hit, ray, sample.number(which++));
      continue;
    }
    const Vec normal = facing(hit.normal, ray);
    weight = weight * hit.object->color;
    if (bounce >= sure_bounces) {  // Russian roulette
      const double survival = std::min(1.0, std::max({weight.x, weight.y, weight.z}));
      if (sample.number(which++) >= survival) return {};
      weight = 1 / survival * weight;
    }
    const double u = sample.number(which++), v = sample.number(which++);
    if (hit.object->kind == Kind::metal) {
      ray = off_metal(hit, ray, u, v);
      if (dot(normal, ray.direction) <= 0) return {};  // the direction leads into the metal
    } else {
      ray = {hit.point + epsilon * normal, direction_out(normal, u, v)};
    }
  }
  return {};
}

// A place in a pixel: x goes from 0 at its left edge to 1 at its right edge, and y from 0 at its upper edge
// to 1 at its lower edge.
struct Place {
  double x, y;
};

// Four functions that choose n places in the pixel (x, y).
using Places = std::vector<Place>;

// A grid: n places in rows, as many in a row as there are rows. This needs a square number n.
Places grid(int n, int, int) {
  const int side = static_cast<int>(std::lround(std::sqrt(n)));
  Places places;
  for (int i = 0; i < n; ++i) places.push_back({(i % side + 0.5) / side, (i / side + 0.5) / side});
  return places;
}

// Random places, which know nothing of each other.
Places independent(int n, int x, int y) {
  Places places;
  for (int i = 0; i < n; ++i) places.push_back({random_number(x, y, i, 0), random_number(x, y, i, 1)});
  return places;
}

// A random place in each cell of the grid.
Places jittered(int n, int x, int y) {
  const int side = static_cast<int>(std::lround(std::sqrt(n)));
  Places places;
  for (int i = 0; i < n; ++i)
    places.push_back(
        {(i % side + random_number(x, y, i, 0)) / side, (i / side + random_number(x, y, i, 1)) / side});
  return places;
}

// The binary digits of i, read backwards and behind the point: 0, .1, .01, .11, .001, .101, ...
double reversed(int i) {
  double value = 0;
  for (double digit = 0.5; i > 0; i /= 2, digit /= 2) value += i % 2 * digit;
  return value;
}

// Hammersley's places: n columns and n rows, and one place in each of them.
Places hammersley(int n, int, int) {
  Places places;
  for (int i = 0; i < n; ++i) places.push_back({(i + 0.5) / n, reversed(i) + 0.5 / n});
  return places;
}

// The number of rays through each pixel, and how their places are chosen.
const int samples = 8;
const auto places_in = hammersley;

// The ray that starts at a place of the lens and meets the ray from the eye where that is in focus. Equal
// parts of the lens are equally likely.
Ray through_lens(const Ray& ray, double u, double v) {
  const Point sharp = point_at(ray, focus / dot(ray.direction, forward));
  const double radius = aperture * std::sqrt(u), angle = 2 * std::numbers::pi * v;
  const Point start = eye + radius * std::cos(angle) * right + radius * std::sin(angle) * up;
  return {start, normalize(sharp - start)};
}

// The mean light of a pixel.
Color mean(const Image& image, int x, int y) {
  Color sum;
  int i = 0;
  for (const Place& place : places_in(samples, x, y)) {
    const Sample sample{x, y, i++};
    const Ray ray = camera_ray(image, x + place.x, y + place.y);
    sum = sum + path(through_lens(ray, sample.number(2), sample.number(3)), sample);
  }
  return 1.0 / samples * sum;
}

int main() {
  Image image{640, 480};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) image.at(x, y) = mean(image, x, y);
  save(image);
}
