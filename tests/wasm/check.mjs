// Draws the picture of each stage by WebAssembly, in node, and compares it with its golden, byte for byte.
//
//   node tests/wasm/check.mjs SITE GOLDEN [NAME...]
//
// SITE is the folder that docs/web/build made, GOLDEN that of the goldens. A name is that of a stage or of a module; without
// names all stages are drawn. The exit status is 1 if anything is not as it should be.
import {existsSync, readFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [site, golden, ...wanted] = process.argv.slice(2);
const {compiledModule, loadStage, stageNames} = await import(pathToFileURL(resolve(site, 'modules/stages.mjs')));
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

/// Returns the pixels of a PFM file of a width, row by row from the top, as the file has them from the bottom.
function rowsOf(file, width, height) {
  const row = 12 * width;
  const pixels = file.subarray(file.length - row * height);
  return Array.from({length: height}, (_, y) => pixels.subarray(row * (height - 1 - y), row * (height - y)));
}

const names = chosen.filter(name => name !== 'render');
for (const name of names) {
  const stage = await loadStage(name);
  const start = performance.now();
  const {status, stdout, stderr, files} = stage.run(['-o', 'out.png']);
  expect(status === 0 && stderr === '', `${name}: status ${status}, ${stderr}`);
  expect(stdout.startsWith('out.png: '), `${name}: no line about the picture but '${stdout}'`);
  expect(equal(files['out.png'], readFileSync(`${golden}/${name}.png`)), `${name}: the picture is not its golden`);
  console.log(`${name}: ${files['out.png']?.length} bytes, ${Math.round(performance.now() - start)} ms`);

  // Workers share a picture: each draws a band of it, and the bands together are the picture.
  const small = ['--size', '96x72', '--quiet', '-o', 'out.pfm'];
  const whole = rowsOf(stage.run(small).files['out.pfm'], 96, 72);
  const bands = [[0, 25], [25, 40], [65, 7]].flatMap(
    ([first, count]) => rowsOf(stage.run([...small, '--crop', `0,${first},96,${count}`]).files['out.pfm'], 96, count));
  expect(whole.every((row, y) => equal(row, bands[y])), `${name}: the bands are not the rows of the picture`);
}

// A run leaves nothing behind: an error, the explanation of a pixel, and then a picture as before.
if (names.length > 0) {
  const [name] = names, stage = await loadStage(name);
  const usage = stage.run(['--size', '0x7']);
  expect(usage.status === 2 && usage.stderr.includes('0x7') && usage.stdout === '', `an error in usage: ${usage.stderr}`);
  const pixel = stage.run(['--pixel', '3,4', '--explain', 'pixel.json']);
  expect(pixel.status === 0 && JSON.parse(Buffer.from(pixel.files['pixel.json'])).pixel !== undefined, 'no explanation');
  const again = stage.run(['-o', 'out.png', '--quiet']);
  expect(equal(again.files['out.png'], readFileSync(`${golden}/${name}.png`)), 'a later run draws another picture');
  expect(Object.keys(again.files).join() === 'out.png', `files of earlier runs are left: ${Object.keys(again.files)}`);
  const absent = stage.run(['-o', 'folder/out.png', '--quiet']);
  expect(absent.status === 1 && absent.stderr.includes('folder/out.png'), `no error for a folder: ${absent.stderr}`);
  expect(await compiledModule(name) instanceof WebAssembly.Module, 'no module that a worker could take');
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
    const {status, stderr, files: {'out.png': picture}} = render.run([`${name}.json`, '-o', 'out.png', '--quiet'], files);
    expect(status === 0 && equal(picture, readFileSync(`${golden}/scenes/${name}.png`)),
           `scenes/${name}.json: status ${status}, ${stderr || 'not its golden'}`);
  }
}
console.log(failures === 0 ? 'all pictures are equal' : `${failures} failures`);
process.exit(failures === 0 ? 0 : 1);
