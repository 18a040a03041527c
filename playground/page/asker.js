// Asks a worker, which is replaced where it does not answer in time or breaks.

/** A worker with the module; `code` is its script. */
export function asker(code, module) {
  let worker,
    ready,
    number = 0;
  const open = new Map();
  const begin = () => {
    const url = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
    worker = new Worker(url);
    ready = new Promise((done) => {
      worker.onmessage = ({ data }) => {
        if (data.ready) return done();
        const asked = open.get(data.id);
        if (!asked) return;
        if (data.progress !== undefined) return asked.progress?.(data.progress);
        if (data.broken) restart();
        settle(
          data.id,
          data.broken
            ? { fault: `the computation broke off (${data.broken}): please report this model` }
            : data.answer,
        );
      };
    });
    worker.postMessage({ module });
    URL.revokeObjectURL(url);
  };
  const settle = (id, answer) => {
    const asked = open.get(id);
    open.delete(id);
    clearTimeout(asked?.timer);
    asked?.done(answer);
  };
  const restart = () => {
    worker.terminate();
    begin();
  };
  begin();
  return {
    /** The answer. After `limit` milliseconds a motion is told to end; where it does not, the worker is ended a while later. */
    async ask(question, { limit = 0, progress } = {}) {
      const id = ++number;
      const answer = new Promise((done) => {
        const late = () => {
          restart();
          settle(id, { fault: "this took too long and was stopped" });
        };
        open.set(id, { done, progress, timer: limit ? setTimeout(late, 1.5 * limit + 2000) : 0 });
      });
      await ready;
      if (open.has(id)) worker.postMessage({ id, question, limit });
      return answer;
    },
    /** Ends what is being computed: its questions are answered by nothing. */
    drop() {
      if (!open.size) return;
      restart();
      for (const id of [...open.keys()]) settle(id, null);
    },
  };
}
