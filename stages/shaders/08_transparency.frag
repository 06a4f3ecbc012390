// The ray tracer as a shader, step 08: spheres of colored glass, through which a ray goes on.
//
// Paste the file at https://www.shadertoy.com, or open the page of the stage in a browser.
//
// The page docs/stages/porting.md tells what is different from stages/plain/08_transparency.cpp.

const vec3 black = vec3(0), white = vec3(1);
const float pi = 3.14159265358979;

// Turns light, from 0 for black to 1 for white, into what the screen is given, from 0 to 1.
// A screen shows the number x with the light x^2.2, so it is given light^(1/2.2).
vec3 code(vec3 light) { return pow(clamp(light, 0.0, 1.0), vec3(1.0 / 2.2)); }

// The number that stands for no sphere: in a ray that leaves none, and in the hit of a ray that misses.
const int none = -1;

// A ray: the points origin + t · direction with t > 0. The direction has length 1, so t is the distance.
// A ray from a hit leaves the sphere there, whose number is leaves.
struct Ray {
  vec3 origin;
  vec3 direction;
  int leaves;
};

// The ray from the eye, at (0, 0, 0), through the middle of a pixel of the picture, which stands at z = 1.
// There v is 1 at the upper edge of the picture and -1 at the lower edge, and u is 0 in the middle.
Ray camera_ray(vec2 pixel) {
  float u = (2.0 * pixel.x - iResolution.x) / iResolution.y;
  float v = (2.0 * pixel.y - iResolution.y) / iResolution.y;
  return Ray(vec3(0), normalize(vec3(u, v, 1)), none);
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

// The smallest t > 0 at which the ray hits the sphere, or infinity. The point o + t d is on the sphere if
// |o + t d - center|² = radius². With v = o - center, this is the equation a t² + b t + c = 0.
// A ray that leaves the sphere starts on it, so c is 0, though its rounded value may not be. The equation is
// t (a t + b) = 0 then: one solution is 0, where the ray starts, and the other one is -b / a.
float intersect(Sphere sphere, Ray ray, bool leaves) {
  vec3 v = ray.origin - sphere.center;
  float a = dot(ray.direction, ray.direction);
  float b = 2.0 * dot(ray.direction, v);
  if (leaves) return b < 0.0 ? -b / a : infinity;
  float c = dot(v, v) - sphere.radius * sphere.radius;

  float D = b * b - 4.0 * a * c;
  if (D < 0.0) return infinity;  // no solution: the ray misses
  // The solutions are q / 2a and 2c / q. No nearly equal numbers are subtracted in q: a float has few digits to lose.
  float q = b < 0.0 ? sqrt(D) - b : -sqrt(D) - b;
  float t1 = min(q / (2.0 * a), 2.0 * c / q);       // the ray enters the sphere
  float t2 = max(q / (2.0 * a), 2.0 * c / q);       // the ray leaves the sphere
  return t1 > 0.0 ? t1 : t2 > 0.0 ? t2 : infinity;  // the first one that is ahead
}

// A hit of a ray on a surface.
struct Hit {
  float t;  // the distance along the ray
  vec3 point;
  vec3 normal;  // the direction at a right angle to the surface there, of length 1
  vec3 color;
  int sphere;  // its number
};

// The closest hit of the ray. If it hits nothing, t stays infinity.
Hit closest_hit(Ray ray) {
  Hit closest = Hit(infinity, vec3(0), vec3(0), black, none);
  for (int i = 0; i < 3; ++i) {
    Sphere sphere = spheres[i];
    float t = intersect(sphere, ray, i == ray.leaves);
    if (t < closest.t) {
      vec3 point = ray.origin + t * ray.direction;
      closest = Hit(t, point, 1.0 / sphere.radius * (point - sphere.center), sphere.color, i);
    }
  }
  return closest;
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

// Step 08: white light comes from behind, and each surface lets its color through. The ray starts again
// behind each hit. Three spheres have six hits at most; the loop ends after ten, whatever goes wrong.
vec3 transparency(Ray ray) {
  vec3 light = white;
  for (int i = 0; i < 10; ++i) {
    Hit hit = closest_hit(ray);
    if (hit.t == infinity) break;
    light = light * hit.color;
    ray.origin = hit.point;
    ray.leaves = hit.sphere;
  }
  return light;
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
  color = vec4(code(transparency(ray)), 1);
}
