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
        if (!data.broken) return settle(data.id, data.answer);
        settle(data.id, { fault: `the computation broke off (${data.broken}): please report this model` });
        restart();
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
  /** Asks the present worker; the time of a question runs from here. */
  const post = async (id) => {
    await ready;
    const asked = open.get(id);
    if (!asked) return;
    const late = () => {
      settle(id, { fault: "this took too long and was stopped" });
      restart();
    };
    clearTimeout(asked.timer);
    if (asked.limit) asked.timer = setTimeout(late, 1.5 * asked.limit + 2000);
    worker.postMessage({ id, question: asked.question, limit: asked.limit });
  };
  /** Another worker answers what is still open. */
  const restart = () => {
    worker.terminate();
    for (const asked of open.values()) clearTimeout(asked.timer);
    begin();
    for (const id of open.keys()) post(id);
  };
  begin();
  return {
    /** The answer. After `limit` milliseconds a motion is told to end; where it does not, the worker is ended a while later. */
    ask(question, { limit = 0, progress } = {}) {
      const id = ++number;
      const answer = new Promise((done) => open.set(id, { done, progress, question, limit, timer: 0 }));
      post(id);
      return answer;
    },
    /** Ends what is being computed: its questions are answered by nothing. */
    drop() {
      if (!open.size) return;
      for (const id of [...open.keys()]) settle(id, null);
      restart();
    },
  };
}
