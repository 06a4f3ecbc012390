// The plain ray tracer, step 16: a sky with a sun, which depends on the direction. It begins with step 13.
//
// g++ -O2 -std=c++20 16_environment.cpp -o 16_environment && ./16_environment
//
// writes the picture to out.ppm. The page docs/stages/16_environment.md explains the step.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <vector>

// Three numbers: a point, a direction, or the red, green and blue light of a color.
struct Vec {
  double x = 0, y = 0, z = 0;
};

using Color = Vec;
using Point = Vec;

const Color black{0, 0, 0}, white{1, 1, 1};

Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
Vec operator*(const Vec& a, const Vec& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

// The dot product: |a| |b| times the cosine of the angle between a and b. dot(a, a) is |a|².
double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double length(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec normalize(const Vec& a) { return 1 / length(a) * a; }

// A picture: the light of each pixel, row by row from the top, each row from the left.
struct Image {
  int width, height;
  std::vector<Color> pixels = std::vector<Color>(width * height);

  Color& at(int x, int y) { return pixels[y * width + x]; }
};

// Turns light, from 0 for black to 1 for white, into the nearest whole number from 0 to 255.
int code(double light) { return static_cast<int>(255 * std::clamp(light, 0.0, 1.0) + 0.5); }

// Saves the picture as a PPM file, which is a text: "P3", the size, the largest number, then all pixels.
// A pixel with a channel above 1 is too bright for the file. Divided by that channel, it keeps its hue.
void save(const Image& image) {
  std::ofstream file("out.ppm");
  file << "P3\n" << image.width << ' ' << image.height << "\n255\n";
  for (const Color& c : image.pixels) {
    const double most = std::max({c.x, c.y, c.z, 1.0});
    file << code(c.x / most) << ' ' << code(c.y / most) << ' ' << code(c.z / most) << '\n';
  }
}

// A ray: the points origin + t · direction with t > 0. The direction has length 1, so t is the distance.
struct Ray {
  Point origin;
  Vec direction;
};

// The ray from the eye, at (0, 0, 0), through the middle of a pixel of the picture, which stands at z = 1.
// The eye sees the height of the picture under an angle of 1.05 radians, about 60 degrees.
Ray camera_ray(const Image& image, int x, int y) {
  const double half = std::tan(1.05 / 2);
  const double u = (2 * (x + 0.5) - image.width) / image.height;
  const double v = (image.height - 2 * (y + 0.5)) / image.height;
  return {{0, 0, 0}, normalize({u * half, v * half, 1})};
}

// The t of a ray that hits nothing.
const double infinity = std::numeric_limits<double>::infinity();

// How a surface looks.
struct Material {
  Color diffuse;                       // the color that it has in all directions
  double specular = 0, shininess = 0;  // how bright and how sharp its highlights are
  double reflect = 0;                  // the share of light that it reflects as a mirror does
  double refract = 0;                  // the share of light that it lets through as glass does
};

const Material ivory{{0.36, 0.36, 0.27}, 0.5, 50, 0.1};
const Material red_rubber{{0.42, 0.14, 0.14}, 0.3, 10};
const Material glass{black, 0.9, 125, 0.1, 0.8};
const Material mirror{black, 16, 1425, 0.8};

// A sphere: the points p with |p - center| = radius.
struct Sphere {
  Point center;
  double radius;
  Material material;
};

const std::vector<Sphere> spheres{
    {{-3, 0, 16}, 2, ivory},
    {{-1, -1.5, 12}, 2, glass},
    {{1.5, -0.5, 18}, 3, red_rubber},
    {{7, 5, 18}, 4, mirror},
};

// A light: a point that brings the same light to every distance.
struct Light {
  Point position;
  double intensity;
};

const std::vector<Light> lights{{{-20, 20, -20}, 1}, {{30, 50, 25}, 1}, {{30, 20, -30}, 1}};

// The light of a ray that hits nothing, by its direction: u goes from 0 to 1 around the horizon, v from 0
// above to 1 below.
Color sky(const Vec& direction) {
  const double u = 0.5 + std::atan2(direction.x, direction.z) / (2 * std::numbers::pi);
  const double v = std::acos(std::clamp(direction.y, -1.0, 1.0)) / std::numbers::pi;

  if (v > 0.5) {  // fields, brighter towards the horizon
    const double far = 2 * (1 - v);
    return far * far * Color{0.26, 0.2, 0.09} + Color{0.14, 0.11, 0.06};
  }
  const double x = 2 * (u - 0.625), y = v - 0.41, far = x * x + y * y;  // from the sun, squared
  if (far < 0.0006) return {60, 40, 18};                                // sixty times as bright as white
  const double near = std::max(1 - far / 0.04, 0.0), glow = 0.5 * near * near * near;
  const double height = 1 - 2 * v, low = (1 - height) * (1 - height);
  const Color air = Color{0.1, 0.2, 0.45} + low * Color{0.75, 0.3, -0.15} + glow * Color{1, 0.7, 0.4};

  // Hills, in haze: their outline is 0.003 high.
  const auto zigzag = [](double t) { return std::abs(2 * (t - std::floor(t)) - 1); };
  const double above = v - (0.47 + 0.02 * zigzag(5 * u) - 0.01 * zigzag(13 * u));
  const double hill = std::clamp(above / 0.003, 0.0, 1.0);
  return (1 - hill) * air + hill * Color{0.12, 0.12, 0.17};
}

// The smallest t > 0 at which the ray hits the sphere, or infinity. The point o + t d is on the sphere if
// |o + t d - center|² = radius². With v = o - center, this is the equation a t² + b t + c = 0.
double intersect(const Sphere& sphere, const Ray& ray) {
  const Vec v = ray.origin - sphere.center;
  const double a = dot(ray.direction, ray.direction);
  const double b = 2 * dot(ray.direction, v);
  const double c = dot(v, v) - sphere.radius * sphere.radius;

  const double D = b * b - 4 * a * c;
  if (D < 0) return infinity;                       // no solution: the ray misses
  const double t1 = (-b - std::sqrt(D)) / (2 * a);  // the ray enters the sphere
  const double t2 = (-b + std::sqrt(D)) / (2 * a);  // the ray leaves the sphere
  return t1 > 0 ? t1 : t2 > 0 ? t2 : infinity;      // the first one that is ahead
}

// A hit of a ray on a surface.
struct Hit {
  double t = infinity;  // the distance along the ray
  Point point;
  Vec normal;  // the direction at a right angle to the surface there, of length 1
  Material material;
};

// The closest hit of the ray. If it hits nothing, t stays infinity.
Hit closest_hit(const Ray& ray) {
  Hit closest;
  for (const Sphere& sphere : spheres) {
    const double t = intersect(sphere, ray);
    if (t < closest.t) {
      const Point point = ray.origin + t * ray.direction;
      closest = {t, point, 1 / sphere.radius * (point - sphere.center), sphere.material};
    }
  }

  // The board: the points with y = -4, |x| < 10 and 10 < z < 30, in squares of side 2. The sum of the numbers
  // of a square's column and row is even for one color, and odd for the other.
  const double t = (-4 - ray.origin.y) / ray.direction.y;
  const Point point = ray.origin + t * ray.direction;
  if (0 < t && t < closest.t && std::abs(point.x) < 10 && 10 < point.z && point.z < 30) {
    const int square = static_cast<int>(std::floor(point.x / 2) + std::floor(point.z / 2));
    const Color color = square % 2 == 0 ? Color{0.6, 0.4, 0.2} : Color{0.6, 0.6, 0.6};
    closest = {t, point, {0, 1, 0}, {color, 0, 1}};
  }
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

// Returns true if something is between two points: a hit that is closer than the second point.
bool occluded(const Point& from, const Point& to) {
  return closest_hit({from, normalize(to - from)}).t < length(to - from);
}

// The light along the ray. From each lamp, the surface sends light on in all directions, in its color, and
// more of it where a mirror would send it: this is a highlight. Phong's formula for it is a power of the
// cosine of the angle between the direction to the lamp and the mirrored ray.
// A mirror adds the light along the mirrored ray. The number of rays in a path is limited, as two mirrors
// would never end.
// Glass adds the light along the bent ray.
Color radiance(const Ray& ray, int rays) {
  if (rays == 0) return sky(ray.direction);
  const Hit hit = closest_hit(ray);
  if (hit.t == infinity) return sky(ray.direction);
  const Vec normal = facing(hit.normal, ray);
  const Vec mirrored = ray.direction - 2 * dot(ray.direction, normal) * normal;
  Color sum = black;
  for (const Light& light : lights) {
    const Vec to_light = light.position - hit.point;
    const double distance = length(to_light), cosine = dot(normal, to_light) / distance;
    if (cosine <= 0) continue;  // the light is behind the surface
    if (occluded(hit.point + epsilon * normal, light.position)) continue;
    const double shine = std::max(0.0, dot(mirrored, to_light) / distance);
    const double highlight = hit.material.specular * std::pow(shine, hit.material.shininess);
    sum = sum + light.intensity * (cosine * hit.material.diffuse + highlight * white);
  }
  if (hit.material.reflect > 0)
    sum = sum + hit.material.reflect * radiance({hit.point + epsilon * normal, mirrored}, rays - 1);
  if (hit.material.refract > 0) {
    // Snell's law: the sine of the angle to the normal becomes ratio times as large. Light is 1.5 times as
    // slow in glass as in air.
    const double ratio = dot(hit.normal, ray.direction) <= 0 ? 1 / 1.5 : 1.5;
    const double cosine = -dot(normal, ray.direction);
    const double square = 1 - ratio * ratio * (1 - cosine * cosine);  // square of the cosine behind it
    if (square >= 0) {  // otherwise there is no such angle, and no light comes through
      const Vec bent = ratio * (ray.direction + cosine * normal) - std::sqrt(square) * normal;
      sum = sum + hit.material.refract * radiance({hit.point - epsilon * normal, bent}, rays - 1);
    }
  }
  return sum;
}

int main() {
  Image image{1024, 768};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = camera_ray(image, x, y);
      image.at(x, y) = radiance(ray, 5);
    }
  save(image);
}
