// Points whose coordinates have the number type that a field is evaluated with.
//
//   const auto torus = [](const auto& p) {
//     const auto ring = length(Vec2{p.x, p.z}) - 1.0;
//     return length(Vec2{ring, p.y}) - 0.3;
//   };
//
// p is a FieldPoint<T>, and T one of Plain<R>, Enclosure<B>, Slope<Enclosure<B>> and Variation. All functions
// of them are found by their arguments, with or without `using namespace protostar`. Numbers of a formula may
// be doubles, and offsets and sizes may be a Vec3.
#pragma once

#include <type_traits>

#include "../vec3.hpp"

namespace protostar::inline PROTOSTAR_ABI {

/// Vector of two numbers: a point of a plane or of a profile.
template <class T>
struct Vec2 {
  T x, y;

  friend Vec2 operator-(const Vec2& a) { return {-a.x, -a.y}; }
  friend Vec2 operator+(const Vec2& a, const Vec2& b) { return {a.x + b.x, a.y + b.y}; }
  friend Vec2 operator-(const Vec2& a, const Vec2& b) { return {a.x - b.x, a.y - b.y}; }
  friend Vec2 operator+(const Vec2& a, const Uv& b) { return {a.x + b.x, a.y + b.y}; }
  friend Vec2 operator-(const Vec2& a, const Uv& b) { return {a.x - b.x, a.y - b.y}; }
  friend Vec2 operator*(const Vec2& a, const T& b) { return {a.x * b, a.y * b}; }
  friend Vec2 operator*(const T& a, const Vec2& b) { return b * a; }

  friend Vec2 abs(const Vec2& a) { return {abs(a.x), abs(a.y)}; }
  friend Vec2 min(const Vec2& a, const T& b) { return {min(a.x, b), min(a.y, b)}; }
  friend Vec2 max(const Vec2& a, const T& b) { return {max(a.x, b), max(a.y, b)}; }

  friend T dot(const Vec2& a, const Vec2& b) { return a.x * b.x + a.y * b.y; }
  friend T dot(const Vec2& a, const Uv& b) { return a.x * b.x + a.y * b.y; }
  friend T length(const Vec2& a) {
    const T v[] = {a.x, a.y};
    return length_of(v);
  }

  /// Returns the length of the part outside the quadrant without positive components, or the largest
  /// component inside, where it is negative: the signed distance from the quadrant.
  friend T signed_length(const Vec2& a) {
    const T v[] = {a.x, a.y};
    return signed_length_of(v);
  }
};
template <class A, class B>
Vec2(A, B) -> Vec2<std::common_type_t<A, B>>;

/// Point or vector of three numbers.
template <class T>
struct FieldPoint {
  T x, y, z;

  friend FieldPoint operator-(const FieldPoint& a) { return {-a.x, -a.y, -a.z}; }
  friend FieldPoint operator+(const FieldPoint& a, const FieldPoint& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend FieldPoint operator-(const FieldPoint& a, const FieldPoint& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend FieldPoint operator+(const FieldPoint& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend FieldPoint operator-(const FieldPoint& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend FieldPoint operator*(const FieldPoint& a, const T& b) { return {a.x * b, a.y * b, a.z * b}; }
  friend FieldPoint operator*(const T& a, const FieldPoint& b) { return b * a; }
  friend FieldPoint operator*(const FieldPoint& a, const Vec3& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
  }

  friend FieldPoint abs(const FieldPoint& a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
  friend FieldPoint fold(const FieldPoint& a) { return {fold(a.x), fold(a.y), fold(a.z)}; }
  friend FieldPoint min(const FieldPoint& a, const T& b) { return {min(a.x, b), min(a.y, b), min(a.z, b)}; }
  friend FieldPoint max(const FieldPoint& a, const T& b) { return {max(a.x, b), max(a.y, b), max(a.z, b)}; }

  friend T dot(const FieldPoint& a, const FieldPoint& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend T dot(const FieldPoint& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend T length(const FieldPoint& a) {
    const T v[] = {a.x, a.y, a.z};
    return length_of(v);
  }

  /// Returns the length of the part outside the octant without positive components, or the largest
  /// component inside, where it is negative: the signed distance from the octant. A box of half sides s is
  /// signed_length(abs(p) - s).
  friend T signed_length(const FieldPoint& a) {
    const T v[] = {a.x, a.y, a.z};
    return signed_length_of(v);
  }
};
template <class A, class B, class C>
FieldPoint(A, B, C) -> FieldPoint<std::common_type_t<A, B, C>>;

}  // namespace protostar::inline PROTOSTAR_ABI
