// Runs stages for pool.js, in a thread of its own: one message is one run of a program.
import {loadStage} from '../modules/stages.mjs';

onmessage = async ({data: {id, stage, module, args, files}}) => {
  try {
    const result = (await loadStage(stage, module)).run(args, files);
    postMessage({id, result}, Object.values(result.files).map(file => file.buffer));
  } catch (error) {
    postMessage({id, error: String(error)});
  }
};
