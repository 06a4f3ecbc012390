// The plain ray tracer, step 27: a normal map. It begins with step 10.
//
// g++ -O2 -std=c++20 27_normal_map.cpp -o 27_normal_map && ./27_normal_map
//
// writes the picture to out.ppm. The page docs/stages/27_normal_map.md explains the step.
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

// The cross product: a vector at right angles to a and b.
Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
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

// A normal map: at the place (u, v) of a surface it holds the normal as it would be on flat ground, with x in
// the direction in which u grows, y in the direction in which v grows, and z upwards. This one has waves: so
// many around the sphere, so many from top to bottom, and so steep.
struct NormalMap {
  double around = 0, down = 0, slope = 0;

  Vec at(double u, double v) const {
    const double turn = 2 * std::numbers::pi;
    return {slope * std::sin(turn * around * u), slope * std::sin(turn * down * v), 1};
  }
};

// How a surface looks.
struct Material {
  Color diffuse;                       // the color that it has in all directions
  double specular = 0, shininess = 0;  // how bright and how sharp its highlights are
  NormalMap normal_map;
};

const Material ivory{{0.36, 0.36, 0.27}, 0.5, 50, {24, 12, 0.5}};
const Material red_rubber{{0.42, 0.14, 0.14}, 0.3, 10, {0, 12, 0.5}};

// A sphere: the points p with |p - center| = radius.
struct Sphere {
  Point center;
  double radius;
  Material material;
};

const std::vector<Sphere> spheres{
    {{-3, 0, 16}, 2, ivory},
    {{-1, -1.5, 12}, 2, red_rubber},
    {{1.5, -0.5, 18}, 3, red_rubber},
    {{7, 5, 18}, 4, ivory},
};

// A light: a point that brings the same light to every distance.
struct Light {
  Point position;
  double intensity;
};

const std::vector<Light> lights{{{-20, 20, -20}, 1}, {{30, 50, 25}, 1}, {{30, 20, -30}, 1}};

// The light of a ray that hits nothing. 255 times 0.7 is 178.5, in the middle between two numbers of the
// file; as a float, as the library has it, 0.7 is a little less.
const Color sky{0.2, 0.7f, 0.8};

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
  Vec normal;          // the direction at a right angle to the surface there, of length 1
  Vec shading_normal;  // the same, tilted by the normal map
  Material material;
};

// The normal n of a sphere, tilted by a normal map. The direction of n is longitude u and latitude v, as on a
// map of the earth. To the east u grows, and to the south v. East, south and n are at right angles to each
// other, as x, y and z are on flat ground.
Vec tilted(const NormalMap& map, const Vec& n) {
  const double u = 0.5 + std::atan2(n.x, n.z) / (2 * std::numbers::pi);
  const double v = std::acos(std::clamp(n.y, -1.0, 1.0)) / std::numbers::pi;
  const Vec flat = map.at(u, v);
  if (n.x == 0 && n.z == 0) return n;  // at a pole there is no east
  const Vec east = normalize({n.z, 0, -n.x}), south = cross(east, n);
  return normalize(flat.x * east + flat.y * south + flat.z * n);
}

// The closest hit of the ray. If it hits nothing, t stays infinity.
Hit closest_hit(const Ray& ray) {
  Hit closest;
  for (const Sphere& sphere : spheres) {
    const double t = intersect(sphere, ray);
    if (t < closest.t) {
      const Point point = ray.origin + t * ray.direction;
      const Vec normal = 1 / sphere.radius * (point - sphere.center);
      closest = {t, point, normal, tilted(sphere.material.normal_map, normal), sphere.material};
    }
  }
  return closest;
}

// Returns 1 if the ray comes from the side of the normal, and -1 if it comes from the other side. The surface
// has its sides by its own normal, whatever the map says.
double side(const Hit& hit, const Ray& ray) { return dot(hit.normal, ray.direction) <= 0 ? 1 : -1; }

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
Color radiance(const Ray& ray) {
  const Hit hit = closest_hit(ray);
  if (hit.t == infinity) return sky;
  const Vec surface = side(hit, ray) * hit.normal, normal = side(hit, ray) * hit.shading_normal;
  const Vec mirrored = ray.direction - 2 * dot(ray.direction, normal) * normal;
  Color sum = black;
  for (const Light& light : lights) {
    const Vec to_light = light.position - hit.point;
    const double distance = length(to_light), cosine = dot(normal, to_light) / distance;
    if (dot(surface, to_light) <= 0) continue;  // the light is behind the surface
    if (cosine <= 0) continue;                  // it is behind the wave
    if (occluded(hit.point + epsilon * surface, light.position)) continue;
    const double shine = std::max(0.0, dot(mirrored, to_light) / distance);
    const double highlight = hit.material.specular * std::pow(shine, hit.material.shininess);
    sum = sum + light.intensity * (cosine * hit.material.diffuse + highlight * white);
  }
  return sum;
}

int main() {
  Image image{1024, 768};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = camera_ray(image, x, y);
      image.at(x, y) = radiance(ray);
    }
  save(image);
}
