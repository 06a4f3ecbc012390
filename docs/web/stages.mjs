// Runs stages in the browser, or in node: each as its program runs, with a command line, files, and an exit status.
//
//   import {loadStage} from './stages.mjs';
//   const stage = await loadStage('09_shadow');
//   const {status, stdout, stderr, files} = stage.run(['--size', '320x240', '-o', 'out.ppm']);
//   files['out.ppm'];  // a Uint8Array
//
// Several stages share a module, which is fetched and compiled once in each page or worker. A page that starts workers
// compiles it once for all of them:
//
//   worker.postMessage({module: await compiledModule('09_shadow')});     // in the page
//   const stage = await loadStage('09_shadow', event.data.module);       // in the worker
//
// A module only draws. Its name with `.explained` is that of one that also explains pixels (--pixel), which is fetched when
// it is asked for, and which draws slowly:
//
//   const explained = await loadStage('09_shadow.explained');
import {fetchBytes} from './fetch_file.mjs';
import {modules} from './modules.mjs';

/// Names of all stages, and 'render', which draws scene files.
export const stageNames = Object.keys(modules);

/// Files that stages read from scenes/.
const filesOf = {'17_mesh': ['knot.obj']};

const folder = new URL('.', import.meta.url);
const compiled = new Map(), loaded = new Set(), instances = new Map();

/// Returns the name of the module that a name stands for, and that of its stage, which has no `.explained` at the end.
function moduleOf(name) {
  const [, stage, explained] = /^(.*?)(\.explained)?$/s.exec(name).map(part => part ?? '');
  if (!(stage in modules)) throw new Error(`no stage is named '${stage}'; the stages are ${stageNames.join(', ')}`);
  return {module: modules[stage] + explained, stage};
}

/// Returns true if compiledModule has the module of a stage.
export const isLoaded = name => loaded.has(moduleOf(name).module);

/// Returns the bytes of a file beside this one.
async function fetched(file) {
  const url = new URL(file, folder);
  if (url.protocol === 'file:') {  // node
    const {readFile} = await import('node:fs/promises');
    return readFile(url);
  }
  return fetchBytes(url);
}

/// Returns the promise under a key, which `make` gives the first time. One that is rejected is made again the next time.
function once(promises, key, make) {
  if (!promises.has(key))
    promises.set(key, make().catch(error => {
      promises.delete(key);
      throw error;
    }));
  return promises.get(key);
}

/// Fetches and compiles the module of a stage, once. Returns the WebAssembly.Module, which may be posted to workers.
export function compiledModule(name) {
  const {module} = moduleOf(name);
  return once(compiled, module, async () => {
    const code = await WebAssembly.compile(await fetched(module + '.wasm'));
    loaded.add(module);
    return code;
  });
}

/// A stage whose module has been instantiated in this page or worker.
class Stage {
  constructor(name, module, instance) {
    this.name = name;
    this.module = module;
    this.instance = instance;
  }

  /// Runs the stage, in a folder that holds these files, texts or Uint8Arrays by their names. Returns the exit status
  /// (as the program's: 0, 1 for a failure, 2 for an error in usage), the texts printed, and all files of the folder
  /// afterwards. Nothing but the memory stays from one run to the next. Throws what WebAssembly throws, such as a
  /// RangeError for memory that the browser refuses; loadStage then gives a new instance.
  run(args, files = {}) {
    const {FS, ccall, printed} = this.instance;
    for (const name of FS.readdir('.')) if (name !== '.' && name !== '..') FS.unlink(name);
    for (const [name, content] of Object.entries(files)) FS.writeFile(name, content);
    printed.out = printed.error = '';
    const words = [this.name, ...args];
    let status;
    try {
      status = ccall('run_stage_named', 'number', ['string', 'number'], [words.join('\0') + '\0', words.length]);
    } catch (error) {
      instances.delete(this.module);
      throw error;
    }
    const result = {};
    for (const name of FS.readdir('.')) if (name !== '.' && name !== '..') result[name] = FS.readFile(name);
    return {status, stdout: printed.out, stderr: printed.error, files: result};
  }
}

async function instantiate(name, module) {
  // The names of temporary files are random. Node has the browsers' source of random numbers by this name from 19 on.
  if (folder.protocol === 'file:') globalThis.crypto ??= (await import('node:crypto')).webcrypto;
  const {default: create} = await import(new URL(name + '.mjs', folder).href);
  const printed = {out: '', error: ''};
  const instance = await new Promise((resolve, reject) => {
    create({
      instantiateWasm(imports, done) {
        WebAssembly.instantiate(module, imports).then(instance => done(instance, module)).catch(reject);
        return {};
      },
      print: line => { printed.out += line + '\n'; },
      printErr: line => { printed.error += line + '\n'; },
    }).then(resolve, reject);
  });
  instance.FS.mkdir('/scenes');
  instance.FS.mkdir('/work');
  instance.FS.chdir('/work');
  instance.printed = printed;
  return instance;
}

/// Returns the stage of a name. Stages of the same module share an instance. `module` is what compiledModule gave to
/// the page; without it the module is fetched.
export async function loadStage(name, module) {
  const {module: key, stage} = moduleOf(name);
  const instance = await once(instances, key, async () => instantiate(key, await (module ?? compiledModule(name))));
  for (const file of filesOf[stage] ?? [])
    if (!instance.FS.analyzePath('/scenes/' + file).exists)
      instance.FS.writeFile('/scenes/' + file, await fetched('scenes/' + file));
  return new Stage(stage, key, instance);
}
