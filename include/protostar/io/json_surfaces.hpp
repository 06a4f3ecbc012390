// Reads the surfaces of a scene file, and adds them to its scene or makes them part of another.
//
// To add a type of surface, write a function that reads one, beside sphere_at, and add a row to
// surface_types; a type that SceneFile::scene does not list is held as AnySurface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../magnitude.hpp"
#include "../material.hpp"
#include "../numeric/affine.hpp"
#include "../surfaces/any_surface.hpp"
#include "../surfaces/box.hpp"
#include "../surfaces/csg.hpp"
#include "../surfaces/disk.hpp"
#include "../surfaces/distance_field.hpp"
#include "../surfaces/instance.hpp"
#include "../surfaces/moving.hpp"
#include "../surfaces/parallelogram.hpp"
#include "../surfaces/plane.hpp"
#include "../surfaces/quadric.hpp"
#include "../surfaces/sphere.hpp"
#include "../surfaces/torus.hpp"
#include "../surfaces/triangle.hpp"
#include "../vec3.hpp"
#include "json_cursor.hpp"
#include "json_fields.hpp"
#include "json_tree.hpp"
#include "loaded_files.hpp"
#include "scene_file.hpp"

#if defined(PROTOSTAR_READS_MESHES)
#include "obj.hpp"
#endif

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Place of a surface: of an object, which may move, or of a part of another surface.
struct SurfaceCursor : JsonCursor {
  bool is_part = false;

  explicit SurfaceCursor(const JsonCursor& at, bool as_part = false) : JsonCursor(at), is_part(as_part) {}

  /// Refuses all but an object without other keys than these and those of any surface; returns the cursor
  /// itself.
  const SurfaceCursor& with_keys(std::vector<std::string_view> allowed) const {
    if (is_part && has("velocity"))
      (*this)["velocity"].refuse("possible in a part of another surface: it is the whole surface that moves");
    allowed.insert(allowed.begin(), "type");
    if (!is_part) allowed.push_back("velocity");
    JsonCursor::with_keys(allowed);
    return *this;
  }
};

inline Sphere sphere_at(const SurfaceCursor& at) {
  at.with_keys({"position", "radius"});
  return {.center = at["position"].point(), .radius = at["radius"].size()};
}

inline Plane plane_at(const SurfaceCursor& at) {
  at.with_keys({"normal", "distance"});
  return {.normal = at["normal"].direction(), .distance = at["distance"].coordinate()};
}

inline Parallelogram parallelogram_at(const SurfaceCursor& at) {
  at.with_keys({"position", "edges"});
  const JsonCursor edges = at["edges"].with_size(2, "an array of two vectors");
  const Parallelogram board{
      .position = at["position"].point(), .edge_u = edges[0].point(), .edge_v = edges[1].point()};
  at["edges"].checked([&] { board.validate(); });
  return board;
}

inline Triangle triangle_at(const SurfaceCursor& at) {
  at.with_keys({"points"});
  const JsonCursor points = at["points"].with_size(3, "an array of three points");
  const Triangle triangle{.a = points[0].point(), .b = points[1].point(), .c = points[2].point()};
  at["points"].checked([&] { triangle.validate(); });
  return triangle;
}

#if defined(PROTOSTAR_READS_MESHES)
inline Mesh mesh_at(const SurfaceCursor& at) {
  at.with_keys({"file", "position", "scale"});
  const Vec3 position = at.has("position") ? at["position"].point() : Vec3{0};
  const double scale = at.has("scale") ? at["scale"].size() : 1;
  const NamedFile file = at["file"].named_file();
  LoadedFiles::MeshFile& mesh = at.loaded().meshes[file.canonical];
  if (!mesh.data)
    mesh.data = at["file"].checked([&] { return std::make_shared<MeshData>(load_obj(file.path)); });
  const auto [placed, is_new] = mesh.placed.try_emplace({scale, position.x, position.y, position.z});
  if (!is_new) return *placed->second;
  MeshData data = *mesh.data;
  for (Point& vertex : data.vertices) {
    const Vec3 from_position = scale * vertex;
    vertex = position + from_position;
    const char* const cause = is_coordinate(from_position) ? "position" : "scale";
    if (!is_coordinate(vertex) && at.has(cause))
      at[cause].refuse(std::string("one that leaves the numbers of all vertices ").append(coordinate_rule));
  }
  placed->second.emplace(
      at["file"].checked([&] { return Mesh(std::move(data), {.threads = at.options().threads}); }));
  return *placed->second;
}
#else
inline Sphere mesh_at(const SurfaceCursor& at) {
  return at["file"].checked([]() -> Sphere {
    throw std::runtime_error(
        "this program was built without tinyobjloader, which reads meshes (Debian: libtinyobjloader-dev)");
  });
}
#endif

inline Box box_at(const SurfaceCursor& at) {
  at.with_keys({"min", "max"});
  const Box box{.min = at["min"].point(), .max = at["max"].point()};
  at["max"].checked([&] { box.validate(); });
  return box;
}

inline Disk disk_at(const SurfaceCursor& at) {
  at.with_keys({"position", "normal", "radius"});
  return {.position = at["position"].point(),
          .normal = at["normal"].direction_of_any_length(),
          .radius = at["radius"].size()};
}

inline Quadric quadric_at(const SurfaceCursor& at) {
  at.with_keys({"matrix"});
  const std::string allowed = "a symmetric matrix, an array of four rows of four numbers";
  const JsonCursor rows = at["matrix"].with_size(4, allowed);
  double m[4][4] = {};
  for (std::size_t i = 0; i < 4; ++i) {
    const JsonCursor row = rows[i].with_size(4, "a row of four numbers");
    for (std::size_t j = 0; j < 4; ++j) {
      m[i][j] = row[j].coordinate();
      if (j < i && m[i][j] != m[j][i])
        row[j].refuse("the number on the other side of the diagonal, " + json(m[j][i]).dump());
    }
  }
  const Quadric quadric{{.squares = {m[0][0], m[1][1], m[2][2]},
                         .products = {m[1][2], m[2][0], m[0][1]},
                         .linear = {m[0][3], m[1][3], m[2][3]},
                         .constant = m[3][3]}};
  at["matrix"].checked([&] { quadric.validate(); });
  return quadric;
}

inline Torus torus_at(const SurfaceCursor& at) {
  at.with_keys({"position", "axis", "radius", "tube"});
  const Torus torus{.center = at["position"].point(),
                    .axis = at.has("axis") ? at["axis"].direction_of_any_length() : Vec3{0, 1, 0},
                    .radius = at["radius"].size(),
                    .tube = at["tube"].size()};
  at["tube"].checked([&] { torus.validate(); });
  return torus;
}

/// Reads the surface of a field. Its Lipschitz constant is derived by fewer evaluations if each takes longer:
/// some hundredths of a second for the whole.
inline Marched<fields::Field> marched_at(const SurfaceCursor& at) {
  at.with_keys({"field", "bounds"});
  const fields::Field field = field_at({at["field"]});
  const Bounds bounds = bounds_of_field(at, field);
  const int evaluations = static_cast<int>(std::clamp<std::size_t>(16'384 / field.size(), 64, 2048));
  return at.checked([&] { return Marched<fields::Field>(field, bounds, evaluations); });
}

AnySurface surface_at(const JsonCursor& at);

/// Returns the solid of a value: an operation on solids, or one closed surface.
inline Csg solid_at(const JsonCursor& at);

inline Csg csg_at(const SurfaceCursor& at) {
  at.with_keys({"operation", "surfaces"});
  using Operation = Csg::Operation;
  const auto operation = at["operation"].one_of<Operation>({{"union", Operation::either},
                                                            {"intersection", Operation::all},
                                                            {"difference", Operation::first_alone}});
  std::vector<Csg> solids;
  at["surfaces"].each_element([&](const JsonCursor& operand) { solids.push_back(solid_at(operand)); });
  return at["surfaces"].checked([&] { return Csg(operation, std::move(solids)); });
}

/// Throws SceneError about the value that makes a surface no closed solid.
[[noreturn]] inline void refuse_as_solid(const JsonCursor& at) {
  if (at["type"].is("instance")) refuse_as_solid(at["surface"]);
  if (at["type"].is("mesh"))
    at["file"].refuse("the file of a closed mesh, whose triangles share each edge, in opposite directions");
  at["type"].refuse("the type of a closed solid");
}

inline Csg solid_at(const JsonCursor& at) {
  if (at.has("type") && at["type"].is("csg")) return csg_at(SurfaceCursor(at, true));
  AnySurface surface = surface_at(at);
  try {
    // Csg tests whether the surface is a solid. A test before it would visit all edges of a mesh once more.
    return Csg(std::move(surface));
  } catch (const std::invalid_argument&) {
    refuse_as_solid(at);
  }
}

/// Returns the map of three rows of four numbers: the linear part, followed by the translation.
inline Affine matrix_at(const JsonCursor& at) {
  const JsonCursor rows = at.with_size(3, "an array of three rows");
  Affine map;
  for (int i = 0; i < 3; ++i) {
    const JsonCursor row = rows[static_cast<std::size_t>(i)].with_size(4, "a row, an array of four numbers");
    map.x[i] = row[0].coordinate(), map.y[i] = row[1].coordinate(), map.z[i] = row[2].coordinate();
    map.translation[i] = row[3].coordinate();
  }
  return map;
}

inline Affine placement_at(const SurfaceCursor& at) {
  if (at.has("matrix")) return matrix_at(at.with_keys({"surface", "matrix"})["matrix"]);
  if (at.has("scale") || at.has("rotate") || at.has("translate"))
    at.with_keys({"surface", "scale", "rotate", "translate"});
  else
    at.with_keys({"surface", "matrix", "scale", "rotate", "translate"});
  Affine map;
  if (at.has("scale")) {
    const JsonCursor scale = at["scale"];
    map = map.scaled_by(scale.is(json::value_t::array) ? scale.point()
                                                       : Vec3(scale.coordinate("a number or a vector")));
  }
  if (at.has("rotate")) {
    const JsonCursor rotate = at["rotate"].with_keys({"axis", "angle"});
    map = map.rotated_about(rotate["axis"].direction(), rotate["angle"].number("a number of degrees"));
  }
  if (at.has("translate")) map = map.moved_by(at["translate"].point());
  return map;
}

inline Instance<> instance_at(const SurfaceCursor& at) {
  const Affine placement = placement_at(at);
  at[at.has("matrix") ? "matrix" : "scale"].checked([&] {
    if (!AffineInverse(placement).exists())
      throw std::invalid_argument("it takes space to a plane or less, or beyond the range of double");
    Instance<Sphere>({}, placement).validate();
  });
  return {surface_at(at["surface"]), placement};
}

/// Functions that read a type of surface: add() into a scene whose camera is known, make() to be held by
/// another surface.
struct SurfaceReader {
  void (*add)(const JsonCursor&, const Material&, SceneFile&);
  AnySurface (*make)(const JsonCursor&);
};
template <auto some_surface_at>
inline constexpr SurfaceReader read_by{
    .add =
        [](const JsonCursor& at, const Material& material, SceneFile& file) {
          const auto surface = some_surface_at(SurfaceCursor(at));
          if (!at.has("velocity")) return at.checked([&] { file.scene.add(surface, material); });
          const Vec3 velocity = at["velocity"].point();
          at.checked([&] {
            file.scene.add(AnySurface(Moving<>(surface, velocity, file.camera.shutter)), material);
          });
        },
    .make = [](const JsonCursor& at) -> AnySurface { return some_surface_at(SurfaceCursor(at, true)); }};

inline const std::vector<std::pair<std::string_view, SurfaceReader>> surface_types{
    {"sphere", read_by<sphere_at>},
    {"plane", read_by<plane_at>},
    {"parallelogram", read_by<parallelogram_at>},
    {"triangle", read_by<triangle_at>},
    {"mesh", read_by<mesh_at>},
    {"box", read_by<box_at>},
    {"disk", read_by<disk_at>},
    {"quadric", read_by<quadric_at>},
    {"torus", read_by<torus_at>},
    {"csg", read_by<csg_at>},
    {"instance", read_by<instance_at>},
    {"field", read_by<marched_at>},
};

/// Returns a surface of any type, to be held by another.
inline AnySurface surface_at(const JsonCursor& at) { return at["type"].one_of(surface_types).make(at); }

}  // namespace protostar::inline PROTOSTAR_ABI::detail
