// What a page of the book does beyond showing itself: models that run in place, the search, the list of pages.

import MiniSearch from "minisearch";

const root = document.currentScript?.dataset.root ?? ".";

// A model opens in the playground, below the place where it stands.
for (const button of document.querySelectorAll("a.run")) {
  button.setAttribute("role", "button");
  button.setAttribute("aria-expanded", "false");
  let frame = null;
  const toggle = (event) => {
    event.preventDefault();
    if (frame) {
      frame.remove();
      frame = null;
    } else {
      frame = document.createElement("iframe");
      frame.className = "live";
      frame.title = "The model in the playground";
      frame.src = button.href;
      (button.closest(".wide") ?? button).after(frame);
    }
    button.setAttribute("aria-expanded", String(Boolean(frame)));
    button.textContent = frame ? "Close" : button.dataset.name;
  };
  button.dataset.name = button.textContent;
  // Opened in another tab, the address is the playground's with this model.
  button.addEventListener("click", (event) => {
    if (!event.ctrlKey && !event.metaKey && !event.shiftKey && event.button === 0) toggle(event);
  });
  button.addEventListener("keydown", (event) => event.key === " " && toggle(event));
}

// The list of pages is closed on a phone, where it stands before the text.
const pages = document.querySelector("#pages details");
const narrow = matchMedia("(max-width: 50rem)");
const fold = () => (pages.open = !narrow.matches);
narrow.addEventListener("change", fold);
fold();

// The search loads what it searches when it is asked for the first time: as a script, which also a page from disk may.
const field = document.getElementById("search"),
  found = document.getElementById("found");
let index = null;
const load = () =>
  (index ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = `${root}/search.js`;
    script.onload = () =>
      resolve(
        MiniSearch.loadJS(globalThis.hodographSearch, {
          fields: ["title", "text"],
          storeFields: ["title", "page", "place"],
        }),
      );
    script.onerror = () => reject(new Error("search.js is missing"));
    document.head.append(script);
  }));
const show = async () => {
  const words = field.value.trim();
  if (!words) return (found.hidden = true);
  const all = (await load()).search(words, { prefix: true, fuzzy: 0.15, boost: { title: 3 }, combineWith: "AND" });
  if (field.value.trim() !== words) return;
  found.replaceChildren(
    ...all.slice(0, 12).map((one) => {
      const item = document.createElement("li"),
        link = document.createElement("a"),
        where = document.createElement("small");
      link.href = `${root}/${one.place}`;
      link.textContent = one.title;
      where.textContent = one.page;
      link.append(where);
      item.append(link);
      return item;
    }),
  );
  if (!all.length) found.textContent = "nothing found";
  found.hidden = false;
};
field.addEventListener("focus", load, { once: true });
field.addEventListener("input", show);
addEventListener("keydown", (event) => {
  if (event.key === "/" && !/^(INPUT|TEXTAREA|SELECT)$/.test(document.activeElement.tagName)) {
    event.preventDefault();
    field.focus();
  }
  if (event.key === "Escape") found.hidden = true;
});
document.addEventListener("click", (event) => {
  if (!event.target.closest("search")) found.hidden = true;
});
