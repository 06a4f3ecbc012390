// The part of a page that runs its stage: the picture, the options, and the answer to a pixel.
import {fetchText} from './fetch_file.mjs';
import {Controls, parseHelp} from './options.js';
import {Cancelled, Pool} from './pool.js';
import {MovableScene} from './scene.js';
import {isLoaded} from '../modules/stages.mjs';

const dragLimit = 50;  // milliseconds until a dragged thing is seen where it is

// Returns a PPM file with 8 bits a channel as the pixels of a canvas: binary (P6), or decimal numbers as a text (P3).
function imageOf(file) {
  const head = /^P([36])\s+(\d+)\s+(\d+)\s+255\s/.exec(String.fromCharCode(...file.subarray(0, 40)));
  if (!head) throw new Error('The stage wrote no picture.');
  const image = new ImageData(Number(head[2]), Number(head[3])), body = file.subarray(head[0].length);
  const numbers = head[1] === '6' ? body : new TextDecoder().decode(body).trim().split(/\s+/).map(Number);
  for (let from = 0, to = 0; to < image.data.length; from += 3, to += 4) {
    image.data[to] = numbers[from], image.data[to + 1] = numbers[from + 1], image.data[to + 2] = numbers[from + 2];
    image.data[to + 3] = 255;
  }
  return image;
}

function made(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

const milliseconds = time => time < 10 ? `${time.toFixed(1)} ms` : time < 10000 ? `${time.toFixed(0)} ms`
                                                                             : `${(time / 1000).toFixed(0)} s`;

// The running stage. Its events at the section: `drawn` when the whole picture is on the canvas, `answered` when a pixel is
// explained, `failed` with a message.
class StageView {
  constructor(section) {
    this.section = section;
    this.name = section.dataset.stage;
    this.pool = new Pool();
    this.isDrawn = false;  // the whole picture by these options is on the canvas
    this.drawing = 0;  // number of the picture that is drawn; runs of an older one have no effect
    this.asked = 0;    // number of the last question for a pixel; answers to older ones are not shown
    section.view = this;
  }

  async start() {
    const figure = this.section.querySelector('figure'), image = figure.querySelector('img');
    this.status = made('figcaption', {className: 'status', textContent: 'The stage is loaded.'});
    this.status.setAttribute('role', 'status');
    figure.append(this.status);
    const help = await this.pool.run(this.name, ['--help']);
    const options = parseHelp(help.stdout);
    this.takesCrops = options.some(({name}) => name === '--crop');
    this.controls = new Controls(options, () => this.draw());

    this.canvas = made('canvas', {tabIndex: 0, textContent: image.alt});
    this.canvas.setAttribute('role', 'application');  // so that screen readers pass it the keys
    this.canvas.setAttribute('aria-label', `${image.alt}. Arrow keys move a cursor, Enter asks the pixel below it.`);
    this.cursor = made('div', {className: 'cursor', hidden: true});
    this.frame = made('div', {className: 'frame'}, this.canvas, this.cursor);
    this.resize(...this.controls.size);
    this.canvas.getContext('2d').drawImage(image, 0, 0, this.canvas.width, this.canvas.height);  // until the stage draws
    image.replaceWith(this.frame);
    this.plan = made('img', {className: 'plan', alt: 'The rays of this pixel, from above and from the side', hidden: true});
    figure.append(this.plan);

    this.answer = made('div', {className: 'answer'});
    this.answer.setAttribute('aria-live', 'polite');
    this.tell('Ask a pixel why it has its color: click it.');
    const side = made('div', {className: 'side'}, this.controls.element);
    if (this.section.dataset.scene) side.append(this.mover());
    side.append(this.answer);
    this.section.append(side);
    this.listen();
    await this.draw();
    if (this.section.dataset.scene) await this.loadScene();
  }

  // Name of the program that draws: the stage, or `render` if something was moved.
  get program() { return this.scene?.moved ? 'render' : this.name; }

  // Words and files that `render` gets if something was moved.
  get sceneWords() { return this.scene?.moved ? ['scene.json', '--integrator', this.scene.explanation.integrator] : []; }
  get sceneFiles() { return this.scene?.moved ? {'scene.json': this.scene.text} : {}; }

  // Runs the stage, or `render` with the scene file if something was moved. Throws an Error with what the program says.
  async run(...args) {
    const result = await this.pool.run(this.program, [...this.sceneWords, ...this.controls.args('--size'), ...args],
                                       this.sceneFiles);
    if (result.status !== 0 && !result.files['out.ppm']) throw new Error(result.stderr.trim());
    return result;
  }

  // Shows the command that draws the picture elsewhere. The scene in which something was moved can be saved by its name.
  showCommand() {
    const [file, ...others] = this.sceneWords, behind = [...others, ...this.controls.args()].join(' ');
    const link = file && made('a', {textContent: file, download: file,
                                    href: 'data:application/json,' + encodeURIComponent(this.scene.text)});
    this.controls.command.replaceChildren(`build/stages/${this.program} `, ...(link ? [link, ' '] : []), behind);
  }

  // Draws the picture: first an eighth of the size, then whole, in bands that appear one by one if it takes long.
  async draw() {
    const drawing = ++this.drawing;
    this.pool.cancel();
    this.markAnswer();
    const [width, height] = this.controls.size;
    this.showCommand();
    this.section.classList.add('busy');
    this.isDrawn = false;
    try {
      if (this.controls.wrongSize) await this.run('--size', this.controls.wrongSize);  // the program tells the mistake
      const start = performance.now();
      const small = await this.drawSmall(8);
      if (drawing !== this.drawing) return;
      const first = performance.now() - start;
      // An error is one of the whole picture, so that its samples cannot be drawn in bands.
      const whole = !this.takesCrops || this.controls.has('--error');
      const expected = small.run * 64;
      const bands = whole || expected < 150 ? 1
                  : Math.min(this.pool.size * Math.ceil(expected / this.pool.size / 200), 64, height);
      const lines = [], warnings = new Set();  // such as an error that is not reached
      let done = 0;
      await Promise.all(Array.from({length: bands}, async (_, i) => {
        const from = Math.round(i * height / bands), to = Math.round((i + 1) * height / bands);
        const crop = bands > 1 ? ['--crop', `0,${from},${width},${to - from}`] : [];
        const result = await this.run('--size', `${width}x${height}`, '--threads', '1', ...crop);
        if (drawing !== this.drawing) return;
        this.show(imageOf(result.files['out.ppm']), from, done++ === 0 && bands === 1);
        lines.push(...result.stdout.trim().split('\n').slice(1));
        if (result.stderr.trim()) warnings.add(result.stderr.trim());
        if (done < bands) this.status.textContent = `Drawn: ${done} of ${bands} bands`;
      }));
      if (drawing !== this.drawing) return;
      const time = performance.now() - start;
      this.status.textContent = [`${width} × ${height}: first picture after ${milliseconds(first)}, whole after ` +
                                 `${milliseconds(time)} on ${Math.min(bands, this.pool.size)} ` +
                                 (bands > 1 ? 'workers' : 'worker'), ...this.sums(lines), ...warnings].join('. ');
      this.section.classList.remove('busy');
      this.isDrawn = true;
      this.section.dispatchEvent(new CustomEvent('drawn', {detail: {first, time, bands}}));
    } catch (error) {
      this.failed(error, drawing);
      if (drawing === this.drawing) this.pool.cancel();  // further bands would write over the message
    }
  }

  // Lines that a stage prints about its picture; the counts of wrong pixels of bands are added up, and their ranges of
  // numbers become one. Its mean is left out, as bands do not tell how many numbers they have.
  sums(lines) {
    const ranges = lines.filter(line => !line.endsWith(': none'))
                        .map(line => /^(.*): (\S+) at least, .* (\S+) at most$/.exec(line));
    if (lines.length > 1 && ranges.length && ranges.every(range => range))
      return [`${ranges[0][1]}: ${Math.min(...ranges.map(range => Number(range[2])))} at least, ` +
              `${Math.max(...ranges.map(range => Number(range[3])))} at most`];
    const counts = lines.map(line => /^(\d+) of (\d+) (pixels are wrong)/.exec(line));
    if (!lines.length || counts.some(count => !count)) return lines;
    const sum = i => counts.reduce((total, count) => total + Number(count[i]), 0);
    return [`${sum(1)} of ${sum(2)} ${counts[0][3]}`];
  }

  // Draws the picture at a part of its size. Returns milliseconds: those of the run, and those until it was seen.
  async drawSmall(scale) {
    const start = performance.now(), [width, height] = this.controls.size;
    const [w, h] = [width, height].map(x => Math.max(1, Math.round(x / scale)));
    const result = await this.run('--size', `${w}x${h}`, '--threads', '1');
    const canvas = new OffscreenCanvas(w, h);
    canvas.getContext('2d').putImageData(imageOf(result.files['out.ppm']), 0, 0);
    this.resize(width, height);
    const context = this.canvas.getContext('2d');
    context.imageSmoothingEnabled = false;
    context.drawImage(canvas, 0, 0, width, height);
    // A canvas that is too large for the browser stays empty, and no error is thrown.
    if ((width * height > 1e6 || Math.max(width, height) > 4096) && context.getImageData(0, 0, 1, 1).data[3] === 0)
      throw new Error(`This browser shows no picture of ${width} × ${height} pixels.`);
    this.size = [w, h];
    return {run: result.time, seen: performance.now() - start};
  }

  resize(width, height) {
    this.frame.style.setProperty('--ratio', width / height);
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }

  show(image, row, isWhole) {
    if (isWhole) this.resize(image.width, image.height);
    this.canvas.getContext('2d').putImageData(image, 0, row);
  }

  failed(error, drawing = this.drawing) {
    if (error instanceof Cancelled || drawing !== this.drawing) return;
    this.section.classList.remove('busy');
    this.status.textContent = error.message;
    this.section.dispatchEvent(new CustomEvent('failed', {detail: error.message}));
  }

  tell(text) { this.answer.replaceChildren(made('p', {textContent: text})); }

  // ---- Asking a pixel.

  // Shows why a pixel has its color: the words of --pixel beside the drawing of --rays.
  async ask(x, y) {
    const question = ++this.asked, [width, height] = this.controls.size;
    this.point(x, y);
    if (!isLoaded(this.program + '.explained')) this.tell('The module that explains pixels is being loaded.');
    try {
      const unlessCancelled = error => { if (!(error instanceof Cancelled)) throw error; };
      let result;  // asked for again where a new picture has cancelled the run
      while (!result) {
        // A stage that draws without rays refuses to draw them.
        result = await this.explain(x, y, '--rays', 'rays.svg').catch(error => {
          unlessCancelled(error);
          return this.explain(x, y);
        }).catch(unlessCancelled);
        if (question !== this.asked) return;
        if (String(this.controls.size) !== String([width, height])) throw new Error('The picture has another size now.');
      }
      const except = this.controls.has('--error') ? ' (The samples of --error are left out.)' : '';
      // A line that is too long goes on below its own beginning.
      const lines = result.stdout.replace(/\n$/, '').split('\n').map(line => {
        const element = made('span', {textContent: line + '\n'});
        element.style.setProperty('--indent', /^ */.exec(line)[0].length);
        return element;
      });
      const text = made('pre', {tabIndex: 0}, ...lines);
      const parts = [made('h2', {textContent: `Pixel ${x},${y}` + except}), text];
      this.answer.replaceChildren(...parts);
      const drawing = result.files['rays.svg'];
      this.plan.hidden = !drawing;
      if (drawing) this.plan.src = 'data:image/svg+xml,' + encodeURIComponent(new TextDecoder().decode(drawing));
      this.section.dispatchEvent(new CustomEvent('answered', {detail: {x, y, width, height, text: result.stdout}}));
    } catch (error) {
      if (question !== this.asked) return;
      this.tell(error.message);
      this.plan.hidden = true;
      this.section.dispatchEvent(new CustomEvent('failed', {detail: error.message}));
    }
  }

  // Says of an answer that is shown that something has changed since.
  markAnswer() {
    const title = this.answer.querySelector('h2:not(.earlier)');
    if (!title) return;
    title.classList.add('earlier');
    title.prepend('Before the last change: ');
  }

  // Runs --pixel. It takes no samples by an error. A size that is none is told by the program, as the picture has another
  // size than that of the program.
  async explain(x, y, ...args) {
    const size = this.controls.wrongSize || this.controls.size.join('x');
    const own = this.controls.args('--size', '--error', '--max-samples', '--clamp');
    const result = await this.pool.run(this.program + '.explained',
                                       [...this.sceneWords, ...own, '--size', size, '--pixel', `${x},${y}`, ...args],
                                       this.sceneFiles);
    if (result.status !== 0) throw new Error(result.stderr.trim());
    return result;
  }

  // Returns what --explain tells of a pixel.
  async explanation(x, y) {
    const result = await this.explain(x, y, '--explain', 'pixel.json');
    return JSON.parse(new TextDecoder().decode(result.files['pixel.json']));
  }

  // Puts the cursor on a pixel.
  point(x, y) {
    this.at = [x, y];
    this.cursor.hidden = false;
    this.cursor.style.left = `${100 * (x + 0.5) / this.canvas.width}%`;
    this.cursor.style.top = `${100 * (y + 0.5) / this.canvas.height}%`;
  }

  // ---- Moving spheres and lights.

  mover() {
    this.choice = made('select', {disabled: true});
    this.back = made('button', {type: 'button', textContent: 'Put back', disabled: true});
    this.back.addEventListener('click', () => {
      this.scene.reset();
      this.back.disabled = true;
      this.draw();
    });
    const label = made('label', {}, 'Drag, or move by arrow keys: ', this.choice);
    return made('p', {className: 'line mover'}, label, this.back);
  }

  async loadScene() {
    const address = new URL(this.section.dataset.scene, location.href);
    const text = await fetchText(address);
    let explanation;  // asked for again where a new picture has cancelled the run
    while (!explanation)
      explanation = await this.explanation(0, 0).catch(error => { if (!(error instanceof Cancelled)) throw error; });
    this.scene = new MovableScene(text, explanation);
    this.choice.append(made('option', {value: -1, textContent: 'the sphere in sight'}),
                       ...this.scene.things.map(({name}, i) => made('option', {value: i, textContent: name})));
    this.choice.disabled = false;
    const chosen = () => this.canvas.classList.toggle('moves', this.choice.value >= 0);
    this.choice.addEventListener('change', chosen);
    chosen();
    // Each worker draws once, so that the code of `render` is ready for the first drag.
    for (let i = 0; i < this.pool.size; ++i)
      this.pool.run('render', ['scene.json', '--integrator', this.scene.explanation.integrator, '--size', '40x30'],
                    {'scene.json': text}).catch(() => {});
    this.section.dispatchEvent(new CustomEvent('movable'));
  }

  // Moves a thing, and draws it there. Positions that come while a picture is drawn wait for the next one, together.
  async move(index, right, down) {
    if (this.section.classList.contains('busy')) this.pool.cancel();  // a whole picture would be in the way
    ++this.drawing;
    this.section.classList.remove('busy');
    this.markAnswer();
    this.scene.move(index, right, down, this.canvas.height);
    this.back.disabled = false;
    clearTimeout(this.whole);
    this.again = true;
    if (this.moving) return;
    this.moving = true;
    try {
      this.scale ??= 8;
      while (this.again) {
        this.again = false;
        const time = (await this.drawSmall(this.scale)).seen;
        this.slowest = Math.max(this.slowest ?? 0, time);
        this.status.textContent = `Dragged: ${this.size.join(' × ')} in ${milliseconds(time)} ` +
                                  `(slowest ${milliseconds(this.slowest)} of ${dragLimit} ms)`;
        // The time grows with the number of pixels: aim at half of the limit. An eighth of the size is enough to see.
        this.scale = Math.min(Math.max(this.scale * Math.sqrt(time / (dragLimit / 2)), 8), 40);
      }
    } catch (error) {
      this.failed(error);
    } finally {
      this.moving = false;
    }
    if (!this.held) this.whole = setTimeout(() => this.draw(), 200);
  }

  // ---- Pointer and keys.

  pixelAt(event) {
    const box = this.canvas.getBoundingClientRect();
    const within = (x, size) => Math.min(Math.max(Math.floor(x), 0), size - 1);
    return [within((event.clientX - box.left) / box.width * this.canvas.width, this.canvas.width),
            within((event.clientY - box.top) / box.height * this.canvas.height, this.canvas.height)];
  }

  listen() {
    let start = null;
    this.canvas.addEventListener('pointerdown', event => {
      if (event.button !== 0) return;
      const [x, y] = this.pixelAt(event);
      start = {x, y, last: [x, y], dragged: false, thing: null};
      if (!this.scene) return;
      this.canvas.setPointerCapture(event.pointerId);
      const chosen = Number(this.choice.value), mine = start;
      if (chosen >= 0) mine.thing = chosen;
      else this.explanation(x, y).then(told => { mine.thing = this.scene.seenBy(told); }, () => {});
    });
    this.canvas.addEventListener('pointermove', event => {
      if (!start) return;
      const [x, y] = this.pixelAt(event);
      const near = 4 * this.canvas.width / this.canvas.clientWidth;
      if (!start.dragged && Math.hypot(x - start.x, y - start.y) < near) return;
      start.dragged = this.held = true;
      if (start.thing === null || start.thing < 0) return;
      this.move(start.thing, x - start.last[0], y - start.last[1]);
      start.last = [x, y];
    });
    const end = event => {
      const was = start;
      start = null;
      this.held = false;
      if (!was) return;
      if (!was.dragged && event.type === 'pointerup') this.ask(was.x, was.y);
      else if (was.thing >= 0 && was.thing !== null && !this.moving) this.whole = setTimeout(() => this.draw(), 50);
    };
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);

    this.canvas.addEventListener('keydown', event => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;  // keys of the browser, such as Alt and an arrow
      const way = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
      if (way) {
        event.preventDefault();
        const step = event.shiftKey ? 16 : 1, chosen = Number(this.choice?.value ?? -1);
        if (this.scene && chosen >= 0) return this.move(chosen, 4 * step * way[0], 4 * step * way[1]);
        const [x, y] = this.at ?? [this.canvas.width >> 1, this.canvas.height >> 1];
        const within = (value, size) => Math.min(Math.max(value, 0), size - 1);
        this.point(within(x + step * way[0], this.canvas.width), within(y + step * way[1], this.canvas.height));
      } else if (event.key === 'Enter' || event.key === ' ') {
        event.preventDefault();
        this.ask(...(this.at ?? [this.canvas.width >> 1, this.canvas.height >> 1]));
      }
    });
  }
}

// Compares the picture with that of the stage's shader, in the part of the page that is for it, when the user asks for it.
// The numbers of the stage alone, such as --offset, are numbers of the shader, such as OFFSET.
function offerShader(section, view) {
  const button = made('button', {type: 'button', textContent: 'Draw it by the shader, and compare'});
  const result = made('div', {className: 'pictures'});
  button.addEventListener('click', async () => {
    const {canvas, controls} = view;
    const others = controls.options.filter(({name, meta}) => meta !== 'X' && name !== '--size' && controls.has(name));
    if (others.length)
      return result.replaceChildren(`The shader has no ${others.map(({name}) => name).join(' and no ')}: ` +
                                    `leave the field${others.length > 1 ? 's' : ''} empty.`);
    if (view.scene?.moved || !view.isDrawn)
      return result.replaceChildren('Only a whole picture is compared, in which nothing is moved.');
    const {showShader} = await import('./shader.js');
    const numbers = Object.fromEntries(controls.options.filter(({meta}) => meta === 'X').map(({name, byDefault}) =>
        [name.slice(2).toUpperCase().replaceAll('-', '_'), Number(controls.fields.get(name).value || byDefault)]));
    button.disabled = true;
    try {
      await showShader(result, view.name, canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height),
                       {numbers, folder: new URL('.', new URL(section.dataset.shader, location.href))});
    } finally {
      button.disabled = false;
    }
  });
  section.append(made('p', {}, button, ' This stage is also a shader for the graphics processor, which computes in float.'),
                 result);
}

for (const section of document.querySelectorAll('section.stage')) {
  const view = new StageView(section);
  view.start().catch(error => view.failed(error)).then(() => {
    const shader = document.querySelector('section.shader');
    if (shader && view.controls) offerShader(shader, view);
  });
}
