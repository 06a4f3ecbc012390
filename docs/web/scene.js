// A scene file whose spheres and lights can be moved.

// Vectors are arrays of three numbers.
const minus = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);

export class MovableScene {
  // `text` is the scene file, `explanation` that of any pixel of its picture (--explain), which knows the camera.
  constructor(text, explanation) {
    this.original = text;
    this.explanation = explanation;
    this.reset();
  }

  reset() {
    this.scene = JSON.parse(this.original);
    this.moved = false;
    const spheres = this.scene.objects.filter(({surface}) => surface.type === 'sphere').map(({surface}) => surface);
    const lights = (this.scene.lights ?? []).filter(({position}) => position);
    this.things = [...spheres.map((thing, i) => ({thing, name: `sphere ${i}`})),
                   ...lights.map((thing, i) => ({thing, name: `light ${i}`}))];
  }

  get text() { return JSON.stringify(this.scene); }

  // Index of the thing that a pixel sees first, by the explanation of the pixel; -1 if that is nothing that moves.
  seenBy(explanation) {
    const ray = explanation.samples[0].rays[0];
    if (!ray) return -1;
    // A search for all hits takes several; the surface with the smallest t comes first.
    const hits = ray.considered.filter(({t}) => t.length).sort((a, b) => a.t[0] - b.t[0]);
    const surface = explanation.surfaces[typeof ray.taken === 'number' ? ray.taken : hits[0]?.surface];
    return surface?.type !== 'sphere' ? -1 :
        this.things.findIndex(({thing}) => thing.position.every((x, i) => x === surface.center[i]) && 'radius' in thing);
  }

  // Moves a thing by so many pixels to the right and down, in the plane through its center that is parallel to the film.
  // A pixel there is as large as the distance from the camera makes it: a ray through film point (u, v) has the direction
  // forward + u right + v up, and v goes from 1 to -1 over the height of the picture. A light beside or behind the camera
  // moves as if it were as far in front of it.
  move(index, right, down, height) {
    const {camera} = this.explanation, {thing} = this.things[index];
    const offset = minus(thing.position, camera.position);
    const along = dot(offset, camera.forward) / dot(camera.forward, camera.forward);
    const depth = along > 0.01 ? along : Math.hypot(...offset) || 1;
    thing.position = thing.position.map((x, i) =>
        x + 2 * depth / height * (right * camera.right[i] - down * camera.up[i]));
    this.moved = true;
  }
}
