// Where `hodograph serve` serves the page: the model of the file, and each change of it.

/** How often the file is asked for, in milliseconds. */
const PAUSE = 400;

/** The model that is served with the page; nothing elsewhere. `onChange` is told of each other one. */
export async function watchFile(onChange) {
  if (!document.documentElement.hasAttribute("data-served")) return null;
  const get = async (after) => {
    const answer = await fetch(`model?after=${after}`, { cache: "no-store" });
    return answer.status === 200 ? answer.json() : null;
  };
  const file = await get("");
  let version = file?.version || "";
  const look = async () => {
    try {
      const next = document.hidden ? null : await get(version);
      if (next) {
        version = next.version;
        onChange(next);
      }
    } catch {
      // The server has ended, or begins anew: the page stays as it is.
    }
    setTimeout(look, PAUSE);
  };
  setTimeout(look, PAUSE);
  return file;
}
