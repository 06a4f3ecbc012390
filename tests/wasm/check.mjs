// Draws the picture of each stage by WebAssembly, in node, and compares it with its golden, byte for byte. The modules that
// explain pixels draw it too.
//
//   node tests/wasm/check.mjs SITE GOLDEN [NAME...]
//
// SITE is the folder that docs/web/build made, GOLDEN that of the goldens. A name is that of a stage or of a module; without
// names all stages are drawn. The exit status is 1 if anything is not as it should be.
import {existsSync, readFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {readPng, readPpm} from './pictures.mjs';

const [site, golden, ...wanted] = process.argv.slice(2);
const {compiledModule, isLoaded, loadStage, stageNames} = await import(pathToFileURL(resolve(site, 'modules/stages.mjs')));
const {modules} = await import(pathToFileURL(resolve(site, 'modules/modules.mjs')));
const chosen = wanted.length === 0 ? stageNames
  : stageNames.filter(name => wanted.includes(name) || wanted.includes(modules[name]));
if (chosen.length === 0) throw new Error(`no stage or module is named ${wanted.join(', ')}`);
let failures = 0;

function expect(condition, message) {
  if (condition) return;
  console.log(`FAILED: ${message}`);
  ++failures;
}

const equal = (a, b) => a && b && Buffer.compare(Buffer.from(a), Buffer.from(b)) === 0;

/// Returns true if a PPM file shows the pixels of a PNG file.
function isPicture(file, path) {
  const picture = file && readPpm(file), golden = readPng(readFileSync(path));
  return picture?.width === golden.width && picture.height === golden.height && equal(picture.pixels, golden.pixels);
}

/// Returns the pixels of a PFM file of a width, row by row from the top, as the file has them from the bottom.
function rowsOf(file, width, height) {
  const row = 12 * width;
  const pixels = file.subarray(file.length - row * height);
  return Array.from({length: height}, (_, y) => pixels.subarray(row * (height - 1 - y), row * (height - y)));
}

// Numbers have the digits that printf gives them: write_decimal of docs/web/small_library.cpp, with halves to even digits.
const source = readFileSync(new URL('../../docs/web/small_library.cpp', import.meta.url), 'utf8');
const writeDecimal = new Function('number', 'digits', 'is_fixed', `let shown; const stringToUTF8 = text => { shown = text; }, to = 0, size = 0;
  {${/int is_fixed\), \{([^]*?)\n\}\)/.exec(source)[1]}} return shown;`);
for (const [number, digits, general, fixed] of [
  [0, 6, '0', '0.000000'], [-0, 2, '-0', '-0.00'], [0.5, 0, '0.5', '0'], [1.5, 0, '2', '2'], [2.5, 1, '2', '2.5'],
  [0.0078125, 4, '0.007812', '0.0078'], [999999.5, 6, '1e+06', '999999.500000'], [999998.5, 6, '999998', '999998.500000'],
  [0.0001, 6, '0.0001', '0.000100'], [0.00001, 2, '1e-05', '0.00'], [-123456.789, 9, '-123456.789', '-123456.789000000'],
  [0.1, 17, '0.10000000000000001', '0.10000000000000001'], [5e-324, 17, '4.9406564584124654e-324', '0.00000000000000000'],
  [1e23, 17, '9.9999999999999992e+22', '99999999999999991611392.00000000000000000'], [100, 3, '100', '100.000'],
  [Infinity, 2, 'inf', 'inf'], [-Infinity, 2, '-inf', '-inf'], [NaN, 2, 'nan', 'nan']]) {
  expect(writeDecimal(number, digits, false) === general, `${number} by %.${digits}g: ${writeDecimal(number, digits, false)}`);
  expect(writeDecimal(number, digits, true) === fixed, `${number} by %.${digits}f: ${writeDecimal(number, digits, true)}`);
}

const names = chosen.filter(name => name !== 'render');
for (const name of names) {
  const stage = await loadStage(name);
  const start = performance.now();
  const {status, stdout, stderr, files} = stage.run([]);
  expect(status === 0 && stderr === '', `${name}: status ${status}, ${stderr}`);
  expect(/^out\.ppm: .* in \d+\.\d\d ms, written in \d+\.\d\d ms\n/.test(stdout), `${name}: no line about the picture but '${stdout}'`);
  expect(isPicture(files['out.ppm'], `${golden}/${name}.png`), `${name}: the picture is not its golden`);
  console.log(`${name}: ${files['out.ppm']?.length} bytes, ${Math.round(performance.now() - start)} ms`);

  // Workers share a picture: each draws a band of it, and the bands together are the picture.
  const small = ['--size', '96x72', '--quiet', '-o', 'out.pfm'];
  const whole = rowsOf(stage.run(small).files['out.pfm'], 96, 72);
  const bands = [[0, 25], [25, 40], [65, 7]].flatMap(
    ([first, count]) => rowsOf(stage.run([...small, '--crop', `0,${first},96,${count}`]).files['out.pfm'], 96, count));
  expect(whole.every((row, y) => equal(row, bands[y])), `${name}: the bands are not the rows of the picture`);
}

// A run leaves nothing behind: an error, and then a picture as before.
if (names.length > 0) {
  const [name] = names, stage = await loadStage(name);
  const usage = stage.run(['--size', '0x7']);
  expect(usage.status === 2 && usage.stderr.includes('0x7') && usage.stdout === '', `an error in usage: ${usage.stderr}`);
  const again = stage.run(['--quiet']);
  expect(isPicture(again.files['out.ppm'], `${golden}/${name}.png`), 'a later run draws another picture');
  expect(Object.keys(again.files).join() === 'out.ppm', `files of earlier runs are left: ${Object.keys(again.files)}`);
  const absent = stage.run(['-o', 'folder/out.ppm', '--quiet']);
  expect(absent.status === 1 && /folder\/out.ppm.*No such file/.test(absent.stderr), `no error for a folder: ${absent.stderr}`);
  for (const [what, ...args] of [['a PNG', '-o', 'out.png'], ['a shard', '--shard', '0/2', '-o', 'a.shard'],
                                 ['a checkpoint', '--checkpoint', 'state', '--samples', '4'], ['a pixel', '--pixel', '3,4']]) {
    const refused = stage.run(args);
    expect(refused.status > 0 && refused.stderr.includes(args[0]), `no error for ${what}: ${refused.status} ${refused.stderr}`);
  }
  for (const number of ['1e400', '1e-400', '1e', '1.5.2', '0x2', 'inf', '-'])
    expect(stage.run(['--clamp', number]).status === 2, `--clamp takes ${number}`);
  const [first, ...others] = ['2.2', '22e-1', '02.20000000000000017763568394002504646778106689453125'].map(
    gamma => stage.run(['--size', '96x72', '--quiet', '--transfer', `gamma=${gamma}`]).files['out.ppm']);
  expect(others.every(other => equal(first, other)), 'numbers that are equal are not read as equal');
  expect(await compiledModule(name) instanceof WebAssembly.Module, 'no module that a worker could take');
  expect(isLoaded(name), 'a module that is not loaded when it has been run');
}

// Modules that explain pixels, where they are built, draw the same pictures.
for (const name of names.filter(name => existsSync(resolve(site, `modules/${modules[name]}.explained.wasm`)))) {
  const stage = await loadStage(`${name}.explained`);
  const pixel = stage.run(['--pixel', '3,4', '--explain', 'pixel.json']);
  expect(pixel.status === 0 && JSON.parse(Buffer.from(pixel.files['pixel.json'])).pixel !== undefined,
         `${name}: no explanation but ${pixel.stderr}`);
  const small = ['--size', '96x72', '--quiet', '-o', 'out.pfm'];
  expect(equal(stage.run(small).files['out.pfm'], (await loadStage(name)).run(small).files['out.pfm']),
         `${name}: the module that explains draws another picture`);
}
let refused = '';
await loadStage('00_nothing').catch(error => { refused = error.message; });
expect(refused.includes('00_nothing') && refused.includes('09_shadow'), `a stage that is not there: ${refused}`);

// Scene files, where their module is built: with the files they name.
if (chosen.includes('render')) {
  const scenes = resolve(golden, '../../scenes');
  const render = await loadStage('render');
  for (const name of ['glass', 'csg', 'mesh', 'normal_map', 'environment', 'fields', 'torus']) {
    const files = {};
    for (const file of [`${name}.json`, 'knot.obj', 'bricks.png', 'dusk.hdr'])
      if (existsSync(`${scenes}/${file}`)) files[file] = readFileSync(`${scenes}/${file}`);
    const {status, stderr, files: {'out.ppm': picture}} = render.run([`${name}.json`, '--quiet'], files);
    expect(status === 0 && isPicture(picture, `${golden}/scenes/${name}.png`),
           `scenes/${name}.json: status ${status}, ${stderr || 'not its golden'}`);
  }
}
console.log(failures === 0 ? 'all pictures are equal' : `${failures} failures`);
process.exit(failures === 0 ? 0 : 1);
