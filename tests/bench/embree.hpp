// Embree, behind the few functions that bench_spheres and bench_meshes need; version 3 or 4.
#pragma once

#if defined(BENCH_EMBREE) && BENCH_EMBREE == 4
#include <embree4/rtcore.h>
#elif defined(BENCH_EMBREE)
#include <embree3/rtcore.h>
#endif
#ifdef BENCH_EMBREE
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "workload.hpp"

namespace bench {

/// Ray of numbers that float holds.
struct FloatRay {
  glm::vec3 origin, direction;
  float max = std::numeric_limits<float>::infinity();
};

/// Returns the pixels of a square image in tiles of 16 × 16 made of tiles of 4 × 4, so that neighbors in the
/// picture are neighbors in the list.
inline std::vector<std::pair<int, int>> pixels_by_tile(int side) {
  std::vector<std::pair<int, int>> pixels;
  for (int i = 0; i < side * side; ++i) {
    const int tile = i / 256, small = i / 16 % 16, inside = i % 16, tiles = side / 16;
    pixels.emplace_back(tile % tiles * 16 + small % 4 * 4 + inside % 4,
                        tile / tiles * 16 + small / 4 * 4 + inside / 4);
  }
  return pixels;
}

/// Index of the sphere that a ray hits, or nothing.
using Index = std::uint32_t;
inline constexpr Index nothing = ~Index{0};

/// Modes in which Embree takes rays: one by one, sixteen at a time, in streams of 256.
enum class Mode { single, packet, stream };

#ifdef BENCH_EMBREE

/// Surfaces in Embree's own hierarchy.
class Embree {
 public:
  static constexpr bool is_there = true;
  static constexpr bool has_streams = BENCH_EMBREE == 3;  // version 4 has none

  Embree(const std::vector<FloatSphere>& spheres, int threads) : Embree(threads) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, spheres.data(), 0,
                               sizeof(FloatSphere), spheres.size());
    build(geometry, RTC_SCENE_FLAG_NONE);
  }
  /// Takes triangles by the numbers of their vertices; robust, which means without gaps between them.
  Embree(const std::vector<protostar::Point>& vertices,
         const std::vector<std::array<std::uint32_t, 3>>& triangles, int threads)
      : Embree(threads) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const places = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), vertices.size()));
    std::copy(vertices.begin(), vertices.end(), places);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                               sizeof triangles[0], triangles.size());
    build(geometry, RTC_SCENE_FLAG_ROBUST);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  /// Returns the number of bytes that the device has allocated, without the caller's spheres.
  [[nodiscard]] std::ptrdiff_t bytes() const { return bytes_; }

  /// Finds the closest sphere that each ray in [begin, end) hits.
  void closest(Mode mode, bool coherent, const std::vector<FloatRay>& rays, std::size_t begin,
               std::size_t end, std::vector<Index>& hits) const {
    const FlushDenormals flush;
    Arguments arguments(coherent);
    const auto one = [](const FloatRay& ray) {
      RTCRayHit query;
      query.ray = alone(ray);
      query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      return query;
    };
    const auto hit = [](unsigned geometry, unsigned sphere) {
      return geometry == RTC_INVALID_GEOMETRY_ID ? nothing : sphere;
    };
    if (mode == Mode::single) {
      for (std::size_t i = begin; i < end; ++i) {
        RTCRayHit query = one(rays[i]);
        arguments.intersect1(scene_, query);
        hits[i] = hit(query.hit.geomID, query.hit.primID);
      }
    } else if (mode == Mode::packet) {
      for (std::size_t first = begin; first < end; first += 16) {
        RTCRayHit16 query;
        const Lanes lanes = packet(rays, first, end, query.ray);
        for (std::size_t i = 0; i < 16; ++i)
          query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        arguments.intersect16(lanes.valid, scene_, query);
        for (std::size_t i = 0; i < lanes.count; ++i)
          hits[first + i] = hit(query.hit.geomID[i], query.hit.primID[i]);
      }
    } else {
      std::vector<RTCRayHit> queries(stream_length);
      for (std::size_t first = begin; first < end; first += stream_length) {
        const std::size_t count = std::min(stream_length, end - first);
        for (std::size_t i = 0; i < count; ++i) queries[i] = one(rays[first + i]);
        arguments.intersect_stream(scene_, queries.data(), count);
        for (std::size_t i = 0; i < count; ++i)
          hits[first + i] = hit(queries[i].hit.geomID, queries[i].hit.primID);
      }
    }
  }

  /// Tests whether each ray in [begin, end) hits anything before its end: 0 if it does, nothing if not.
  void any(Mode mode, bool coherent, const std::vector<FloatRay>& rays, std::size_t begin, std::size_t end,
           std::vector<Index>& hits) const {
    const FlushDenormals flush;
    Arguments arguments(coherent);
    const auto hit = [](float max) { return max < 0 ? Index{0} : nothing; };  // Embree's sign of a hit
    if (mode == Mode::single) {
      for (std::size_t i = begin; i < end; ++i) {
        RTCRay query = alone(rays[i]);
        arguments.occluded1(scene_, query);
        hits[i] = hit(query.tfar);
      }
    } else if (mode == Mode::packet) {
      for (std::size_t first = begin; first < end; first += 16) {
        RTCRay16 query;
        const Lanes lanes = packet(rays, first, end, query);
        arguments.occluded16(lanes.valid, scene_, query);
        for (std::size_t i = 0; i < lanes.count; ++i) hits[first + i] = hit(query.tfar[i]);
      }
    } else {
      std::vector<RTCRay> queries(stream_length);
      for (std::size_t first = begin; first < end; first += stream_length) {
        const std::size_t count = std::min(stream_length, end - first);
        for (std::size_t i = 0; i < count; ++i) queries[i] = alone(rays[first + i]);
        arguments.occluded_stream(scene_, queries.data(), count);
        for (std::size_t i = 0; i < count; ++i) hits[first + i] = hit(queries[i].tfar);
      }
    }
  }

 private:
  static constexpr std::size_t stream_length = 256;

  explicit Embree(int threads) : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())) {
    if (!device_) throw std::runtime_error("Embree cannot make a device");
    const auto add = [](void* bytes, ssize_t more, bool) {
      *static_cast<std::atomic<std::ptrdiff_t>*>(bytes) += more;
      return true;
    };
    rtcSetDeviceMemoryMonitorFunction(device_, add, &bytes_);
    scene_ = rtcNewScene(device_);
  }

  void build(RTCGeometry geometry, RTCSceneFlags flags) {
    const FlushDenormals flush;
    rtcCommitGeometry(geometry);
    rtcSetSceneFlags(scene_, flags);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  /// Flushes denormal numbers while Embree computes, as its manual recommends; the library needs them.
  class FlushDenormals {
   public:
    FlushDenormals() : before_(_mm_getcsr()) {
      _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
      _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    }
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;
    ~FlushDenormals() { _mm_setcsr(before_); }

   private:
    unsigned before_;
  };

  /// Active lanes of a packet of sixteen.
  struct Lanes {
    alignas(64) int valid[16];
    std::size_t count;
  };

  static RTCRay alone(const FloatRay& ray) {
    RTCRay query;
    query.org_x = ray.origin.x, query.org_y = ray.origin.y, query.org_z = ray.origin.z;
    query.dir_x = ray.direction.x, query.dir_y = ray.direction.y, query.dir_z = ray.direction.z;
    query.tnear = 0, query.tfar = ray.max, query.time = 0;
    query.mask = ~0u, query.flags = 0;
    return query;
  }

  static Lanes packet(const std::vector<FloatRay>& rays, std::size_t first, std::size_t end,
                      RTCRay16& query) {
    Lanes lanes;
    lanes.count = std::min<std::size_t>(16, end - first);
    for (std::size_t i = 0; i < 16; ++i) {
      const FloatRay& ray = rays[std::min(first + i, end - 1)];
      lanes.valid[i] = i < lanes.count ? -1 : 0;
      query.org_x[i] = ray.origin.x, query.org_y[i] = ray.origin.y, query.org_z[i] = ray.origin.z;
      query.dir_x[i] = ray.direction.x, query.dir_y[i] = ray.direction.y, query.dir_z[i] = ray.direction.z;
      query.tnear[i] = 0, query.tfar[i] = ray.max, query.time[i] = 0;
      query.mask[i] = ~0u, query.flags[i] = 0;
    }
    return lanes;
  }

  /// Calls of either version of the interface.
  struct Arguments {
#if BENCH_EMBREE == 3
    RTCIntersectContext context;

    explicit Arguments(bool coherent) {
      rtcInitIntersectContext(&context);
      if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
    void intersect1(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &context, &query); }
    void intersect16(const int* valid, RTCScene scene, RTCRayHit16& query) {
      rtcIntersect16(valid, scene, &context, &query);
    }
    void intersect_stream(RTCScene scene, RTCRayHit* queries, std::size_t count) {
      rtcIntersect1M(scene, &context, queries, static_cast<unsigned>(count), sizeof *queries);
    }
    void occluded1(RTCScene scene, RTCRay& query) { rtcOccluded1(scene, &context, &query); }
    void occluded16(const int* valid, RTCScene scene, RTCRay16& query) {
      rtcOccluded16(valid, scene, &context, &query);
    }
    void occluded_stream(RTCScene scene, RTCRay* queries, std::size_t count) {
      rtcOccluded1M(scene, &context, queries, static_cast<unsigned>(count), sizeof *queries);
    }
#else
    RTCIntersectArguments closest;
    RTCOccludedArguments any;

    explicit Arguments(bool coherent) {
      rtcInitIntersectArguments(&closest);
      rtcInitOccludedArguments(&any);
      if (coherent) closest.flags = any.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    }
    void intersect1(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &query, &closest); }
    void intersect16(const int* valid, RTCScene scene, RTCRayHit16& query) {
      rtcIntersect16(valid, scene, &query, &closest);
    }
    void intersect_stream(RTCScene, RTCRayHit*, std::size_t) {}
    void occluded1(RTCScene scene, RTCRay& query) { rtcOccluded1(scene, &query, &any); }
    void occluded16(const int* valid, RTCScene scene, RTCRay16& query) {
      rtcOccluded16(valid, scene, &query, &any);
    }
    void occluded_stream(RTCScene, RTCRay*, std::size_t) {}
#endif
  };

  std::atomic<std::ptrdiff_t> bytes_ = 0;
  RTCDevice device_;
  RTCScene scene_;
};

#else

/// Placeholder if Embree is not installed.
struct Embree {
  static constexpr bool is_there = false, has_streams = false;
  Embree(const std::vector<FloatSphere>&, int) {}
  Embree(const std::vector<protostar::Point>&, const std::vector<std::array<std::uint32_t, 3>>&, int) {}
  [[nodiscard]] std::ptrdiff_t bytes() const { return 0; }
  void closest(Mode, bool, const std::vector<FloatRay>&, std::size_t, std::size_t,
               std::vector<Index>&) const {}
  void any(Mode, bool, const std::vector<FloatRay>&, std::size_t, std::size_t, std::vector<Index>&) const {}
};

#endif

}  // namespace bench
