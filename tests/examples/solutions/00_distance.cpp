// Solution: how near a line passes to a point.
//
// g++ -O2 -std=c++20 -I../../include 00_distance.cpp -o 00_distance && ./00_distance
#include <cstdio>
#include <protostar/vec3.hpp>
using namespace protostar;

// Returns the distance of p from the line through o in the direction of the unit vector d. The way from o to
// p has a part along the line, and the rest is at a right angle to it.
double distance(Point p, Point o, Vec3 d) {
  const Vec3 way = p - o, along = dot(way, d) * d;
  return length(way - along);
}

int main() {
  const Point eye{0, 0, 0}, center{0, 0, 3};
  for (const double x : {0.0, 0.25, 0.5}) {
    const double found = distance(center, eye, normalize(Vec3{x, 0, 1}));
    std::printf("through (%g, 0, 1): %.3f, so a ball of radius 1 is %s\n", x, found,
                found < 1 ? "hit" : "missed");
  }
}
