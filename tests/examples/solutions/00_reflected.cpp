// Solution: the direction of light behind a mirror.
//
// g++ -O2 -std=c++20 -I../../include 00_reflected.cpp -o 00_reflected && ./00_reflected
#include <cstdio>
#include <protostar/vec3.hpp>
using namespace protostar;

// Turns the part of d along the unit normal n around, and keeps the rest.
Vec3 reflected(Vec3 d, Vec3 n) {
  const Vec3 along = dot(d, n) * n, rest = d - along;
  return rest - along;
}

int main() {
  for (const Vec3 d : {Vec3{1, -1, 0}, Vec3{0, -2, 0}, Vec3{3, 0, 4}}) {
    const Vec3 r = reflected(d, {0, 1, 0});
    std::printf("(%g, %g, %g) becomes (%g, %g, %g); the lengths are %g and %g\n", d.x, d.y, d.z, r.x, r.y,
                r.z, length(d), length(r));
  }
}
