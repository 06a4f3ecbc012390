// The plain ray tracer, step 37: shadows, without an offset.
//
// g++ -O2 -std=c++20 37_marched_shadow.cpp -o 37_marched_shadow && ./37_marched_shadow
//
// writes the picture to out.ppm. The page docs/stages/37_marched_shadow.md explains the step.
#include <algorithm>
#include <cmath>
#include <cstdio>
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

// A light: a point that sends its power, in watts, alike in all directions.
struct Light {
  Point position;
  double power;
};

const std::vector<Light> lights{{{0, 2.5, 3}, 40 * std::numbers::pi}};

// An interval: all numbers from lo to hi. Each operation has a result that contains those of all numbers of
// its operands.
struct Interval {
  double lo, hi;
};

// Makes an interval a little wider. Sums, products and roots of doubles are wrong by half of the last digit
// at most, less than 2^-52 of the result; the smallest number of all makes up for results that are nearly 0.
Interval widened(double lo, double hi) {
  const double share = 0x1p-52, tiny = std::numeric_limits<double>::denorm_min();
  return {lo - share * std::abs(lo) - tiny, hi + share * std::abs(hi) + tiny};
}

Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
Interval operator+(const Interval& a, const Interval& b) { return widened(a.lo + b.lo, a.hi + b.hi); }
Interval operator-(const Interval& a, const Interval& b) { return a + -b; }
Interval operator*(const Interval& a, const Interval& b) {
  const double w = a.lo * b.lo, x = a.lo * b.hi, y = a.hi * b.lo, z = a.hi * b.hi;
  return widened(std::min(std::min(w, x), std::min(y, z)), std::max(std::max(w, x), std::max(y, z)));
}
Interval square(const Interval& a) {
  const double near = a.lo > 0 ? a.lo : a.hi < 0 ? a.hi : 0, most = std::max(-a.lo, a.hi);
  return widened(near * near, most * most);
}
Interval sqrt(const Interval& a) {
  return widened(std::sqrt(std::max(a.lo, 0.0)), std::sqrt(std::max(a.hi, 0.0)));
}
Interval join(const Interval& a, const Interval& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }

// A number that changes along the ray, over an interval of t: all of its values, and all of its slopes, which
// are its derivatives by t. A constant has the slope 0.
struct Number {
  Interval value, slope{0, 0};

  Number(const Interval& v, const Interval& s) : value(v), slope(s) {}
  Number(double constant) : value{constant, constant} {}
};

Number operator+(const Number& a, const Number& b) { return {a.value + b.value, a.slope + b.slope}; }
Number operator-(const Number& a, const Number& b) { return {a.value - b.value, a.slope - b.slope}; }
Number operator-(const Number& a) { return {-a.value, -a.slope}; }
Number operator*(double s, const Number& a) { return {Interval{s, s} * a.value, Interval{s, s} * a.slope}; }

// The smaller number has its own slope where it is surely smaller, and otherwise one of both.
Number min(const Number& a, const Number& b) {
  if (a.value.hi < b.value.lo) return a;
  if (b.value.hi < a.value.lo) return b;
  return {{std::min(a.value.lo, b.value.lo), std::min(a.value.hi, b.value.hi)}, join(a.slope, b.slope)};
}

Number max(const Number& a, const Number& b) { return -min(-a, -b); }
Number abs(const Number& a) { return max(a, -a); }

// The distance from the nearest multiple of a period, from 0 to half of the period: space is folded like
// paper, at the multiples and in the middle between them. Over several folds it may have all of them.
Number folded(const Number& a, double period) {
  const double half = period / 2;
  const Number offset = a - std::round(a.value.lo / period) * period;
  if (offset.value.lo >= -period && offset.value.hi <= period) return half - abs(abs(offset) - half);
  const double most = std::max(-a.slope.lo, a.slope.hi);
  return {{0, half}, {-most, most}};
}

// A point whose coordinates are such numbers.
struct Place {
  Number x, y, z;
};

Place operator-(const Place& p, const Point& c) { return {p.x - c.x, p.y - c.y, p.z - c.z}; }

// The length √(x² + y² + z²) has the slope (x x' + y y' + z z') / length, and no length changes faster than
// its vector.
Number length(const Place& v) {
  const Interval value = sqrt(square(v.x.value) + square(v.y.value) + square(v.z.value));
  const Interval most = sqrt(square(v.x.slope) + square(v.y.slope) + square(v.z.slope));
  Interval slope{-most.hi, most.hi};
  if (value.lo > 0) {
    const Interval dot = v.x.value * v.x.slope + v.y.value * v.y.slope + v.z.value * v.z.slope;
    const Interval quotient = dot * widened(1 / value.hi, 1 / value.lo);
    slope = {std::max(slope.lo, quotient.lo), std::min(slope.hi, quotient.hi)};
  }
  return {value, slope};
}

// The points at most a radius away from a part of the y axis.
Number capsule(const Place& p, double radius, double height) {
  return length({p.x, max(abs(p.y) - height, 0), p.z}) - radius;
}

// The points at most a thickness away from a circle in the plane of x and z.
Number ring(const Place& p, double radius, double thickness) {
  const Number from_circle = length({p.x, 0, p.z}) - radius;
  return length({from_circle, p.y, 0}) - thickness;
}

// A surface of the scene.
struct Shape {
  Number (*field)(const Place&);
  Color color;
};

// Rows on both sides of the eye, 3 apart. One shape in the folded space stands for all of its copies.
Place in_rows(const Place& p) { return {folded(p.x - 1.5, 3), p.y, folded(p.z - 1.5, 3)}; }

const std::vector<Shape> shapes{
    {[](const Place& p) { return p.y + 1; }, {0.2, 0.4, 0.8}},  // the ground
    {[](const Place& p) { return capsule(in_rows(p), 0.3, 1.2); }, {1, 0.3, 0}},
    {[](const Place& p) { return ring(in_rows(p), 0.5, 0.14); }, {0.2, 0.7, 0.1}},
};

// The field of the scene: for each point, that of the nearest surface.
Number field(const Place& p) {
  Number result = infinity;
  for (const Shape& shape : shapes) result = min(result, shape.field(p));
  return result;
}

// The field along the ray from t = lo to t = hi: an interval with all of its values, and one with all slopes.
Number along(const Ray& ray, double lo, double hi) {
  const auto coordinate = [&](double o, double d) {
    return Number(Interval{o, o} + Interval{lo, hi} * Interval{d, d}, {d, d});
  };
  return field({coordinate(ray.origin.x, ray.direction.x), coordinate(ray.origin.y, ray.direction.y),
                coordinate(ray.origin.z, ray.direction.z)});
}

// The direction in which the field grows fastest: its slopes along x, y and z.
Vec normal_at(const Point& p) {
  const auto slope = [&](const Vec& axis) {
    const Interval all = along({p, axis}, 0, 0).slope;
    return (all.lo + all.hi) / 2;
  };
  return normalize({slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})});
}

// The surface that is nearest to a point.
const Shape& nearest(const Point& p) {
  const Place place{p.x, p.y, p.z};
  const auto is_nearer = [&](const Shape& a, const Shape& b) {
    return a.field(place).value.lo < b.field(place).value.lo;
  };
  return *std::min_element(shapes.begin(), shapes.end(), is_nearer);
}

// The t at which a ray ends.
const double far = 60;

// Returns true if there surely is no surface from t = lo to t = hi. The field is known at both ends, and from
// there it changes by the way times one of its slopes: from the left end, and from the right end backwards.
bool is_free(const Ray& ray, double lo, double hi, const Number& over) {
  if (over.value.lo > 0) return true;
  const Interval way{0, widened(0, hi - lo).hi};
  if ((along(ray, lo, lo).value + way * over.slope).lo > 0) return true;
  return (along(ray, hi, hi).value - way * over.slope).lo > 0;
}

// Halves an interval of t in which the field falls from above 0 to below 0, as long as it surely tells on
// which side the middle lies. Returns the middle of what is left.
double halved(const Ray& ray, double lo, double hi) {
  for (;;) {
    const double middle = (lo + hi) / 2;
    const Interval there = along(ray, middle, middle).value;
    if (middle <= lo || middle >= hi || (there.lo <= 0 && there.hi >= 0)) return middle;
    (there.lo > 0 ? lo : hi) = middle;
  }
}

// How many rays could not be decided with the digits of a double.
int undecided = 0;

// Returns the first t between two others at which there is a surface, or infinity if there is none; the field
// is greater than 0 at the first. Either is proven: all that is passed over is free, and a hit is where the
// field surely falls from above 0 to below 0.
double march(const Ray& ray, double from, double to) {
  double t = from, step = 1;
  while (t < to) {
    const double next = t + step;
    const Number over = along(ray, t, next);
    if (is_free(ray, t, next, over)) {
      t = next;
      step = 2 * step;
    } else if (over.slope.hi <= 0 && along(ray, next, next).value.hi < 0) {
      const double hit = halved(ray, t, next);
      return hit < to ? hit : infinity;
    } else {
      step = step / 2;
      if (t + step == t) return ++undecided, t;  // no number is left between t and the next one
    }
  }
  return infinity;
}

// Returns a t > 0 until which a ray that leaves a surface surely does not meet it again: from 0 to that t,
// the field only grows.
double leave(const Ray& ray) {
  double t = 1;
  while (t > 0 && along(ray, 0, t).slope.lo <= 0) t = t / 2;
  return t;
}

// Returns true if something is between a point of a surface and another point in front of it.
bool occluded(const Point& from, const Point& to) {
  const Ray ray{from, normalize(to - from)};
  const double start = leave(ray), end = length(to - from);
  return start < end && march(ray, start, end) < end;
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
  const double t = march(ray, 0, far);
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

// Step 09: the light that a matte surface sends on.
// A lamp of power P brings P / (4π distance²) to a surface that faces it, and less by the cosine of the angle
// to one that is tilted.
// It brings nothing to a surface in the shadow of another.
Color shadow(const Ray& ray) {
  const Hit hit = closest_hit(ray);
  if (hit.t == infinity) return black;
  const Vec normal = facing(hit.normal, ray);
  Color sum = black;
  for (const Light& light : lights) {
    const Vec to_light = light.position - hit.point;
    const double distance = length(to_light), cosine = dot(normal, to_light) / distance;
    if (cosine <= 0) continue;  // the light is behind the surface
    if (occluded(hit.point, light.position)) continue;
    sum = sum + light.power * cosine / (4 * std::numbers::pi * distance * distance) * hit.color;
  }
  return sum;
}

int main() {
  Image image{640, 480};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Ray ray = camera_ray(image, x, y);
      image.at(x, y) = shadow(ray);
    }
  save(image);
  std::printf("%d rays undecided\n", undecided);
}
