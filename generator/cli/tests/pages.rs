//! Pages in a real browser. They are left out of `cargo test`, which needs none: `cargo test --workspace
//! in_a_browser -- --ignored`.

#[path = "common/browser.rs"]
mod browser;

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{hodograph, tool};

/// Signs of a formula stand beside each other, numerators over denominators, equations below each other.
const EQUATIONS: &str = r#"
const rows = [...document.querySelectorAll('.equation')];
if (!rows.length) complain('there are no equations');
if (!document.querySelectorAll('.matrix mtable').length) complain('there are no matrices');
for (const node of document.querySelectorAll('math')) {
  if (!page.getComputedStyle(node).display.includes('math')) complain(`is laid out as ${page.getComputedStyle(node).display}: ${describe(node)}`);
  const size = box(node);
  if (size.width < 2 || size.height < 4) complain(`is not seen: ${describe(node)}`);
}
const tokens = (node) => [...node.querySelectorAll('mi, mn, mo')].filter((token) => box(token).width > 0.5);
for (const row of rows.concat([...document.querySelectorAll('.matrix')])) {
  const boxes = tokens(row).map((token) => [token, box(token)]);
  boxes.forEach(([a, first], index) => boxes.slice(index + 1).forEach(([b, second]) => {
    const stretched = [a, b].some((token) => token.getAttribute('stretchy') === 'true');
    // The point over a letter stands in its box.
    const accent = [a, b].some((token) => token.parentElement.localName === 'mover');
    if (!stretched && !accent && crossing(first, second, 1)) complain(`${describe(a)} on ${describe(b)} in ${describe(row)}`);
  }));
  for (const fraction of row.querySelectorAll('mfrac')) {
    const [above, below] = [...fraction.children].map(box);
    if (above.bottom > below.top + 1) complain(`the fraction ${describe(fraction)}`);
  }
}
// Numbers in tables are seen to their last digit.
for (const number of document.querySelectorAll('.names mn, .names td:nth-child(3)')) {
  const text = number.lastChild;
  if (!text || text.nodeType !== 3) continue;
  const digit = document.createRange();
  digit.setStart(text, text.length - 1);
  digit.setEnd(text, text.length);
  if (!digit.getClientRects().length || digit.getBoundingClientRect().width < 1) complain(`digits are left out: ${describe(number)}`);
}
rows.forEach((row, index) => {
  const [left, sign, right] = [...row.children].map(box);
  if (left.right > sign.left + 0.5 || sign.right > right.left + 0.5) complain(`the columns of ${describe(row)}`);
  const next = rows[index + 1];
  if (next && crossing(box(row), box(next), 0.5)) complain(`${describe(row)} on ${describe(next)}`);
  if (next && next.parentElement === row.parentElement && Math.abs(box(row.children[1]).left - box(next.children[1]).left) > 0.5) {
    complain(`the sign of ${describe(row)} is not over the next`);
  }
});
for (const link of document.querySelectorAll('nav a')) {
  if (!document.getElementById(link.getAttribute('href').slice(1))) complain(`leads nowhere: ${describe(link)}`);
}
return found;
"#;

/// The shipped models.
fn models() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "mech"));
    paths.sort();
    assert!(paths.len() > 20);
    paths
}

#[test]
#[ignore = "needs Chromium"]
fn equations_are_laid_out_in_a_browser() {
    for path in models() {
        let run = hodograph(&["explain", path.to_str().unwrap(), "--format", "html"], "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let complaints = browser::complaints(&run.stdout, EQUATIONS);
        assert!(complaints.is_empty(), "{}:\n{}", path.display(), complaints.join("\n"));
    }
}

/// The test sees what it is for: with the rule that was there, and with a wide line, it complains.
#[test]
#[ignore = "needs Chromium"]
fn a_spoiled_page_is_noticed_in_a_browser() {
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/two_sleds.mech");
    let page = hodograph(&["explain", model, "--format", "html"], "").stdout;
    for (style, what) in [
        ("math { display: block }", "laid out as block"),
        ("h1 { width: 3000px }", "wider than the window"),
        ("mo { margin-right: -12px }", " on "),
        ("body { background: url(http://example.org/a.png) }", "asks for"),
    ] {
        let spoiled = page.replace("</style>", &format!("{style}</style>"));
        let complaints = browser::complaints(&spoiled, EQUATIONS);
        assert!(complaints.iter().any(|text| text.contains(what)), "{style}: {complaints:?}");
    }
}

/// Run by `cargo test --workspace --tests by_latex -- --ignored`.
#[test]
#[ignore = "needs pdflatex"]
fn equations_are_set_by_latex() {
    for path in models() {
        let run = hodograph(&["explain", path.to_str().unwrap(), "--format", "latex"], "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("equations.tex"), run.stdout).unwrap();
        let set = std::process::Command::new("pdflatex")
            .args(["-interaction=nonstopmode", "-halt-on-error", "equations.tex"])
            .current_dir(folder.path())
            .output()
            .expect("no pdflatex here: install it (Debian: apt-get install texlive-latex-base)");
        assert!(set.status.success(), "{}:\n{}", path.display(), String::from_utf8_lossy(&set.stdout));
    }
}

/// Equations, motions and the playground have one style sheet in common, and motions one drawing.
#[test]
fn written_pages_share_their_style_and_drawing() {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let model = root.join("models/two_sleds.mech");
    let page = folder.path().join("motion.html");
    let tool = || Command::new(tool());
    let equations = tool().args(["explain", "--format", "html"]).arg(&model).output().unwrap();
    let moved =
        tool().args(["simulate", "--until", "0.1", "--html"]).arg(&page).arg(&model).output().unwrap();
    assert!(moved.status.success(), "{}", String::from_utf8_lossy(&moved.stderr));
    let motion = std::fs::read_to_string(&page).unwrap();
    let equations = String::from_utf8(equations.stdout).unwrap();
    for text in [&equations, &motion] {
        assert!(text.contains(hodograph_generator::page::STYLE.trim()));
    }
    let build = std::fs::read_to_string(root.join("playground/build.mjs")).unwrap();
    assert!(build.contains(r#"read(root, "generator", "model", "src", "page.css")"#));
    for script in ["geometry.js", "body.js", "motion.js"] {
        let text = std::fs::read_to_string(root.join("simulation/animation/page").join(script)).unwrap();
        assert!(motion.contains(text.trim()), "{script}");
        assert!(build.contains(&format!("\"{script}\"")), "{script}");
    }
}
