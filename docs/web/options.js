// The options of a stage as controls of a page. They are read from the program's own --help, so that no second list has
// to be kept.

// Returns the options in the text of --help: {name, meta, help, byDefault} each, in the order of the text. `meta` stands
// for the value, such as N; it is empty for options that take none.
export function parseHelp(text) {
  const options = [];
  for (const line of text.slice(text.indexOf('\nOptions:')).split('\n')) {
    const start = /^  (-\S+)(?: (\S+))?(?:  +(.*))?$/.exec(line);
    if (start) options.push({name: start[1].split(',').pop(), meta: start[2] ?? '', help: start[3] ?? ''});
    else if (options.length && /^ {3,}\S/.test(line)) options.at(-1).help += ' ' + line.trim();
  }
  for (const option of options) {
    option.help = option.help.trim();
    option.byDefault = /\[([^\]]*)\]$/.exec(option.help)?.[1] ?? '';
    option.help = option.help.replace(/ \[[^\]]*\]$/, '');
  }
  return options;
}

// Options of files, machines and single pixels, which the page sets or leaves alone.
const ofThePage = new Set(['--threads', '--crop', '--pixel', '--time', '--bits']);
const isShown = ({name, meta}) => meta && !/^FILE|^I\/N/.test(meta) && !ofThePage.has(name);

// Options that stand at the top: those of the stage alone, whose value is called X, and how much work is done.
const isMain = ({name, meta}) => meta === 'X' || ['--show', '--samples', '--error'].includes(name);

// Names that a text lists, as in "Where samples are: independent, halton or sobol", also without "or"; none if it lists none.
function namesIn(help) {
  const list = /: ((?:[\w-]+, )+[\w-]+|(?:[\w-]+, )*[\w-]+ or [\w-]+)$/.exec(help);
  return list ? list[1].split(/, | or /) : [];
}

const sizeIn = text => /^([1-9]\d*)x([1-9]\d*)$/.exec(text);

function made(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

// Form with the options of a stage. It calls `changed` when the user has changed one.
export class Controls {
  constructor(options, changed) {
    this.options = options.filter(isShown).sort((a, b) => (b.meta === 'X') - (a.meta === 'X'));  // the stage's own first
    this.fields = new Map();
    this.element = made('form', {className: 'controls'});
    this.element.setAttribute('aria-label', 'Options');
    const rest = made('details', {}, made('summary', {textContent: 'More options'}));
    for (const option of this.options) (isMain(option) ? this.element : rest).append(this.row(option));
    this.command = made('code', {className: 'command'});
    const again = made('button', {type: 'reset', textContent: 'Defaults'});
    this.element.append(rest, made('p', {className: 'line'}, this.command, again));
    this.element.addEventListener('change', changed);
    this.element.addEventListener('submit', event => { event.preventDefault(); changed(); });
    this.element.addEventListener('reset', () => setTimeout(changed));
  }

  row(option) {
    const names = option.meta === 'NAME' ? namesIn(option.help) : [];
    const field = names.length ? made('select', {}, made('option', {value: '', textContent: option.byDefault || 'default'}),
                                      ...names.map(name => made('option', {textContent: name})))
                               : made('input', {type: 'text', placeholder: option.byDefault, size: 8, autocomplete: 'off'});
    field.inputMode = 'NEX'.includes(option.meta) ? 'decimal' : 'text';
    field.name = option.name;
    this.fields.set(option.name, field);
    const row = made('label', {}, made('code', {textContent: option.name}), field);
    if (option.meta === 'X') row.append(this.slider(option, field));
    row.append(made('small', {textContent: option.help}));
    return row;
  }

  // A slider for a small length: its places are powers of ten.
  slider(option, field) {
    const slider = made('input', {type: 'range', min: -9, max: 0, step: 0.25});
    const byDefault = Math.log10(Number(option.byDefault)) || -4;
    slider.defaultValue = slider.value = byDefault;
    slider.setAttribute('aria-label', `${option.name}, as a power of ten`);
    slider.addEventListener('input', () => { field.value = Number(10 ** slider.value).toPrecision(2).replace(/\.0(?=e|$)/, ''); });
    field.addEventListener('input', () => { if (Number(field.value) > 0) slider.value = Math.log10(Number(field.value)); });
    return slider;
  }

  // The arguments that the user has set; without those in `except`.
  args(...except) {
    return [...this.fields].filter(([name, field]) => field.value.trim() && !except.includes(name))
                           .flatMap(([name, field]) => [name, field.value.trim()]);
  }

  has(name) { return this.fields.get(name)?.value.trim() !== '' && this.fields.has(name); }

  // Width and height of the picture; those of the program if the user's are none.
  get size() {
    const size = sizeIn(this.fields.get('--size').value.trim()) ??
                 sizeIn(this.options.find(({name}) => name === '--size').byDefault);
    return [Number(size[1]), Number(size[2])];
  }

  // The user's text for a size that is none; otherwise empty.
  get wrongSize() {
    const text = this.fields.get('--size').value.trim();
    return sizeIn(text) ? '' : text;
  }
}
