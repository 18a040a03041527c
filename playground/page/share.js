// A model in the address of the page: after the `#`, so that no server sees it.

const packed = async (bytes, stream) =>
  new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
const letters = (bytes) =>
  btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""))
    .replace(/\+/g, "-")
    .replace(/\//g, "_")
    .replace(/=+$/, "");
const bytesOf = (text) =>
  Uint8Array.from(atob(text.replace(/-/g, "+").replace(/_/g, "/")), (letter) => letter.charCodeAt(0));

/** Largest model that is read from an address, in bytes. */
const MOST = 1 << 20;

/** The fragment that holds what is shared. */
export async function toFragment(shared) {
  const bytes = new TextEncoder().encode(JSON.stringify(shared));
  return "#m=" + letters(await packed(bytes, new CompressionStream("deflate-raw")));
}

/** What a fragment holds: an object with the text of the model; nothing where it holds none. */
export async function fromFragment(fragment) {
  const found = /^#m=([\w-]+)$/.exec(fragment);
  if (!found) return null;
  try {
    const bytes = await packed(bytesOf(found[1]), new DecompressionStream("deflate-raw"));
    const shared = bytes.length > MOST ? null : JSON.parse(new TextDecoder().decode(bytes));
    const isText = (text) => typeof text === "string";
    return shared && isText(shared.text) && Object.values(shared.files ?? {}).every(isText) ? shared : null;
  } catch {
    return null;
  }
}
