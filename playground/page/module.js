// The WebAssembly module: from the page itself, where it is one file, else from beside it.

const unpacked = (text) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
};

export async function loadModule() {
  const packed = document.getElementById("wasm");
  const bytes = packed ? await unpacked(packed.textContent.trim()) : await (await fetch("hodograph.wasm")).arrayBuffer();
  packed?.remove();
  return WebAssembly.compile(bytes);
}
