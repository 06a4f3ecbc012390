// The ray tracer as a shader, step 35: shapes that flow into each other.
//
// Paste the file at https://www.shadertoy.com, or open the page of the stage in a browser.
//
// The page docs/stages/porting.md tells what is different from stages/plain/35_blend.cpp.

const vec3 black = vec3(0), white = vec3(1);
const float pi = 3.14159265358979;

// Turns light, from 0 for black to 1 for white, into what the screen is given, from 0 to 1.
// A screen shows the number x with the light x^2.2, so it is given light^(1/2.2).
vec3 code(vec3 light) { return pow(clamp(light, 0.0, 1.0), vec3(1.0 / 2.2)); }

// A ray: the points origin + t · direction with t > 0. The direction has length 1, so t is the distance.
struct Ray {
  vec3 origin;
  vec3 direction;
};

// The ray from the eye, at (0, 0, 0), through the middle of a pixel of the picture, which stands at z = 1.
// There v is 1 at the upper edge of the picture and -1 at the lower edge, and u is 0 in the middle.
Ray camera_ray(vec2 pixel) {
  float u = (2.0 * pixel.x - iResolution.x) / iResolution.y;
  float v = (2.0 * pixel.y - iResolution.y) / iResolution.y;
  return Ray(vec3(0), normalize(vec3(u, v, 1)));
}

// The t of a ray that hits nothing.
const float infinity = 1e30;

// A light: a point that sends its power, in watts, alike in all directions.
struct Light {
  vec3 position;
  float power;
};

const Light lights[1] = Light[1](Light(vec3(-2, 4, 0), 100.0 * pi));

// An interval: all numbers from lo to hi. Each operation has a result that contains those of all numbers of
// its operands.
struct Interval {
  float lo, hi;
};

// Makes an interval a little wider. Sums and products of floats are wrong by less than 2^-23 of the result,
// whether the processor rounds up or down, and the widening is rounded as well; the least normal number makes up
// for results that are nearly 0, as smaller ones may become 0.
Interval widened(float lo, float hi) {
  const float share = 2.4e-7, tiny = 1.2e-38;  // a little more than 2^-22 and 2^-126
  return Interval(lo - share * abs(lo) - tiny, hi + share * abs(hi) + tiny);
}

// Makes the interval of a quotient or a root wider. GLSL ES lets a quotient be wrong by 2.5 units of the last
// digit, and a root by 2 more, as it may be computed as 1 divided by inversesqrt.
Interval widened_more(float lo, float hi) {
  const float share = 9.6e-7, tiny = 1.2e-38;  // a little more than 2^-20 and 2^-126
  return Interval(lo - share * abs(lo) - tiny, hi + share * abs(hi) + tiny);
}

Interval negative(Interval a) { return Interval(-a.hi, -a.lo); }
Interval sum(Interval a, Interval b) { return widened(a.lo + b.lo, a.hi + b.hi); }
Interval difference(Interval a, Interval b) { return sum(a, negative(b)); }
Interval product(Interval a, Interval b) {
  float w = a.lo * b.lo, x = a.lo * b.hi, y = a.hi * b.lo, z = a.hi * b.hi;
  return widened(min(min(w, x), min(y, z)), max(max(w, x), max(y, z)));
}
Interval square(Interval a) {
  float near = a.lo > 0.0 ? a.lo : a.hi < 0.0 ? a.hi : 0.0, most = max(-a.lo, a.hi);
  return widened(near * near, most * most);
}
Interval root(Interval a) { return widened_more(sqrt(max(a.lo, 0.0)), sqrt(max(a.hi, 0.0))); }
Interval join(Interval a, Interval b) { return Interval(min(a.lo, b.lo), max(a.hi, b.hi)); }

// A number that changes along the ray, over an interval of t: all of its values, and all of its slopes, which
// are its derivatives by t. A constant has the slope 0.
struct Number {
  Interval value, slope;
};

Number number(float constant) { return Number(Interval(constant, constant), Interval(0.0, 0.0)); }

// An interval around 1, to pay for the rounding of a factor: that of a quotient as well.
const Interval one = Interval(1.0 - 9.6e-7, 1.0 + 9.6e-7);

Number sum(Number a, Number b) { return Number(sum(a.value, b.value), sum(a.slope, b.slope)); }
Number difference(Number a, Number b) { return Number(difference(a.value, b.value), difference(a.slope, b.slope)); }
Number less(Number a, float b) { return difference(a, number(b)); }
Number negative(Number a) { return Number(negative(a.value), negative(a.slope)); }

// The smaller number has its own slope where it is surely smaller, and otherwise one of both.
Number smaller(Number a, Number b) {
  if (a.value.hi < b.value.lo) return a;
  if (b.value.hi < a.value.lo) return b;
  return Number(Interval(min(a.value.lo, b.value.lo), min(a.value.hi, b.value.hi)), join(a.slope, b.slope));
}

Number larger(Number a, Number b) { return negative(smaller(negative(a), negative(b))); }
Number absolute(Number a) { return larger(a, negative(a)); }

// The smooth minimum of two numbers.
Interval smooth_min(float x, float y, float width) {
  Interval least = Interval(min(x, y), min(x, y));
  Interval gap = product(Interval(abs(x - y), abs(x - y)), one), rest = difference(Interval(width, width), gap);
  if (rest.hi <= 0.0) return least;
  return difference(least, product(product(Interval(0.25 / width, 0.25 / width), one), square(rest)));
}

// A minimum without a kink: while a and b differ by less than the width, it goes from the one to the other
// along a parabola. It grows with a and with b, so its least value is that of their least values. Its slope
// is a mean of both slopes, with weights from 0 to 1.
Number smooth_min(Number a, Number b, float width) {
  Interval b_less_a = product(product(Interval(0.5 / width, 0.5 / width), one), difference(b.value, a.value));
  Interval share = sum(Interval(0.5, 0.5), b_less_a);
  Interval weight = Interval(clamp(share.lo, 0.0, 1.0), clamp(share.hi, 0.0, 1.0));
  Interval rest = difference(Interval(1.0, 1.0), weight);
  return Number(Interval(smooth_min(a.value.lo, b.value.lo, width).lo, smooth_min(a.value.hi, b.value.hi, width).hi),
                sum(product(weight, a.slope), product(rest, b.slope)));
}

// A point whose coordinates are such numbers.
struct Place {
  Number x, y, z;
};

Place difference(Place p, vec3 c) { return Place(less(p.x, c.x), less(p.y, c.y), less(p.z, c.z)); }

// The length √(x² + y² + z²) has the slope (x x' + y y' + z z') / length, and no length changes faster than
// its vector.
Number length_of(Number x, Number y, Number z) {
  Interval value = root(sum(sum(square(x.value), square(y.value)), square(z.value)));
  float most = root(sum(sum(square(x.slope), square(y.slope)), square(z.slope))).hi;
  Interval slope = Interval(-most, most);
  if (value.lo > 0.0) {
    Interval xy = sum(product(x.value, x.slope), product(y.value, y.slope));
    Interval quotient = product(sum(xy, product(z.value, z.slope)), widened_more(1.0 / value.hi, 1.0 / value.lo));
    slope = Interval(max(slope.lo, quotient.lo), min(slope.hi, quotient.hi));
  }
  return Number(value, slope);
}

// A ball, as a field: greater than 0 outside, 0 on the surface, less than 0 inside.
Number ball(Place p, vec3 center, float radius) {
  Place v = difference(p, center);
  return less(length_of(v.x, v.y, v.z), radius);
}

// The field of the surface with a number. GLSL has no pointers to functions, so an if stands for each.
Number field_of(int i, Place p) {
  if (i == 0) return sum(p.y, number(1.0));  // the ground
  Number drop = ball(p, vec3(-1.3, -0.3, 3), 0.6);  // balls that flow together
  drop = smooth_min(drop, ball(p, vec3(-0.3, 0.3, 3.2), 0.5), 0.8);
  drop = smooth_min(drop, ball(p, vec3(0.6, -0.2, 2.8), 0.6), 0.8);
  drop = smooth_min(drop, ball(p, vec3(1.5, 0.5, 3.4), 0.45), 0.8);
  return smooth_min(drop, ball(p, vec3(0.4, 1.2, 3.2), 0.35), 0.8);
}

const int surfaces = 2;

vec3 color_of(int i) { return i == 0 ? vec3(0.2, 0.4, 0.8) : vec3(1, 0.3, 0); }

// The field of the scene: for each point, that of the nearest surface.
Number field(Place p) {
  Number result = number(infinity);
  for (int i = 0; i < surfaces; ++i) result = smaller(result, field_of(i, p));
  return result;
}

// A coordinate along the ray from t = lo to t = hi.
Number coordinate(float o, float d, float lo, float hi) {
  return Number(sum(Interval(o, o), product(Interval(lo, hi), Interval(d, d))), Interval(d, d));
}

// The field along the ray from t = lo to t = hi: an interval with all of its values, and one with all slopes.
Number along(Ray ray, float lo, float hi) {
  return field(Place(coordinate(ray.origin.x, ray.direction.x, lo, hi),
                     coordinate(ray.origin.y, ray.direction.y, lo, hi),
                     coordinate(ray.origin.z, ray.direction.z, lo, hi)));
}

// The direction in which the field grows fastest: its slopes along x, y and z.
vec3 normal_at(vec3 p) {
  vec3 slopes;
  for (int i = 0; i < 3; ++i) {
    Interval all = along(Ray(p, vec3(i == 0, i == 1, i == 2)), 0.0, 0.0).slope;
    slopes[i] = (all.lo + all.hi) / 2.0;
  }
  return normalize(slopes);
}

// The number of the surface that is nearest to a point.
int nearest(vec3 p) {
  Place place = Place(number(p.x), number(p.y), number(p.z));
  int result = 0;
  float least = infinity;
  for (int i = 0; i < surfaces; ++i) {
    float value = field_of(i, place).value.lo;
    if (value < least) {
      least = value;
      result = i;
    }
  }
  return result;
}

// The t at which a ray ends.
const float far = 1000.0;

// Returns true if there is no surface from t = lo to t = hi. The field is known at both ends, and from
// there it changes by the way times one of its slopes: from the left end, and from the right end backwards.
bool is_free(Ray ray, float lo, float hi, Number over) {
  if (over.value.lo > 0.0) return true;
  Interval way = Interval(0.0, widened(0.0, hi - lo).hi);
  if (sum(along(ray, lo, lo).value, product(way, over.slope)).lo > 0.0) return true;
  return difference(along(ray, hi, hi).value, product(way, over.slope)).lo > 0.0;
}

// The most steps of each loop below: a browser stops a shader that computes for seconds. No ray needs as many.
const int most_steps = 1000;

// Halves an interval of t in which the field falls from above 0 to below 0, as long as it tells on
// which side the middle lies. Returns the middle of what is left.
float halved(Ray ray, float lo, float hi) {
  float middle = (lo + hi) / 2.0;
  for (int i = 0; i < most_steps; ++i) {
    Interval there = along(ray, middle, middle).value;
    if (middle <= lo || middle >= hi || (there.lo <= 0.0 && there.hi >= 0.0)) break;
    if (there.lo > 0.0) lo = middle;
    else hi = middle;
    middle = (lo + hi) / 2.0;
  }
  return middle;
}

// Returns the t of the first surface along the ray, or infinity if there is none. All that is passed over is
// free, and a hit is where the field falls from above 0 to below 0.
float march(Ray ray) {
  float t = 0.0, way = 1.0;
  for (int i = 0; i < most_steps && t < far; ++i) {
    float next = t + way;
    Number over = along(ray, t, next);
    if (is_free(ray, t, next, over)) {
      t = next;
      way = 2.0 * way;
    } else if (over.slope.hi <= 0.0 && along(ray, next, next).value.hi < 0.0) {
      return halved(ray, t, next);
    } else {
      way = way / 2.0;
      if (t + way == t) return t;  // undecided: no number is left between t and the next one
    }
  }
  return infinity;
}

// A hit of a ray on a surface.
struct Hit {
  float t;  // the distance along the ray
  vec3 point;
  vec3 normal;  // the direction at a right angle to the surface there, of length 1
  vec3 color;
};

// The closest hit of the ray. If it hits nothing, t is infinity.
Hit closest_hit(Ray ray) {
  float t = march(ray);
  if (t == infinity) return Hit(infinity, vec3(0), vec3(0), black);
  vec3 point = ray.origin + t * ray.direction;
  return Hit(t, point, normal_at(point), color_of(nearest(point)));
}

// The normal on the side from which the ray comes.
vec3 facing(vec3 normal, Ray ray) {
  return dot(normal, ray.direction) <= 0.0 ? normal : -1.0 * normal;
}

// Step 03: white where the ray hits something.
vec3 binary(Ray ray) { return closest_hit(ray).t < infinity ? white : black; }

// Step 04: the nearer, the lighter; 1 / infinity is as good as 0, black.
vec3 depth(Ray ray) { return 1.0 / closest_hit(ray).t * white; }

// Step 05: the normal's x, y and z, from -1 to 1, as red, green and blue from 0 to 1.
vec3 normals(Ray ray) {
  Hit hit = closest_hit(ray);
  return hit.t < infinity ? 0.5 * hit.normal + 0.5 * white : black;
}

// Step 06: the color of the surface.
vec3 flat_color(Ray ray) {
  Hit hit = closest_hit(ray);
  return hit.t < infinity ? hit.color : black;
}

// Step 07: the light that a matte surface sends on.
// A lamp of power P brings P / (4π distance²) to a surface that faces it, and less by the cosine of the angle
// to one that is tilted.
vec3 diffuse(Ray ray) {
  Hit hit = closest_hit(ray);
  if (hit.t == infinity) return black;
  vec3 normal = facing(hit.normal, ray);
  vec3 sum = black;
  for (int i = 0; i < 1; ++i) {
    vec3 to_light = lights[i].position - hit.point;
    float distance = length(to_light), cosine = dot(normal, to_light) / distance;
    if (cosine <= 0.0) continue;  // the light is behind the surface
    sum = sum + lights[i].power * cosine / (4.0 * pi * distance * distance) * hit.color;
  }
  return sum;
}

void mainImage(out vec4 color, in vec2 pixel) {
  Ray ray = camera_ray(pixel);
  color = vec4(code(diffuse(ray)), 1);
}
