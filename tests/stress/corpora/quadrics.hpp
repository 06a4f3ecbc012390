// Corpora of rays and quadrics that are hard cases.
#pragma once

#include <cmath>
#include <protostar/ray.hpp>
#include <protostar/surfaces/quadric.hpp>
#include <protostar/vec3.hpp>
#include <vector>

#include "corpus.hpp"
#include "draws.hpp"
#include "support/random.hpp"

namespace corpora {

using protostar::Point, protostar::Quadric, protostar::QuadricForm, protostar::Vec3;
using QuadricCase = Case<Quadric>;

inline QuadricForm any_form(Random& random) {
  const Vec3 squares = random.point(1), products = random.point(1), linear = random.point(1);
  return {squares, products, linear, random.real(-1, 1)};
}

/// Returns a quadric of any kind and any size.
inline QuadricCase quadrics(Random& random) {
  const double unit = size(random, -10, 10), far = unit * size(random, -3, 3), factor = size(random, -10, 10);
  QuadricForm form = any_form(random);
  form.squares *= factor, form.products *= factor;
  form.linear *= unit * factor, form.constant *= unit * unit * factor;
  const Point origin = random.point(far);
  return {{origin, size(random, -10, 10) * random.direction()}, {form}};
}

/// Returns an ellipsoid or hyperboloid around a point that is far from the coordinate origin, so that nearly
/// all digits cancel.
inline QuadricCase quadrics_far(Random& random) {
  const double far = size(random, 0, 20);
  const Point center = random.point(far);
  QuadricForm form{.squares = {1, random.real(-2, 2), random.real(0.5, 2)}};
  form.linear = -form.squares * center;
  form.constant = dot(form.squares * center, center) - 1;
  const double ahead = size(random, -3, 10);
  return {passing(random, center, random.real(0, 1.2), ahead), {form}};
}

/// Returns a nearly tangent ray, by the choice of the constant.
inline QuadricCase quadrics_tangent(Random& random) {
  QuadricCase c = quadrics(random);
  QuadricForm& form = c.surface.form;
  const Vec3 Md = form.times(c.ray.direction), g = form.times(c.ray.origin) + form.linear;
  const double A = dot(c.ray.direction, Md), b = dot(c.ray.direction, g);
  const double touches = b * b / A - dot(c.ray.origin, g) - dot(form.linear, c.ray.origin);
  form.constant = touches * (1 + tiny(random, 10, 60));
  return c;
}

/// Returns a direction in which the form is linear or nearly so.
inline QuadricCase quadrics_linear(Random& random) {
  QuadricCase c = quadrics(random);
  QuadricForm& form = c.surface.form;
  const Vec3& d = c.ray.direction;
  const double A = dot(d, form.times(d)), z = form.squares.z - A / (d.z * d.z);
  form.squares.z = coin(random) ? z : z * (1 + tiny(random, 10, 60));
  return c;
}

/// Returns small whole numbers: tangent rays, linear forms, rays in the quadric; except for nudges.
inline QuadricCase quadrics_whole(Random& random) {
  const Vec3 squares = whole_vector(random, -2, 2), products = whole_vector(random, -1, 1),
             linear = whole_vector(random, -2, 2);
  QuadricCase c{{whole_vector(random, -3, 3), whole_vector(random, -2, 2)},
                {{squares, products, linear, static_cast<double>(whole(random, -4, 4))}}};
  nudge(random, c.ray.origin), nudge(random, c.surface.form.squares);
  return c;
}

/// Returns a ray that leaves the quadric, in any direction and along it.
inline QuadricCase quadrics_leaving(Random& random) {
  QuadricCase c = coin(random) ? quadrics(random) : quadrics_whole(random);
  QuadricForm& form = c.surface.form;
  const Vec3 Mo = form.times(c.ray.origin);
  form.constant = -dot(c.ray.origin, Mo) - 2 * dot(form.linear, c.ray.origin);
  if (coin(random))
    c.ray.direction = across(random, Mo + form.linear) + tiny(random, 1, 60) * random.direction();
  c.ray.departure = c.surface.departure();
  return c;
}

inline QuadricCase quadrics_exponents(Random& random) {
  QuadricCase c = coin(random)   ? quadrics_tangent(random)
                  : coin(random) ? quadrics_whole(random)
                                 : quadrics_linear(random);
  const int lengths = whole(random, -300, 300), lengthened = whole(random, -600, 600),
            factors = whole(random, -300, 300);
  QuadricForm& form = c.surface.form;
  const double unit = std::ldexp(1, lengths), factor = std::ldexp(1, factors);
  form.squares *= factor, form.products *= factor;
  form.linear *= factor * unit, form.constant *= factor * unit * unit;
  c.ray.origin *= unit, c.ray.direction *= std::ldexp(1, lengthened);
  return c;
}

inline const std::vector<Corpus<Quadric>> of_quadrics{{"quadrics", quadrics},
                                                      {"q. far", quadrics_far},
                                                      {"q. tangent", quadrics_tangent},
                                                      {"q. linear", quadrics_linear},
                                                      {"q. whole", quadrics_whole},
                                                      {"q. leaving", quadrics_leaving},
                                                      {"q. exponents", quadrics_exponents}};

}  // namespace corpora
