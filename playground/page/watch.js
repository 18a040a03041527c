// Where `hodograph serve` serves the page: the model of the file, and each change of it.

/** The model that is served with the page; nothing elsewhere. `onChange` is told of a new text. */
export async function watchFile(onChange) {
  if (!document.documentElement.hasAttribute("data-served")) return null;
  const get = async (after) => {
    const answer = await fetch(`model?after=${encodeURIComponent(after)}`, { cache: "no-store" });
    return answer.status === 200 ? answer.json() : null;
  };
  const file = await get("");
  (async () => {
    let version = file?.version || "";
    for (;;) {
      try {
        const next = await get(version);
        if (next) { version = next.version; onChange(next); }
      } catch {
        await new Promise((done) => setTimeout(done, 2000));
      }
    }
  })();
  return file;
}
