#include "facts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <protostar/environment_image.hpp>
#include <protostar/exact/recorded.hpp>
#include <protostar/march/field_line.hpp>
#include <protostar/surfaces/box.hpp>
#include <protostar/surfaces/csg.hpp>
#include <protostar/surfaces/disk.hpp>
#include <protostar/surfaces/instance.hpp>
#include <protostar/surfaces/moving.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/surfaces/torus.hpp>
#include <protostar/surfaces/triangle.hpp>
#include <protostar/transformed_ray.hpp>

#include "scenes/dusk.hpp"
#include "scenes/weekend.hpp"

using namespace protostar;

static std::vector<double> list(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Calls f with the surface that an AnySurface holds, if its type is one of the library's; otherwise returns
/// the given facts.
template <class F>
static Facts with_held(const AnySurface& any, const F& f, Facts facts = {.type = "surface"}) {
  const auto take = [&]<class... S>(const S*... held) { ((held ? void(facts = f(*held)) : void()), ...); };
  take(any.target<Sphere>(), any.target<Plane>(), any.target<Parallelogram>(), any.target<Triangle>(),
       any.target<Disk>(), any.target<Box>(), any.target<Quadric>(), any.target<Torus>(), any.target<Csg>(),
       any.target<Mesh>(), any.target<Instance<Csg>>(), any.target<Instance<>>(),
       any.target<Moving<Sphere>>(), any.target<Moving<>>());
  return facts;
}

static Facts facts_of(const Triangle& s) {
  return {"triangle", {{"a", list(s.a)}, {"b", list(s.b)}, {"c", list(s.c)}}};
}
static Facts facts_of(const Disk& s) {
  return {"disk", {{"position", list(s.position)}, {"normal", list(s.normal)}, {"radius", {s.radius}}}};
}
static Facts facts_of(const Box& s) { return {"box", {{"min", list(s.min)}, {"max", list(s.max)}}}; }
static Facts facts_of(const Quadric& s) {
  return {"quadric",
          {{"squares", list(s.form.squares)},
           {"products", list(s.form.products)},
           {"linear", list(s.form.linear)},
           {"constant", {s.form.constant}}}};
}

static Facts facts_of(const Torus& s) {
  return {"torus",
          {{"center", list(s.center)}, {"axis", list(s.axis)}, {"radius", {s.radius}}, {"tube", {s.tube}}}};
}

/// Returns the solids, and the tree of operations: for each node its parent (−1: none), the weight with which
/// it counts there, and the sum from which on it is inside; the node of each solid.
static Facts facts_of(const Csg& s) {
  Facts facts{"csg", {{"parent", {}}, {"weight", {}}, {"least", {}}, {"node", {}}, {"first_part", {}}}};
  for (const Csg::Node& node : s.nodes()) {
    facts.numbers[0].values.push_back(node.parent);
    facts.numbers[1].values.push_back(node.weight);
    facts.numbers[2].values.push_back(node.least);
  }
  for (const Csg::Leaf& leaf : s.leaves()) {
    facts.numbers[3].values.push_back(leaf.node);
    facts.numbers[4].values.push_back(leaf.first_primitive);
    facts.parts.push_back(facts_of(leaf.solid));
  }
  return facts;
}

template <class S>
static Facts facts_of(const Instance<S>& s) {
  const Affine& map = s.placement();
  Facts facts{
      "instance",
      {{"x", list(map.x)}, {"y", list(map.y)}, {"z", list(map.z)}, {"translation", list(map.translation)}}};
  facts.parts.push_back(facts_of(s.surface()));
  return facts;
}

template <class S>
static Facts facts_of(const Moving<S>& s) {
  Facts facts{"moving",
              {{"velocity", list(s.velocity())}, {"during", {s.during().opens, s.during().closes}}}};
  facts.parts.push_back(facts_of(s.surface()));
  return facts;
}

template <class T, class C, bool is_of_sphere>
static Facts facts_of(const RoundedQuadratic<T, C, is_of_sphere>& e) {
  return {"quadratic", {{"A", {e.A}}, {"b", {e.b}}, {"c", {e.c}}, {"D", {e.D}}, {"error_of_D", {e.E}}}};
}
template <class T, class M>
static Facts facts_of(const RoundedLinear<T, M>& e) {
  return {"linear", {{"height", {e.height}}, {"slope", {e.slope}}}};
}

/// Returns the equation of a surface that writes it down.
static Facts equation(const auto& surface, const Ray& ray) {
  return with_line(ray, [&](const auto& line) { return facts_of(surface.equation(line)); });
}

/// Returns the equation of a surface with a corner and the edges u and v. The line crosses its plane at the
/// point corner + (along_u · u + along_v · v) / slope.
static Facts equation_with_edges(const auto& surface, const Point& corner, const Vec3& u, const Vec3& v,
                                 const Ray& ray) {
  Facts facts = equation(surface, ray);
  const RoundedLine line = rounded_line(ray);
  const Vec3 m = cross(corner - line.origin, line.direction);
  facts.numbers.push_back({"along_u", {dot(v, m)}});
  facts.numbers.push_back({"along_v", {-dot(u, m)}});
  return facts;
}

static Facts equation_of(const Triangle& s, const Ray& ray) {
  return equation_with_edges(s, s.a, s.b - s.a, s.c - s.a, ray);
}
static Facts equation_of(const Quadric& s, const Ray& ray) { return equation(s, ray); }
static Facts equation_of(const Torus&, const Ray&) { return {.type = "torus"}; }
/// Returns the equation, and the distance of the crossing from the center and the radius, both times |slope|.
static Facts equation_of(const Disk& s, const Ray& ray) {
  Facts facts = equation(s, ray);
  const RoundedLine line = rounded_line(ray);
  const Vec3 from_center = cross(s.normal, cross(line.direction, s.position - line.origin));
  facts.numbers.push_back({"from_center", {length(from_center)}});
  facts.numbers.push_back({"reach", {s.radius * std::abs(facts.numbers[1].values[0])}});
  return facts;
}
static Facts equation_of(const Box& s, const Ray& ray) {
  const RoundedLine line = rounded_line(ray);
  return {"slabs",
          {{"to_min", list(s.min - line.origin)},
           {"to_max", list(s.max - line.origin)},
           {"slope", list(line.direction)}}};
}
static Facts equation_of(const Csg& s, const Ray& ray) {
  Facts facts{"csg"};
  for (const Csg::Leaf& leaf : s.leaves()) facts.parts.push_back(equation_of(leaf.solid, ray));
  return facts;
}
template <class S>
static Facts equation_of(const Instance<S>& s, const Ray& ray) {
  const AffineInverse inverse(s.placement());
  const RayTransform transform(ray, inverse);
  Facts facts{"instance"};
  facts.parts.push_back(equation_of(s.surface(), transform.ray()));
  return facts;
}

/// Returns the equation of the surface at rest, and of the ray that is moved there.
template <class S>
static Facts equation_of(const Moving<S>& s, const Ray& ray) {
  Ray rest = ray;
  rest.origin = s.at_rest(ray.origin, ray.time);
  Facts facts{"moving"};
  facts.parts.push_back(equation_of(s.surface(), rest));
  return facts;
}

/// Keeps the steps of a march, with the evaluations that prove each of them.
class MarchSteps final : public MarchListener {
 public:
  void evaluated(Evaluation kind, const DoubleDouble& a, const DoubleDouble& b,
                 const Result& result) override {
    if (kind == Evaluation::value)
      values_[a] = {result.lower}, last_ = a;
    else if (kind == Evaluation::precise_value)
      values_[a] = {result.lower, result.upper}, last_ = a;
    else
      slope_ = {a, b, kind == Evaluation::precise_slope, result}, fall_.reset();
  }

  void proven(MarchProof proof, const DoubleDouble& a, const DoubleDouble& b) override {
    const Result& over = slope_.result;
    switch (proof) {
      case MarchProof::ball:
        return add("ball", a, b, {{"value", value_at(a)}});
      case MarchProof::two_balls:
        return add("two balls", a, b, {{"value", value_at(a)}, {"value_at_to", value_at(b)}});
      case MarchProof::bend:
        return add("bend", a, b,
                   {{"before", of_parameter(from_)},
                    {"value_before", value_at(from_)},
                    {"value", value_at(a)},
                    {"value_at_to", value_at(b)}});
      case MarchProof::segment:
        return add(slope_.is_precise ? "precise segment" : "segment", a, b,
                   {{"values", {over.lower, over.upper}},
                    {"slopes", {over.slope_lower, over.slope_upper}},
                    {"value", value_at(a)},
                    {"value_at_to", value_at(b)}});
      case MarchProof::fall:
        fall_ = {a, last_};
        return;
      case MarchProof::deflation:
        return add("deflation", a, b, {{"slopes", {over.slope_lower, over.slope_upper}}});
      case MarchProof::sign_change:
        if (fall_)
          return add("sign change", fall_->a, b,
                     {{"behind", of_parameter(fall_->behind)},
                      {"min", of_parameter(a)},
                      {"value_behind", value_at(fall_->behind)},
                      {"value_at_min", value_at(a)},
                      {"value_at_to", value_at(b)}});
        return add("sign change", slope_.a, b,
                   {{"slopes", {over.slope_lower, over.slope_upper}},
                    {"min", of_parameter(a)},
                    {"value_at_min", value_at(a)},
                    {"value_at_to", value_at(b)}});
      case MarchProof::touch:
        return add("touch", a, b, {});
    }
  }

  [[nodiscard]] const Facts& facts() const { return facts_; }

 private:
  /// Returns a parameter t as a number, or as two whose sum it is if it lies between two doubles.
  static std::vector<double> of_parameter(const DoubleDouble& t) {
    return t.lo == 0 ? std::vector{t.hi} : std::vector{t.hi, t.lo};
  }

  void add(const char* type, const DoubleDouble& from, const DoubleDouble& to, std::vector<Named> numbers) {
    numbers.insert(numbers.begin(), {{"from", of_parameter(from)}, {"to", of_parameter(to)}});
    facts_.parts.push_back({type, std::move(numbers)});
    from_ = from;
  }

  /// Returns the value at t, or both ends of its enclosure if it was evaluated in double-double, which may be
  /// equal as they are rounded; nothing if it was not evaluated there.
  [[nodiscard]] std::vector<double> value_at(const DoubleDouble& t) const {
    const auto found = values_.find(t);
    return found == values_.end() ? std::vector<double>{} : found->second;
  }

  Facts facts_{"march"};
  std::map<DoubleDouble, std::vector<double>> values_;
  DoubleDouble from_, last_;  ///< where the last step begins, and the place of the last value
  struct Fall {
    DoubleDouble a, behind;
  };
  std::optional<Fall> fall_;  ///< proof of a fall by values, unless an enclosure of a slope came after it
  struct {
    DoubleDouble a, b;
    bool is_precise = false;
    Result result;
  } slope_;
};

Facts march_of(const AnySurface& surface, const Ray& ray, Interval range) {
  const Fallbacks before = fallbacks;
  MarchSteps steps;
  surface.march(ray, range, steps);
  fallbacks = before;
  return steps.facts();
}

/// Returns an operation of a field: its name, the indices of the operations that it takes, and a number.
static Facts facts_of(const FieldTape::Operation& one) {
  Facts facts{.type = std::string(one.name)};
  if (!one.of.empty()) facts.numbers.push_back({"of", {one.of.begin(), one.of.end()}});
  if (one.name == "constant" || one.name == "smooth_min") facts.numbers.push_back({"number", {one.number}});
  return facts;
}

Facts facts_of(const AnySurface& surface) {
  if (const MarchSetup* setup = surface.march_setup()) {
    Facts facts{"marched",
                {{"min", list(setup->inside.min)},
                 {"max", list(setup->inside.max)},
                 {"lipschitz", {setup->bound.lipschitz}},
                 {"error", {setup->bound.error}}}};
    const auto& [least, most] = setup->bound.curvature;
    if (least > -infinity) facts.numbers.push_back({"least_curvature", {least}});
    if (most < infinity) facts.numbers.push_back({"most_curvature", {most}});
    FieldTape field;
    surface.record_field(field);
    for (const FieldTape::Operation& one : field.operations()) facts.parts.push_back(facts_of(one));
    return facts;
  }
  return with_held(surface, [](const auto& held) { return facts_of(held); });
}
Facts facts_of(const Sphere& s) { return {"sphere", {{"center", list(s.center)}, {"radius", {s.radius}}}}; }
Facts facts_of(const Plane& s) { return {"plane", {{"normal", list(s.normal)}, {"distance", {s.distance}}}}; }
Facts facts_of(const Parallelogram& s) {
  return {"parallelogram",
          {{"position", list(s.position)}, {"edge_u", list(s.edge_u)}, {"edge_v", list(s.edge_v)}}};
}
/// Returns a whole mesh: the number of triangles, and as lists without a structure the vertices, three
/// indices of vertices for each triangle, and the normals and texture coordinates of the vertices if there
/// are any.
Facts facts_of(const Mesh& s) {
  const MeshData& data = s.data();
  Facts facts{
      "mesh",
      {{"triangles", {static_cast<double>(data.triangles.size())}}, {"vertices", {}}, {"corners", {}}}};
  const auto flat = [](const auto& vectors, int size) {
    std::vector<double> numbers;
    for (const auto& v : vectors)
      for (int k = 0; k < size; ++k) numbers.push_back(static_cast<double>(v[k]));
    return numbers;
  };
  facts.numbers[1].values = flat(data.vertices, 3);
  for (const auto& corners : data.triangles)
    facts.numbers[2].values.insert(facts.numbers[2].values.end(), corners.begin(), corners.end());
  if (!data.normals.empty()) facts.numbers.push_back({"normals", flat(data.normals, 3)});
  if (!data.uvs.empty()) facts.numbers.push_back({"uvs", flat(data.uvs, 2)});
  return facts;
}

Facts equation_of(const AnySurface& surface, const Ray& ray) {
  if (surface.march_setup()) return {.type = "march"};
  return with_held(surface, [&](const auto& held) { return equation_of(held, ray); });
}
Facts equation_of(const Sphere& s, const Ray& ray) { return equation(s, ray); }
Facts equation_of(const Plane& s, const Ray& ray) { return equation(s, ray); }
Facts equation_of(const Parallelogram& s, const Ray& ray) {
  return equation_with_edges(s, s.position, s.edge_u, s.edge_v, ray);
}
Facts equation_of(const Mesh&, const Ray&) { return {.type = "mesh"}; }

Facts primitive_of(const AnySurface& surface, int primitive) {
  return with_held(surface, [&](const auto& held) { return primitive_of(held, primitive); }, {});
}
Facts primitive_of(const Mesh& mesh, int primitive) {
  const auto i = static_cast<std::size_t>(primitive);
  Facts facts = facts_of(mesh.data().triangle(i));
  const auto& [a, b, c] = mesh.data().triangles[i];
  for (const auto& [name, vertex] : {std::pair{"a", a}, {"b", b}, {"c", c}}) {
    if (!mesh.data().normals.empty())
      facts.numbers.push_back({std::string("normal_") + name, list(mesh.data().normals[vertex])});
    if (mesh.data().uvs.empty()) continue;
    const Uv& uv = mesh.data().uvs[vertex];
    facts.numbers.push_back({std::string("uv_") + name, {uv.x, uv.y}});
  }
  return facts;
}

Facts look_up_of(const Environment& environment, const Uv& uv) {
  using Function = Color (*)(double, double);
  using OfDirection = Color (*)(const Vec3&);
  if (const auto* function = environment.by_direction().target<OfDirection>())
    return {.type = *function == weekend_sky ? "weekend" : "function"};
  if (const auto* function = environment.by_uv().target<Function>())
    return {.type = *function == dusk ? "dusk" : "function"};
  const auto* picture = environment.by_uv().target<EnvironmentImage>();
  if (!picture) return {.type = "function"};
  const Image& image = *picture->image;
  const int width = image.width(), height = image.height();
  const int x = static_cast<int>(std::floor((uv.x - std::floor(uv.x)) * width - 0.5)),
            y = static_cast<int>(std::floor(uv.y * height - 0.5));
  Facts facts{.type = "image", .numbers = {{"size", {double(width), double(height)}}}, .file = picture->file};
  for (const int down : {0, 1})
    for (const int across : {0, 1}) {
      const int column = (x + across + width) % width, row = std::clamp(y + down, 0, height - 1);
      facts.parts.push_back({"pixel",
                             {{"column", {double(column)}},
                              {"row", {double(row)}},
                              {"color", list(Vec3(image(column, row)))}}});
    }
  return facts;
}
