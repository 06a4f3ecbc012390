// The plain ray tracer, step 30: spheres that are found without an equation, by steps along the ray.
//
// g++ -O2 -std=c++20 30_fixed_step.cpp -o 30_fixed_step && ./30_fixed_step
//
// writes the picture to out.ppm. The page docs/stages/30_fixed_step.md explains the step.
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

// The ray from the eye, at (0, 0, 0), through the middle of a pixel of the picture, which stands at z = 1.
// There v is 1 at the upper edge of the picture and -1 at the lower edge, and u is 0 in the middle.
Ray camera_ray(const Image& image, int x, int y) {
  const double u = (2 * (x + 0.5) - image.width) / image.height;
  const double v = (image.height - 2 * (y + 0.5)) / image.height;
  return {{0, 0, 0}, normalize({u, v, 1})};
}

// The t of a ray that hits nothing.
const double infinity = std::numeric_limits<double>::infinity();

// A sphere: the points p with |p - center| = radius.
struct Sphere {
  Point center;
  double radius;
  Color color;
};

const std::vector<Sphere> spheres{
    {{0, 0, 3}, 1, {1, 0.3, 0}},             // in the middle
    {{-1.5, 0, 5}, 1, {0.2, 0.7, 0.1}},      // to the left, behind the first
    {{0, -1001, 3}, 1000, {0.2, 0.4, 0.8}},  // the ground, large enough to look flat
};

// A light: a point that sends its power, in watts, alike in all directions.
struct Light {
  Point position;
  double power;
};

const std::vector<Light> lights{{{0, 3, 0}, 40 * std::numbers::pi}};

// The distance from a point to a sphere: greater than 0 outside, 0 on the sphere, less than 0 inside.
double distance(const Sphere& sphere, const Point& p) { return length(p - sphere.center) - sphere.radius; }

// The sphere that is nearest to a point.
const Sphere& nearest(const Point& p) {
  const auto is_nearer = [&](const Sphere& a, const Sphere& b) { return distance(a, p) < distance(b, p); };
  return *std::min_element(spheres.begin(), spheres.end(), is_nearer);
}

// The distance field of the scene: for each point, the distance to the nearest surface.
double field(const Point& p) { return distance(nearest(p), p); }

// The direction in which the field grows fastest, from its differences over a short way in x, y and z.
Vec normal_at(const Point& p) {
  const double h = 1e-4;
  const Vec x{h, 0, 0}, y{0, h, 0}, z{0, 0, h};
  return normalize({field(p + x) - field(p - x), field(p + y) - field(p - y), field(p + z) - field(p - z)});
}

// How long a step is, and where a ray ends.
const double epsilon = 0.25;
const double far = 50;

// Steps along the ray until a point is not outside any more. Returns its t, or infinity if there is none.
double march(const Ray& ray) {
  for (double t = epsilon; t < far; t += epsilon)
    if (field(ray.origin + t * ray.direction) <= 0) return t;
  return infinity;
}

// A hit of a ray on a surface.
struct Hit {
  double t = infinity;  // the distance along the ray
  Point point;
  Vec normal;  // the direction at a right angle to the surface there, of length 1
  Color color;
};

// The closest hit of the ray. If it hits nothing, t stays infinity.
Hit closest_hit(const Ray& ray) {
  const double t = march(ray);
  if (t == infinity) return {};
  const Point point = ray.origin + t * ray.direction;
  return {t, point, normal_at(point), nearest(point).color};
}

// The normal on the side from which the ray comes.
Vec facing(const Vec& normal, const Ray& ray) {
  return dot(normal, ray.direction) <= 0 ? normal : -1 * normal;
}

// Step 03: white where the ray hits something.
Color binary(const Ray& ray) { return closest_hit(ray).t < infinity ? white : black; }

// Step 04: the nearer, the lighter; 1 / infinity is 0, black.
Color depth(const Ray& ray) { return 1 / closest_hit(ray).t * white; }

// Step 05: the normal's x, y and z, from -1 to 1, as red, green and blue from 0 to 1.
Color normals(const Ray& ray) {
  const Hit hit = closest_hit(ray);
  return hit.t < infinity ? 0.5 * hit.normal + 0.5 * white : black;
}

// Step 06: the color of the surface.
Color flat(const Ray& ray) {
  const Hit hit = closest_hit(ray);
  return hit.t < infinity ? hit.color : black;
}

// Step 07: the light that a matte surface sends on.
// A lamp of power P brings P / (4π distance²) to a surface that faces it, and less by the cosine of the angle
// to one that is tilted.
Color diffuse(const Ray& ray) {
  const Hit hit = closest_hit(ray);
  if (hit.t == infinity) return black;
  const Vec normal = facing(hit.normal, ray);
  Color sum = black;
  for (const Light& light : lights) {
    const Vec to_light = light.position - hit.point;
    const double distance = length(to_light), cosine = dot(normal, to_light) / distance;
    if (cosine <= 0) continue;  // the light is behind the surface
    sum = sum + light.power * cosine / (4 * std::numbers::pi * distance * distance) * hit.color;
  }
  return sum;
}

int main() {
  Image image{640, 480};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = camera_ray(image, x, y);
      image.at(x, y) = diffuse(ray);
    }
  save(image);
}
