// The ray tracer as a shader, step 09: shadows, the way that fails: rays start at an offset.
//
// Paste the file at https://www.shadertoy.com, or open the page of the stage in a browser.
//
// The functions are those of stages/naive.hpp, which has float, too.

const vec3 black = vec3(0);
const float pi = 3.14159265358979;

// Turns light, from 0 for black to 1 for white, into what the screen is given, from 0 to 1.
// A screen shows the number x with the light x^2.2, so it is given light^(1/2.2).
vec3 code(vec3 light) { return pow(clamp(light, 0.0, 1.0), vec3(1.0 / 2.2)); }

// How far from the surface a ray starts, in scene units. A page may define another value, or a slider.
#ifndef OFFSET
#define OFFSET 1e-4
#endif

// A ray: the points origin + t · direction with t > 0. The direction has length 1, or nearly.
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

// A sphere: the points p with |p - center| = radius.
struct Sphere {
  vec3 center;
  float radius;
  vec3 color;
};

const Sphere spheres[3] = Sphere[3](
    Sphere(vec3(0, 0, 3), 1.0, vec3(1, 0.3, 0)),              // in the middle
    Sphere(vec3(-1.5, 0, 5), 1.0, vec3(0.2, 0.7, 0.1)),       // to the left, behind the first
    Sphere(vec3(0, -1001, 3), 1000.0, vec3(0.2, 0.4, 0.8)));  // the ground, large enough to look flat

// A light: a point that sends its power, in watts, alike in all directions.
struct Light {
  vec3 position;
  float power;
};

const Light lights[1] = Light[1](Light(vec3(0, 3, 0), 40.0 * pi));

// The smaller of b ± √(b² - c) that is greater than 0, or infinity. Both the difference under the root and b
// minus the root cancel: their leading digits vanish, and the rounding errors of b² and c remain.
float intersect(Sphere sphere, Ray ray) {
  vec3 l = sphere.center - ray.origin;
  float b = dot(ray.direction, l), c = dot(l, l) - sphere.radius * sphere.radius;
  float D = b * b - c;
  if (!(D > 0.0)) return infinity;
  float root = sqrt(D);
  if (b - root > 0.0) return b - root;
  if (b + root > 0.0) return b + root;
  return infinity;
}

// A hit of a ray on a surface.
struct Hit {
  float t;
  vec3 point;
  vec3 normal;  // on the side from which the ray comes
  vec3 color;
};

// The closest hit of the ray. If it hits nothing, t is infinity.
Hit closest_hit(Ray ray) {
  float closest = infinity;
  int number = 0;
  for (int i = 0; i < 3; ++i) {
    float t = intersect(spheres[i], ray);
    if (t < closest) {
      closest = t;
      number = i;
    }
  }
  vec3 point = ray.origin + closest * ray.direction;
  vec3 normal = (point - spheres[number].center) / spheres[number].radius;
  return Hit(closest, point, dot(normal, ray.direction) <= 0.0 ? normal : -normal, spheres[number].color);
}

// Diffuse light with shadows: the shadow ray starts above the surface by the offset, and ends before the light by as
// much.
vec3 shadow(Ray ray, float offset) {
  Hit hit = closest_hit(ray);
  if (hit.t == infinity) return black;
  vec3 to_light = lights[0].position - hit.point;
  float distance = length(to_light), cosine = dot(hit.normal, to_light) / distance;
  if (!(cosine > 0.0)) return black;
  Ray shadow_ray = Ray(hit.point + offset * hit.normal, to_light / distance);
  for (int i = 0; i < 3; ++i)
    if (intersect(spheres[i], shadow_ray) < distance - offset) return black;
  float intensity = 1.0 / (4.0 * pi);
  return hit.color * lights[0].power * (intensity * cosine / (distance * distance));
}

void mainImage(out vec4 color, in vec2 pixel) {
  Ray ray = camera_ray(pixel);
  color = vec4(code(shadow(ray, OFFSET)), 1);
}
