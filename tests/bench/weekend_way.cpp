#include "weekend_way.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace weekend_way {

namespace {

constexpr double pi = std::numbers::pi, offset = 0.001;

std::uint64_t random_state = 1;

vec3 random_vector(double least, double most) {
  const auto number = [&] { return least + (most - least) * random_double(); };
  const double x = number(), y = number(), z = number();
  return {x, y, z};
}

vec3 random_unit_vector() {
  while (true) {
    const vec3 p = random_vector(-1, 1);
    const double square = dot(p, p);
    if (1e-160 < square && square <= 1) return p / std::sqrt(square);
  }
}

bool near_zero(const vec3& v) { return std::abs(v.x) < 1e-8 && std::abs(v.y) < 1e-8 && std::abs(v.z) < 1e-8; }

vec3 reflected(const vec3& v, const vec3& n) { return v - 2 * dot(v, n) * n; }

/// Axes of which the third leads along a direction.
struct Onb {
  explicit Onb(const vec3& n) : w(normalize(n)) {
    const vec3 a = std::abs(w.x) > 0.9 ? vec3{0, 1, 0} : vec3{1, 0, 0};
    v = normalize(cross(w, a));
    u = cross(w, v);
  }
  [[nodiscard]] vec3 transform(const vec3& a) const { return a.x * u + a.y * v + a.z * w; }
  vec3 u, v, w;
};

// Densities of directions ("The Rest of Your Life").

class Pdf {
 public:
  virtual ~Pdf() = default;
  [[nodiscard]] virtual double value(const vec3& direction) const = 0;
  [[nodiscard]] virtual vec3 generate() const = 0;
};

class CosinePdf final : public Pdf {
 public:
  explicit CosinePdf(const vec3& w) : axes_(w) {}
  [[nodiscard]] double value(const vec3& direction) const override {
    return std::max(0.0, dot(normalize(direction), axes_.w) / pi);
  }
  [[nodiscard]] vec3 generate() const override {
    const double r1 = random_double(), r2 = random_double(), phi = 2 * pi * r1, r = std::sqrt(r2);
    return axes_.transform({std::cos(phi) * r, std::sin(phi) * r, std::sqrt(1 - r2)});
  }

 private:
  Onb axes_;
};

class HittablePdf final : public Pdf {
 public:
  HittablePdf(const Hittable& objects, const vec3& origin) : objects_(objects), origin_(origin) {}
  [[nodiscard]] double value(const vec3& direction) const override {
    return objects_.pdf_value(origin_, direction);
  }
  [[nodiscard]] vec3 generate() const override { return objects_.random(origin_); }

 private:
  const Hittable& objects_;
  vec3 origin_;
};

class MixturePdf final : public Pdf {
 public:
  MixturePdf(std::shared_ptr<Pdf> a, std::shared_ptr<Pdf> b) : p_{std::move(a), std::move(b)} {}
  [[nodiscard]] double value(const vec3& direction) const override {
    return 0.5 * p_[0]->value(direction) + 0.5 * p_[1]->value(direction);
  }
  [[nodiscard]] vec3 generate() const override { return p_[random_double() < 0.5 ? 0 : 1]->generate(); }

 private:
  std::array<std::shared_ptr<Pdf>, 2> p_;
};

}  // namespace

void seed_random(std::uint64_t seed) { random_state = 2 * seed + 1; }

double random_double() {
  random_state = random_state * 6364136223846793005u + 1442695040888963407u;
  return static_cast<double>(random_state >> 33) * 0x1p-31;
}

struct ScatterRecord {
  vec3 attenuation{0};
  Ray ray{};                 ///< the next one, if there is no pdf
  std::shared_ptr<Pdf> pdf;  ///< for worlds with lights
};

class Material {
 public:
  virtual ~Material() = default;
  [[nodiscard]] virtual vec3 emitted() const { return vec3{0}; }
  virtual bool scatter(const Ray&, const HitRecord&, bool, ScatterRecord&) const { return false; }
};

namespace {

class Lambertian final : public Material {
 public:
  explicit Lambertian(const vec3& albedo) : albedo_(albedo) {}
  bool scatter(const Ray&, const HitRecord& hit, bool has_lights, ScatterRecord& record) const override {
    record.attenuation = albedo_;
    if (has_lights) {
      record.pdf = std::make_shared<CosinePdf>(hit.normal);
    } else {
      vec3 direction = hit.normal + random_unit_vector();
      if (near_zero(direction)) direction = hit.normal;
      record.ray = {hit.p, direction};
    }
    return true;
  }

 private:
  vec3 albedo_;
};

class Metal final : public Material {
 public:
  Metal(const vec3& albedo, double fuzz) : albedo_(albedo), fuzz_(fuzz) {}
  bool scatter(const Ray& ray, const HitRecord& hit, bool, ScatterRecord& record) const override {
    const vec3 mirrored = normalize(reflected(ray.direction, hit.normal)) + fuzz_ * random_unit_vector();
    record.attenuation = albedo_;
    record.ray = {hit.p, mirrored};
    return dot(mirrored, hit.normal) > 0;
  }

 private:
  vec3 albedo_;
  double fuzz_;
};

class Dielectric final : public Material {
 public:
  explicit Dielectric(double index) : index_(index) {}
  bool scatter(const Ray& ray, const HitRecord& hit, bool, ScatterRecord& record) const override {
    const double ratio = hit.front_face ? 1 / index_ : index_;
    const vec3 unit = normalize(ray.direction);
    const double cosine = std::min(dot(-unit, hit.normal), 1.0), sine = std::sqrt(1 - cosine * cosine);
    record.attenuation = vec3{1};
    if (ratio * sine > 1 || reflectance(cosine, ratio) > random_double()) {
      record.ray = {hit.p, reflected(unit, hit.normal)};
    } else {
      const vec3 across = ratio * (unit + cosine * hit.normal);
      record.ray = {hit.p, across - std::sqrt(std::abs(1 - dot(across, across))) * hit.normal};
    }
    return true;
  }

 private:
  /// Schlick's approximation.
  static double reflectance(double cosine, double ratio) {
    const double r = (1 - ratio) / (1 + ratio), r0 = r * r;
    return r0 + (1 - r0) * std::pow(1 - cosine, 5);
  }
  double index_;
};

class DiffuseLight final : public Material {
 public:
  explicit DiffuseLight(const vec3& emission) : emission_(emission) {}
  [[nodiscard]] vec3 emitted() const override { return emission_; }

 private:
  vec3 emission_;
};

}  // namespace

std::shared_ptr<Material> lambertian(const vec3& albedo) { return std::make_shared<Lambertian>(albedo); }
std::shared_ptr<Material> metal(const vec3& albedo, double fuzz) {
  return std::make_shared<Metal>(albedo, fuzz);
}
std::shared_ptr<Material> dielectric(double index) { return std::make_shared<Dielectric>(index); }
std::shared_ptr<Material> diffuse_light(const vec3& emission) {
  return std::make_shared<DiffuseLight>(emission);
}

// ---- Hittables

bool Aabb::hit(const Ray& ray, double t_min, double t_max) const {
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1 / ray.direction[axis];
    const double t0 = (least[axis] - ray.origin[axis]) * inverse,
                 t1 = (most[axis] - ray.origin[axis]) * inverse;
    t_min = std::max(t_min, std::min(t0, t1));
    t_max = std::min(t_max, std::max(t0, t1));
    if (t_max <= t_min) return false;
  }
  return true;
}

void Aabb::include(const Aabb& other) {
  least = min(least, other.least);
  most = max(most, other.most);
}

bool Sphere::hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const {
  const vec3 oc = center_ - ray.origin;
  const double a = dot(ray.direction, ray.direction), h = dot(ray.direction, oc),
               c = dot(oc, oc) - radius_ * radius_, discriminant = h * h - a * c;
  if (discriminant < 0) return false;
  const double root = std::sqrt(discriminant);
  double t = (h - root) / a;
  if (t <= t_min || t_max <= t) {
    t = (h + root) / a;
    if (t <= t_min || t_max <= t) return false;
  }
  record.t = t;
  record.p = ray.at(t);
  record.set_face_normal(ray, (record.p - center_) / radius_);
  record.material = material_;
  return true;
}

double Sphere::pdf_value(const vec3& origin, const vec3& direction) const {
  HitRecord record;
  if (!hit({origin, direction}, offset, infinity, record)) return 0;
  const vec3 to = center_ - origin;
  return 1 / (2 * pi * (1 - std::sqrt(1 - radius_ * radius_ / dot(to, to))));
}

vec3 Sphere::random(const vec3& origin) const {
  const vec3 to = center_ - origin;
  const double r1 = random_double(), r2 = random_double(), phi = 2 * pi * r1,
               z = 1 + r2 * (std::sqrt(1 - radius_ * radius_ / dot(to, to)) - 1), r = std::sqrt(1 - z * z);
  return Onb(to).transform({std::cos(phi) * r, std::sin(phi) * r, z});
}

Quad::Quad(const vec3& q, const vec3& u, const vec3& v, std::shared_ptr<Material> material)
    : q_(q), u_(u), v_(v), material_(std::move(material)) {
  const vec3 n = cross(u, v);
  normal_ = normalize(n);
  d_ = dot(normal_, q);
  w_ = n / dot(n, n);
  area_ = length(n);
}

bool Quad::hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const {
  const double slope = dot(normal_, ray.direction);
  if (std::abs(slope) < 1e-8) return false;
  const double t = (d_ - dot(normal_, ray.origin)) / slope;
  if (t < t_min || t > t_max) return false;
  const vec3 p = ray.at(t), planar = p - q_;
  const double alpha = dot(w_, cross(planar, v_)), beta = dot(w_, cross(u_, planar));
  if (alpha < 0 || alpha > 1 || beta < 0 || beta > 1) return false;
  record.t = t;
  record.p = p;
  record.material = material_;
  record.set_face_normal(ray, normal_);
  return true;
}

Aabb Quad::bounding_box() const {
  Aabb box;
  for (const vec3& corner : {q_, q_ + u_, q_ + v_, q_ + u_ + v_})
    box.include({corner - 0.0001, corner + 0.0001});
  return box;
}

double Quad::pdf_value(const vec3& origin, const vec3& direction) const {
  HitRecord record;
  if (!hit({origin, direction}, offset, infinity, record)) return 0;
  const double square = record.t * record.t * dot(direction, direction);
  return square / (std::abs(dot(direction, record.normal) / length(direction)) * area_);
}

vec3 Quad::random(const vec3& origin) const {
  const double a = random_double(), b = random_double();
  return q_ + a * u_ + b * v_ - origin;
}

bool HittableList::hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const {
  HitRecord one;
  bool any = false;
  for (const auto& object : objects)
    if (object->hit(ray, t_min, t_max, one)) {
      any = true;
      t_max = one.t;
      record = one;
    }
  return any;
}

Aabb HittableList::bounding_box() const {
  Aabb box;
  for (const auto& object : objects) box.include(object->bounding_box());
  return box;
}

double HittableList::pdf_value(const vec3& origin, const vec3& direction) const {
  double sum = 0;
  for (const auto& object : objects) sum += object->pdf_value(origin, direction);
  return sum / static_cast<double>(objects.size());
}

vec3 HittableList::random(const vec3& origin) const {
  const auto count = static_cast<double>(objects.size());
  return objects[static_cast<std::size_t>(random_double() * count)]->random(origin);
}

BvhNode::BvhNode(std::vector<std::shared_ptr<Hittable>>& objects, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) box_.include(objects[i]->bounding_box());
  const vec3 size = box_.most - box_.least;
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  if (end - begin == 1) {
    left_ = right_ = objects[begin];
  } else if (end - begin == 2) {
    left_ = objects[begin], right_ = objects[begin + 1];
  } else {
    std::sort(objects.begin() + static_cast<std::ptrdiff_t>(begin),
              objects.begin() + static_cast<std::ptrdiff_t>(end), [axis](const auto& a, const auto& b) {
                return a->bounding_box().least[axis] < b->bounding_box().least[axis];
              });
    const std::size_t middle = begin + (end - begin) / 2;
    left_ = std::make_shared<BvhNode>(objects, begin, middle);
    right_ = std::make_shared<BvhNode>(objects, middle, end);
  }
}

bool BvhNode::hit(const Ray& ray, double t_min, double t_max, HitRecord& record) const {
  if (!box_.hit(ray, t_min, t_max)) return false;
  const bool hit_left = left_->hit(ray, t_min, t_max, record);
  const bool hit_right = right_->hit(ray, t_min, hit_left ? record.t : t_max, record);
  return hit_left || hit_right;
}

// ---- Pictures

std::uint64_t traced_rays = 0;

namespace {

vec3 ray_color(const Ray& ray, int depth, const World& world) {
  if (depth <= 0) return vec3{0};
  HitRecord hit;
  ++traced_rays;
  if (!world.objects->hit(ray, offset, infinity, hit)) {
    if (!world.has_sky) return vec3{0};
    const double a = 0.5 * (normalize(ray.direction).y + 1);
    return (1 - a) * vec3{1} + a * vec3{0.5, 0.7, 1};
  }
  const vec3 emitted = hit.material->emitted();
  ScatterRecord record;
  if (!hit.material->scatter(ray, hit, world.lights != nullptr, record)) return emitted;
  if (!record.pdf) return emitted + record.attenuation * ray_color(record.ray, depth - 1, world);

  const MixturePdf mixture(std::make_shared<HittablePdf>(*world.lights, hit.p), record.pdf);
  const Ray scattered{hit.p, mixture.generate()};
  const double density = mixture.value(scattered.direction);
  const double cosine = dot(hit.normal, normalize(scattered.direction));
  const double scattering = cosine < 0 ? 0 : cosine / pi;
  if (!(scattering > 0)) return emitted;
  return emitted + record.attenuation * scattering * ray_color(scattered, depth - 1, world) / density;
}

}  // namespace

std::vector<vec3> render(const World& world, const Camera& camera, int width, int height, int samples) {
  const double half = camera.focus * std::tan(camera.field_of_view / 2 * pi / 180);
  const vec3 w = normalize(camera.from - camera.at), u = normalize(cross(camera.up, w)), v = cross(w, u);
  const int side = static_cast<int>(std::lround(std::sqrt(samples)));
  std::vector<vec3> pixels;
  pixels.reserve(static_cast<std::size_t>(width * height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      vec3 sum{0};
      for (int i = 0; i < side * side; ++i) {
        // Books 1 and 2 draw a place in the pixel, and book 3 one in each cell of it.
        const int cells = world.lights ? side : 1;
        const double px = x + (i % side % cells + random_double()) / cells,
                     py = y + (i / side % cells + random_double()) / cells;
        vec3 origin = camera.from;
        const vec3 target = camera.from - camera.focus * w + half * (2 * px - width) / height * u +
                            half * (height - 2 * py) / height * v;
        if (camera.aperture > 0) {
          vec3 p;
          do {
            p = random_vector(-1, 1);
            p.z = 0;
          } while (dot(p, p) >= 1);
          origin += camera.aperture * (p.x * u + p.y * v);
        }
        sum += ray_color({origin, target - origin}, 50, world);
      }
      pixels.push_back(sum / static_cast<double>(side * side));
    }
  return pixels;
}

}  // namespace weekend_way
