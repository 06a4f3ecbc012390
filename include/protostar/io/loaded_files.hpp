// Files that a scene file names, kept while it is read: its images, and its meshes, which can be read if
// tinyobjloader is found.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../image.hpp"

#if __has_include(<tiny_obj_loader.h>)
#include "../surfaces/mesh.hpp"
#define PROTOSTAR_READS_MESHES 1
#endif

namespace protostar::inline PROTOSTAR_ABI::detail {

/// Files that a scene names, by canonical path; a file that is named twice is read once, and shared.
struct LoadedFiles {
  using Images = std::map<std::filesystem::path, std::shared_ptr<const Image>>;
  Images images, normal_maps;  ///< light, and numbers of normals
  std::int64_t pixels = 0;     ///< total of all images
#if defined(PROTOSTAR_READS_MESHES)
  struct MeshFile {
    std::shared_ptr<const MeshData> data;
    std::map<std::array<double, 4>, std::optional<Mesh>> placed;  ///< by scale and position
  };
  std::map<std::filesystem::path, MeshFile> meshes;
#endif

  /// Returns the paths of all files.
  [[nodiscard]] std::vector<std::string> paths() const {
    std::vector<std::string> all;
    const auto add = [&](const auto& files) {
      for (const auto& file : files) all.push_back(file.first.string());
    };
    add(images), add(normal_maps);
#if defined(PROTOSTAR_READS_MESHES)
    add(meshes);
#endif
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
};

}  // namespace protostar::inline PROTOSTAR_ABI::detail
