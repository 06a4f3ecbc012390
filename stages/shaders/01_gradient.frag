// The ray tracer as a shader, step 01: a gradient from black to white.
//
// Paste the file at https://www.shadertoy.com, or open the page of the stage in a browser.
//
// The page docs/stages/porting.md tells what is different from stages/plain/01_gradient.cpp.

void mainImage(out vec4 color, in vec2 pixel) {
  float light = floor(pixel.x) / (iResolution.x - 1.0);  // 0 on the left, 1 on the right
  color = vec4(light, light, light, 1);
}
