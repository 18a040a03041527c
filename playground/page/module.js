// The WebAssembly module: from the page itself, where it is one file, else from beside it.

const unpacked = (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(
    new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")),
  ).arrayBuffer();
};

const packed = document.getElementById("wasm");

/** The derivation of an example, which the folder has and the one file has not. */
export async function derivationOf(name) {
  if (packed) return "";
  const answer = await fetch(`models/${name}.derivation`).catch(() => null);
  return answer?.ok ? answer.text() : "";
}

export async function loadModule() {
  const bytes = packed
    ? await unpacked(packed.textContent.trim())
    : await (await fetch("hodograph.wasm")).arrayBuffer();
  packed?.remove();
  return WebAssembly.compile(bytes);
}
