// Shares runs of stages among workers. Workers have no memory in common, so any static host may serve the page.
import {compiledModule} from '../modules/stages.mjs';

// Thrown by runs that were cancelled.
export class Cancelled extends Error {}

export class Pool {
  constructor(size = Math.min(Math.max(navigator.hardwareConcurrency || 2, 2), 8)) {
    this.workers = Array.from({length: size}, () => ({worker: null, job: null}));
    this.waiting = [];
    this.count = 0;
  }

  get size() { return this.workers.length; }

  // Runs a stage as its program would run. Returns {status, stdout, stderr, files}, as docs/web/stages.mjs describes it, and
  // time, the milliseconds of the run alone.
  run(stage, args, files = {}) {
    return new Promise((resolve, reject) => {
      this.waiting.push({id: ++this.count, stage, args, files, resolve, reject});
      this.next();
    });
  }

  // Ends all runs. A worker cannot be interrupted, only replaced; its module is compiled already.
  cancel() {
    const jobs = this.waiting.splice(0);
    for (const place of this.workers) {
      if (!place.job) continue;
      jobs.push(place.job);
      place.worker?.terminate();
      place.worker = place.job = null;
    }
    for (const job of jobs) job.reject(new Cancelled());
  }

  next() {
    for (const place of this.workers)
      if (!place.job && this.waiting.length) this.start(place, this.waiting.shift());
  }

  async start(place, job) {
    place.job = job;
    const end = settle => {
      if (place.job !== job) return;  // cancelled
      place.job = null;
      settle();
      this.next();
    };
    try {
      const module = await compiledModule(job.stage);  // once for all workers
      if (place.job !== job) return;
      place.worker ??= new Worker(new URL('worker.js', import.meta.url), {type: 'module'});
      place.worker.onmessage = ({data}) => {
        if (data.id === job.id) end(() => data.error ? job.reject(new Error(data.error)) : job.resolve(data.result));
      };
      place.worker.onerror = event => {
        place.worker = null;
        end(() => job.reject(new Error(event.message || 'The worker could not be started.')));
      };
      place.worker.postMessage({id: job.id, stage: job.stage, module, args: job.args, files: job.files});
    } catch (error) {
      end(() => job.reject(error));
    }
  }
}
