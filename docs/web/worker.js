// Runs stages for pool.js, in a thread of its own: one message is one run of a program.
import {loadStage} from '../modules/stages.mjs';

onmessage = async ({data: {id, stage, module, args, files}}) => {
  try {
    const program = await loadStage(stage, module), start = performance.now();
    const result = program.run(args, files);
    result.time = performance.now() - start;
    postMessage({id, result}, Object.values(result.files).map(file => file.buffer));
  } catch (error) {
    postMessage({id, error: String(error)});
  }
};
