#include <protostar/io/obj.hpp>

#include "mesh_pictures.hpp"

using namespace protostar;

Mesh load_mesh(const std::filesystem::path& path, const std::function<Point(const Point&)>& place) {
  MeshData data = load_obj(path);
  for (Point& vertex : data.vertices) vertex = place(vertex);
  return Mesh(data);
}
