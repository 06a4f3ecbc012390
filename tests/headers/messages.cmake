# What the compiler says of a program that is wrong: a sentence that names what is missing, in few lines.
#   cmake -D CMAKE_CXX_COMPILER=... "-D INCLUDES=-I<folder>;..." -D WORK=<folder to work in> -P messages.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})

# Of one type that lacks several members, and of several types of one scene, clang names the first.
# Of a deleted function clang says so first, and then lists all others.
execute_process(COMMAND ${CMAKE_CXX_COMPILER} --version OUTPUT_VARIABLE version COMMAND_ERROR_IS_FATAL ANY)
set(lines_of_one 25)
if(version MATCHES clang)
  set(lines_of_one 45)
endif()

set(beginning [[
struct NoNormal {
  std::optional<double> intersect(const Ray&, Interval) const { return 1; }
};
struct NoIntersect {
  Vec3 normal_at(Point) const { return {0, 0, 1}; }
};
struct Good : NoNormal, NoIntersect {};
]])

# Headers of every program, which are read once. Both compilers take what is compiled for an -include.
set(headers ${WORK}/headers.hpp)
file(WRITE ${headers} "#include <protostar/scene.hpp>\n#include <protostar/surfaces/sphere.hpp>\n")
execute_process(COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 ${INCLUDES} -x c++-header ${headers} -o ${headers}.gch
  COMMAND_ERROR_IS_FATAL ANY)

# Compiles a program that has to be refused. What the compiler says has the name of the type that is wrong and the
# sentence, and no more lines than a screen shows at once. Further pairs of a name and a sentence are of the same program,
# for so many lines more.
function(expect_refusal header code)
  string(SHA1 name "${code}")
  set(file ${WORK}/${name}.cpp)
  file(WRITE ${file} "#include <protostar/${header}>\nusing namespace protostar;\n${beginning}\n${code}\n")
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 ${INCLUDES} -include ${headers} -fsyntax-only ${file}
    RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
  string(REGEX MATCHALL "\n" lines "${text}")
  list(LENGTH lines lines)
  set(most_lines 0)
  set(active ${ARGN})
  while(active)
    list(POP_FRONT active type sentence)
    math(EXPR most_lines "${most_lines} + ${lines_of_one}")
    foreach(part IN ITEMS "${type}" "${sentence}")
      string(FIND "${text}" "${part}" place)
      if(place EQUAL -1)
        message(SEND_ERROR "the compiler does not say \"${part}\" of\n${code}\nbut\n${text}")
      endif()
    endforeach()
  endwhile()
  if(status EQUAL 0)
    message(SEND_ERROR "this compiles, and should not:\n${code}")
  elseif(lines GREATER most_lines)
    message(SEND_ERROR "the compiler says ${lines} lines, more than ${most_lines}, of\n${code}\nnamely\n${text}")
  endif()
endfunction()

set(no_normal NoNormal "Surface: the type has no normal_at(Point) const")
set(no_intersect NoIntersect "Surface: the type has no intersect(const Ray&, Interval) const")

# Whatever is done with such a scene, nothing more is said.
expect_refusal(scene.hpp [[
int main() {
  Scene<Sphere, NoNormal> scene;
  scene.add(NoNormal{}, {.diffuse = Color{1}});
  scene.add(Sphere{}, Color{1});
  scene.add(PointLight{});
  scene.set_sky(Color{1});
  return scene.intersect(Ray{}).has_value();
}]] ${no_normal})
expect_refusal(scene.hpp [[
struct Never : NoIntersect {
  const char* intersect(const Ray&, Interval) const { return "never"; }
};
struct Upwards : NoNormal {
  const char* normal_at(Point) const { return "up"; }
};
struct NotConst : NoIntersect {
  std::optional<double> intersect(const Ray&, Interval) { return 1; }
};
struct Unique : Good {
  Unique() = default;
  Unique(Unique&&) = default;
};
struct Parts : NoNormal {
  Vec3 normal_at(Point, int) const { return {0, 0, 1}; }
};
Scene<Never> never_met;
Scene<Upwards> upwards;
Scene<NotConst> not_const;
Scene<Unique> unique;
Scene<Parts> parts;
]]
  Never "Surface: the type has no intersect(const Ray&, Interval) const that returns std::optional<double>"
  Upwards "Surface: the type has no normal_at(Point) const that returns a Vec3"
  NotConst "Surface: the type has no intersect(const Ray&, Interval) const"
  Unique "Surface: the type cannot be copied"
  Parts "Surface: the type has normal_at(Point, int) const, for primitives, but no Departure departure(int) const")
# What a surface may have would be left aside where it is not what is asked for.
expect_refusal(scene.hpp [[
struct Rounded : Good { std::pair<double, double> roots(const Ray&) const { return {1, 2}; } };
struct Departing : Good { Departure departure() { return {}; } };
struct Unsure : Good { void validate() {} };
struct Bounded : Good { Bounds bounds() { return {}; } };
struct Textured : Good { double uv_at(Point) const { return 0; } };
struct Unleft : Good { RoundedQuadratic<double, double> equation(const Ray&) const { return {}; } };
struct Foremost : Good {
  std::optional<Crossing> first_crossing(const Ray&, Interval) const { return std::nullopt; }
};
struct Far : Good { float distance_bound(const Point&) const { return 0; } };
struct Filled : Good { bool ends_inside(const Ray&) { return false; } };
Scene<Rounded> rounded;
Scene<Departing> departing;
Scene<Unsure> unsure;
Scene<Bounded> bounded;
Scene<Textured> textured;
Scene<Unleft> unleft;
Scene<Foremost> foremost;
Scene<Far> far;
Scene<Filled> filled;
]]
  Rounded "Surface: roots(const Ray&) is not const or does not return Roots"
  Departing "Surface: departure() is not const or does not return a Departure"
  Unsure "Surface: validate() is not const"
  Bounded "Surface: bounds() is not const or does not return Bounds"
  Textured "Surface: uv_at(Point) is not const or does not return a Uv"
  Unleft "Surface: equation(rays) is not const, has no exact form for an ExactLine, or there is no"
  Foremost "or lacks each_crossing(ray, range, visit) or exact_root(ray, crossing), which go with it"
  Far "Surface: distance_bound(Point) is not const or does not return double"
  Filled "Surface: ends_inside(const Ray&) is not const or does not return bool")
expect_refusal(scene.hpp [[
struct Whole : Good { Uv uv_at(Point, int) const { return Uv{0}; } };
struct Parts : Good {
  Vec3 normal_at(Point, int = 0) const { return {0, 0, 1}; }
  Departure departure(int) const { return {}; }
};
struct Textured : Parts { Uv uv_at(Point, int) { return Uv{0}; } };
struct Directed : Parts { Vec3 tangents_at(Point, int) const { return {1, 0, 0}; } };
struct Moved : Good { Point at_rest(Point point, double) { return point; } };
struct Maybe : Good {
  bool ends_inside(const Ray&) const { return false; }
  bool is_solid() { return false; }
};
Scene<Whole> whole;
Scene<Textured> textured;
Scene<Directed> directed;
Scene<Moved> moved;
Scene<Maybe> maybe;
Scene<Parts> parts;
]]
  Whole "Surface: uv_at(Point, int) is not const, does not return a Uv, or lacks normal_at(Point, int)"
  Textured "Surface: uv_at(Point, int) is not const, does not return a Uv, or lacks normal_at(Point, int)"
  Directed "Surface: tangents_at(Point, int) is not const, does not return Tangents, or lacks normal_at(Point, int)"
  Moved "Surface: at_rest(Point, double) is not const or does not return a Point"
  Maybe "Surface: is_solid() is not const or does not return bool")
expect_refusal(surfaces/any_surface.hpp [[
void add(Scene<AnySurface>& scene) {
  scene.add(NoNormal{}, {.diffuse = Color{1}});
  scene.add(NoIntersect{}, Color{1});
}]] ${no_normal} ${no_intersect})
expect_refusal(surfaces/any_surface.hpp "AnySurface any = NoNormal{};"
  NoNormal "a Surface has intersect(const Ray&, Interval) const and normal_at(Point) const")
expect_refusal(surfaces/instance.hpp "Instance instance(NoNormal{}, Affine{});" ${no_normal})
expect_refusal(surfaces/csg.hpp [[
struct Face : Good {};
struct Parts : Good {
  Vec3 normal_at(Point, int) const { return {0, 0, 1}; }
  Departure departure(int) const { return {}; }
  bool ends_inside(const Ray&) const { return false; }
};
auto faces = union_of({Sphere{}, Face{}});
auto parts = difference_of({Sphere{}, NoNormal{}});
]] Face "Solid: the surface has no bool ends_inside(const Ray&) const" ${no_normal})
expect_refusal(scene.hpp [[
struct Lamp {};
void add(Scene<Sphere>& scene) {
  scene.add(Good{}, {.diffuse = Color{1}});
  scene.add(Sphere{}, 0.5);
  scene.add(Sphere{});
  scene.add(Lamp{});
}]]
  Good "not in the list of this Scene" double "a surface goes with a Material or a Color"
  Sphere "no light, and a surface needs a Material or a Color" Lamp "no light, and a surface needs a Material or a Color")

set(no_radiance "Integrator: the type has no radiance(const Ray&, const Scene&) const, and is no function of both")
expect_refusal(render.hpp [[
struct Nothing {};
struct NotConst { Color radiance(const Ray&, const auto&) { return Color{1}; } };
struct Shadeless : FirstHit<Shadeless> {};
struct Words { const char* radiance(const Ray&, const auto&) const { return "red"; } };
void draw(Image& image, const Scene<Sphere>& scene) {
  render(image, Camera{}, scene, Nothing{});
  render(image, Camera{}, scene, NotConst{}, {.threads = 1});
  render(image, Camera{}, scene, Words{});
  render(image, Camera{}, scene, Shadeless{});
  render(image, Camera{}, scene, [](const Ray&, const auto&) { return "red"; });
}]]
  Nothing "${no_radiance}" NotConst "${no_radiance}"
  Words "Integrator: radiance(const Ray&, const Scene&) const, or with a sampler, does not return a Color"
  Shadeless "Integrator: the type derives from FirstHit and has no shade(const Hit&, const Scene&) const"
  lambda "Integrator: the function of a ray and a scene does not return a Color")
expect_refusal(render.hpp [[
struct Nothing {};
void add(Film& film, const Scene<Sphere>& scene) {
  add_samples(film, {0, 16}, Camera{}, scene, Nothing{});
  add_samples(film, {0, 16}, Camera{}, [](const Ray&) { return 0.5; });
}]] Nothing "${no_radiance}" lambda "render: the function of a ray does not return a Color")
# The radiance of a base calls the base's functions, whatever a type that derives from it declares.
set(in_vain "Integrator: the type has a shade or a background of its own, but takes radiance from the base")
expect_refusal(integrators/shadow.hpp [[
struct Red : ShadowIntegrator {
  Color shade(const auto&, const auto&) const { return Color{1, 0, 0}; }
};
struct Night : ShadowIntegrator {
  Color background(const auto&, const auto&) const { return Color{0}; }
};
struct Copied : FirstHit<ShadowIntegrator> {
  Color shade(const Intersection&, const Scene<Sphere>&) const { return Color{1}; }
};
struct Chance : FirstHit<Chance> {
  Color shade(const auto&, const auto&, const auto&) const { return Color{1}; }
};
struct Blue : Chance {
  Color shade(const auto&, const auto&, const auto&) const { return Color{0, 0, 1}; }
};
void draw(Image& image, const Scene<Sphere>& scene) {
  render(image, Camera{}, scene, Red{});
  render(image, Camera{}, scene, Night{});
  render(image, Camera{}, scene, Copied{});
  render(image, Camera{}, scene, Blue{});
}]] Red "${in_vain}" Night "${in_vain}" Copied "${in_vain}" Blue "${in_vain}")
set(no_constant "Marched: a function of a Point alone is followed by the bounds and a Lipschitz constant")
expect_refusal(surfaces/distance_field.hpp [[
const Bounds bounds{Point(-1), Point(1)};
struct Square {};
struct Words { const char* operator()(const Point&) const { return "far"; } };
struct Ball { double operator()(const Point& p) const { return length(p) - 1; } };
struct Round { auto operator()(const auto& p) const { return length(p) - 1.0; } };
auto square = Marched{Square{}, bounds};
auto words = Marched{Words{}, bounds, 1.0};
auto ball = Marched{Ball{}, bounds};
auto round_everywhere = Marched{Round{}};
]]
  Square "Marched: the field is no function of a point that returns a number"
  Words "Marched: the field is no function of a point that returns a number"
  Ball "${no_constant}" Round "Marched: the field is followed by the bounds")
expect_refusal(fields/field.hpp [[
struct Mine { double operator()(const auto& p) const { return length(p) - 1.0; } };
fields::Field mine = Mine{};
fields::Field moved = fields::Moved{fields::Sphere{1}, Vec3{1, 0, 0}};
]] Mine "Field: the type is neither a shape of fields/ nor an operation"
  "Moved<" "on fields of type Field, such as Moved<Field>")
expect_refusal(render.hpp [[
struct Half {
  std::optional<Intersection> intersect(const Ray&, Interval) const { return std::nullopt; }
};
struct Most : Half {
  bool occluded(const Ray&, Interval) const { return false; }
};
void draw(Image& image, const Scene<Sphere>& scene) {
  const auto white = [](const Ray&, const auto&) { return Color{1}; };
  render(image, Camera{}, Half{}, white);
  render(image, Camera{}, Most{}, white);
  render(image, Camera{}, scene);
  render(image, Camera{}, [](const Ray&, const auto&, int) { return Color{1}; });
  render(image, Camera{}, [](const Ray&) { return "red"; }, {.threads = 1});
}]]
  Half "Traceable: the scene has no bool occluded(const Ray&, Interval) const"
  Most "Traceable: the scene has no crossings(const Ray&, Interval, visit) const"
  Sphere "render: a scene is followed by an integrator"
  lambda "render: what follows the camera is neither a function of a const Ray&, or of it and a sampler, that may be called when const"
  lambda "render: the function of a ray does not return a Color")

# Vectors that an option of GLM has changed are refused before anything is built of them. Not every GLM and processor
# has such vectors, so that GLM alone is asked first.
function(expect_refused_vectors property sentence)
  file(WRITE ${WORK}/glm.cpp "#include <glm/vec3.hpp>\n#include <type_traits>\nstatic_assert(${property});\n")
  file(WRITE ${WORK}/vectors.cpp "#include <protostar/vec3.hpp>\n")
  set(command ${CMAKE_CXX_COMPILER} -std=c++20 ${INCLUDES} ${ARGN} -fsyntax-only)
  execute_process(COMMAND ${command} ${WORK}/glm.cpp RESULT_VARIABLE differ OUTPUT_QUIET ERROR_QUIET)
  execute_process(COMMAND ${command} ${WORK}/vectors.cpp RESULT_VARIABLE refused OUTPUT_VARIABLE text ERROR_VARIABLE text)
  string(FIND "${text}" "${sentence}" place)
  if(differ AND (NOT refused OR place EQUAL -1))
    message(SEND_ERROR "the compiler does not say \"${sentence}\" of ${ARGN}, but\n${text}")
  elseif(refused AND NOT differ)
    message(SEND_ERROR "${ARGN} changes no vector, and is refused:\n${text}")
  endif()
endfunction()
expect_refused_vectors("sizeof(glm::dvec3) == 24 && sizeof(glm::vec3) == 12"
  "protostar needs vectors of three numbers" -DGLM_FORCE_DEFAULT_ALIGNED_GENTYPES -DGLM_FORCE_INTRINSICS)
expect_refused_vectors("std::is_trivially_copyable_v<glm::dvec3>"
  "protostar copies vectors byte by byte" -DGLM_FORCE_CTOR_INIT)
