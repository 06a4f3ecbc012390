// Draws the shaders of stages/shaders with WebGL 2, and shows where their pictures differ from exact ones.
//
// A page calls showShader(element, stage, reference); the tests call Shader and difference.
import {fetchText} from './fetch_file.mjs';

// Vertices of one triangle that covers the whole picture, without a buffer: (-1, -1), (3, -1), (-1, 3).
const vertices = `#version 300 es
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }
`;

// Text around a shader. Shadertoy adds such a text, too: the size of the picture, and the call for each pixel.
const before = `#version 300 es
precision highp float;
precision highp int;
uniform vec3 iResolution;
`;
const after = `
out vec4 pixel_color;
void main() { mainImage(pixel_color, gl_FragCoord.xy); }
`;

// A shader of stages/shaders, compiled. It draws pictures of any size.
export class Shader {
  // source is the text of a .frag file. names are those of its numbers that draw() may set, as "OFFSET".
  // Throws an Error with a message for the reader: there is no WebGL 2, or that of the compiler.
  constructor(source, names = []) {
    this.canvas = document.createElement('canvas');
    const options = {alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true};
    const gl = this.gl = this.canvas.getContext('webgl2', options);
    if (!gl) throw new Error('This browser has no WebGL 2, so it cannot draw the shader.');
    const uniforms = names.map(name => `uniform float page_${name};\n#define ${name} page_${name}\n`).join('');
    const program = gl.createProgram();
    gl.attachShader(program, compiled(gl, gl.VERTEX_SHADER, vertices));
    gl.attachShader(program, compiled(gl, gl.FRAGMENT_SHADER, before + uniforms + '#line 1\n' + source + after));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.program = program;
  }

  // Draws a picture on this.canvas, and returns a promise of its pixels: an ImageData, with rows from the top.
  // numbers has a value for each name of the constructor. The picture is drawn in bands of 16 rows, as browsers stop a
  // graphics processor that computes for seconds, and the page answers its reader in between. Only every so many bands
  // are drawn; the alpha of all other pixels is 0.
  async draw(width, height, numbers = {}, every = 1) {
    const gl = this.gl, pixels = new ImageData(width, height), rows = 16;
    this.canvas.width = width;
    this.canvas.height = height;
    gl.viewport(0, 0, width, height);
    gl.enable(gl.SCISSOR_TEST);
    gl.uniform3f(gl.getUniformLocation(this.program, 'iResolution'), width, height, 1);
    for (const [name, value] of Object.entries(numbers))
      gl.uniform1f(gl.getUniformLocation(this.program, 'page_' + name), value);
    for (let top = 0; top < height; top += every * rows) {
      const count = Math.min(rows, height - top), bottom = height - top - count;  // y counts from below in WebGL
      gl.scissor(0, bottom, width, count);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      const upwards = new Uint8Array(width * count * 4);
      gl.readPixels(0, bottom, width, count, gl.RGBA, gl.UNSIGNED_BYTE, upwards);
      for (let y = 0; y < count; ++y) {
        const row = (count - 1 - y) * width * 4;
        pixels.data.set(upwards.subarray(row, row + width * 4), (top + y) * width * 4);
      }
      if (gl.isContextLost()) throw new Error('The browser has stopped the shader, as it took too long.');
      await new Promise(resolve => setTimeout(resolve));
    }
    return pixels;
  }

  // Frees what the graphics processor holds. Browsers keep some sixteen contexts alive at a time.
  close() { this.gl.getExtension('WEBGL_lose_context')?.loseContext(); }
}

function compiled(gl, kind, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

// Compares two pictures of one size, each an ImageData. Pixels whose alpha is 0 in the first are left out. Returns the
// numbers of pixels: compared, differing at all, above_one (by more than one of 255 levels), and elsewhere, those of
// above_one that no edge explains; the largest difference in levels; and an image, the reference in dark gray, with
// differing pixels in blue (one level), orange (an edge) and red (elsewhere).
//
// At an edge, a pixel has found the surface of one of its neighbors: in each channel it lies between the least and the
// greatest value of the reference in the three by three pixels around, or is one level outside of them by rounding.
export function difference(pixels, reference) {
  const {width, height} = pixels, a = pixels.data, b = reference.data;
  if (reference.width !== width || reference.height !== height)
    throw new Error(`pictures of ${width}×${height} and ${reference.width}×${reference.height} pixels are compared`);
  const image = new ImageData(width, height);
  const result = {compared: 0, differing: 0, above_one: 0, elsewhere: 0, largest: 0, image};
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const at = 4 * (y * width + x);
      if (a[at + 3] === 0) continue;
      const levels = Math.max(...[0, 1, 2].map(i => Math.abs(a[at + i] - b[at + i])));
      ++result.compared;
      result.largest = Math.max(result.largest, levels);
      const gray = (b[at] + b[at + 1] + b[at + 2]) / 12;
      let color = [gray, gray, gray];
      if (levels > 0) ++result.differing, color = [90, 140, 255];
      if (levels > 1) {
        ++result.above_one;
        const is_edge = lies_between_neighbors(a, at, b, x, y, width, height);
        if (!is_edge) ++result.elsewhere;
        color = is_edge ? [255, 170, 40] : [255, 50, 50];
      }
      image.data.set([...color, 255], at);
    }
  return result;
}

function lies_between_neighbors(a, at, b, x, y, width, height) {
  for (let i = 0; i < 3; ++i) {
    let least = 255, greatest = 0;
    for (let v = Math.max(y - 1, 0); v <= Math.min(y + 1, height - 1); ++v)
      for (let u = Math.max(x - 1, 0); u <= Math.min(x + 1, width - 1); ++u) {
        const value = b[4 * (v * width + u) + i];
        least = Math.min(least, value);
        greatest = Math.max(greatest, value);
      }
    if (a[at + i] < least - 1 || a[at + i] > greatest + 1) return false;
  }
  return true;
}

// Draws the shader of a stage into an element of a page, beside the pixels that differ from a reference picture, an
// ImageData: how many there are, and the largest difference. numbers has a value for each number of the shader that the
// page sets, as {OFFSET: 0}. folder is the address of the shaders. Says so if the browser cannot draw it.
export async function showShader(element, stage, reference,
                                 {numbers = {}, folder = new URL('shaders/', import.meta.url)} = {}) {
  element.replaceChildren('The shader is drawn …');
  let shader;
  try {
    const source = await fetchText(new URL(`${stage}.frag`, new URL(folder, location.href)));
    shader = new Shader(source, Object.keys(numbers));
    const pixels = await shader.draw(reference.width, reference.height, numbers);
    const found = difference(pixels, reference), all = found.compared;
    element.replaceChildren(
        figure(pixels, "The shader's picture, in float"),
        figure(found.image, `${found.differing} of ${all} pixels differ, by at most ${found.largest} of 255 levels; ` +
                            `${found.above_one} by more than one level: ` +
                            `${found.above_one - found.elsewhere} at edges, ${found.elsewhere} elsewhere`));
    return found;
  } catch (error) {
    element.replaceChildren(error.message);
  } finally {
    shader?.close();
  }
}

function figure(pixels, text) {
  const canvas = document.createElement('canvas'), caption = document.createElement('figcaption');
  canvas.width = pixels.width;
  canvas.height = pixels.height;
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', text);
  canvas.getContext('2d').putImageData(pixels, 0, 0);
  caption.textContent = text;
  const result = document.createElement('figure');
  result.append(canvas, caption);
  return result;
}
