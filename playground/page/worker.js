// The worker: one WebAssembly module that answers questions, one after another.

let exports,
  deadline = Infinity,
  told = 0,
  current = 0;

const host = {
  // A motion says how far it is; the answer is whether to go on.
  go_on(time) {
    const now = performance.now();
    if (now - told > 100) {
      told = now;
      postMessage({ id: current, progress: time });
    }
    return now < deadline ? 1 : 0;
  },
};

const ask = (question) => {
  const bytes = new TextEncoder().encode(JSON.stringify(question));
  const place = exports.room(bytes.length);
  new Uint8Array(exports.memory.buffer, place, bytes.length).set(bytes);
  const length = exports.ask(place, bytes.length);
  return JSON.parse(
    new TextDecoder().decode(new Uint8Array(exports.memory.buffer, exports.answer(), length)),
  );
};

onmessage = async ({ data }) => {
  if (data.module) {
    const made = await WebAssembly.instantiate(data.module, { host });
    exports = (made.exports ? made : made.instance).exports;
    postMessage({ ready: true });
    return;
  }
  current = data.id;
  told = performance.now();
  deadline = data.limit ? told + data.limit : Infinity;
  try {
    postMessage({ id: data.id, answer: ask(data.question) });
  } catch (error) {
    // A trap leaves the module's memory as it fell: this worker answers nothing more.
    postMessage({ id: data.id, broken: String(error) });
  }
};
