// What the book holds, in the order of reading: parts with their pages. A page is a file of the repository; its
// title is its first heading, unless one is given here.

export const PARTS = [
  { title: "Begin", pages: [{ file: "docs/index.md" }, { file: "docs/tutorial.md" }, { file: "README.md", title: "Hodograph in one page" }] },
  {
    title: "How to",
    pages: [
      { file: "docs/playground.md" },
      { file: "docs/editors.md" },
      { file: "docs/cli.md" },
      { file: "docs/contact.md" },
      { file: "docs/doors.md" },
      { file: "docs/python.md" },
      { file: "bindings/python/README.md", title: "Python" },
      { file: "bindings/casadi/README.md", title: "CasADi" },
      { file: "docs/fmu.md" },
      { file: "docs/sweeps.md" },
      { file: "docs/real-time.md" },
      { file: "docs/derivatives.md" },
      { file: "docs/orbits.md" },
      { file: "docs/fits.md" },
    ],
  },
  {
    title: "Reference",
    pages: [
      { file: "docs/language.md" },
      { file: "docs/errors.md" },
      { file: "docs/gallery.md" },
      { file: "docs/module.md" },
      { file: "docs/json.md" },
    ],
  },
  {
    title: "Explanation",
    pages: [
      { file: "docs/solver.md" },
      { file: "docs/theory.md" },
      { file: "docs/assumptions.md" },
      { file: "docs/paper.md" },
      { file: "docs/benchmarks.md" },
      { file: "docs/validation.md" },
      { file: "docs/boards.md" },
      { file: "docs/gpu.md" },
      { file: "docs/worst-case.md" },
      { file: "docs/singles.md" },
      { file: "docs/builds.md" },
    ],
  },
  {
    title: "Take part",
    pages: [
      { file: "CONTRIBUTING.md" },
      { file: "ARCHITECTURE.md" },
      { file: "CHANGELOG.md" },
      { file: "SECURITY.md", title: "Security" },
      { file: "docs/symbolica-licence.md" },
    ],
  },
];

/** Where a page of the repository stands in the book: `docs/contact.md` becomes `docs/contact.html`. */
export const placeOf = (file) =>
  file === "README.md" ? "overview.html" : file.replace(/README\.md$/, "index.html").replace(/\.md$/, ".html");
