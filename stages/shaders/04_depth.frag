// The ray tracer as a shader, step 04: the distance of the closest hit as a gray.
//
// Paste the file at https://www.shadertoy.com, or open the page of the stage in a browser.
//
// The page docs/stages/porting.md tells what is different from stages/plain/04_depth.cpp.

const vec3 black = vec3(0), white = vec3(1);

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

// A sphere: the points p with |p - center| = radius.
struct Sphere {
  vec3 center;
  float radius;
};

const Sphere spheres[3] = Sphere[3](
    Sphere(vec3(0, 0, 3), 1.0),          // in the middle
    Sphere(vec3(-1.5, 0, 5), 1.0),       // to the left, behind the first
    Sphere(vec3(0, -1001, 3), 1000.0));  // the ground, large enough to look flat

// The smallest t > 0 at which the ray hits the sphere, or infinity. The point o + t d is on the sphere if
// |o + t d - center|² = radius². With v = o - center, this is the equation a t² + b t + c = 0.
float intersect(Sphere sphere, Ray ray) {
  vec3 v = ray.origin - sphere.center;
  float a = dot(ray.direction, ray.direction);
  float b = 2.0 * dot(ray.direction, v);
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
};

// The closest hit of the ray. If it hits nothing, t stays infinity.
Hit closest_hit(Ray ray) {
  Hit closest = Hit(infinity);
  for (int i = 0; i < 3; ++i) {
    float t = intersect(spheres[i], ray);
    if (t < closest.t) closest = Hit(t);
  }
  return closest;
}

// Step 03: white where the ray hits something.
vec3 binary(Ray ray) { return closest_hit(ray).t < infinity ? white : black; }

// Step 04: the nearer, the lighter; 1 / infinity is as good as 0, black.
vec3 depth(Ray ray) { return 1.0 / closest_hit(ray).t * white; }

void mainImage(out vec4 color, in vec2 pixel) {
  Ray ray = camera_ray(pixel);
  color = vec4(code(depth(ray)), 1);
}
