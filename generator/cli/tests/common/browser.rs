//! Loads pages in headless Chromium together with a script, and returns what the script reports.

use std::path::PathBuf;
use std::process::Command;

/// Widths of a laptop's window and of a phone's.
pub const WIDTHS: [u32; 2] = [1366, 390];

/// The browser: `HODOGRAPH_CHROMIUM`, or one of the usual names.
fn browser() -> PathBuf {
    let named = std::env::var_os("HODOGRAPH_CHROMIUM").map(PathBuf::from);
    let folders: Vec<PathBuf> = std::env::var_os("PATH").iter().flat_map(std::env::split_paths).collect();
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let known = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let found = named.into_iter().chain(known).find(|path| path.is_file());
    found.expect(
        "no Chromium here: install it (Debian: apt-get install chromium), or name it by HODOGRAPH_CHROMIUM",
    )
}

/// Shows a page in windows of [`WIDTHS`] and runs `script` in each, where `page` is its window; `script` is
/// the body of an asynchronous function and returns a list of complaints. Gives all complaints.
pub fn complaints(page: &str, script: &str) -> Vec<String> {
    // A browser for each: without a window, it draws no second page at the times it should.
    WIDTHS.iter().flat_map(|&width| complaints_at(width, page, script)).collect()
}

fn complaints_at(width: u32, page: &str, script: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let text = |text: &str| serde_json::to_string(text).unwrap().replace('<', "\\u003c");
    let wrapper = format!(
        "<!DOCTYPE html><meta charset=\"utf-8\"><body><script>
        const html = {};
        const check = new (Object.getPrototypeOf(async () => {{}}).constructor)('page', 'document', 'wait', {});
        const wait = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));
        (async () => {{
          const frame = document.createElement('iframe');
          frame.style = 'border:0;width:{width}px;height:900px';
          const loaded = new Promise((done) => frame.addEventListener('load', done));
          frame.srcdoc = html;
          document.body.append(frame);
          await loaded;
          const page = frame.contentWindow;
          let all;
          try {{
            const found = await check(page, page.document, wait);
            const requests = page.performance.getEntriesByType('resource').map((entry) => `asks for ${{entry.name}}`);
            all = found.concat(requests).map((text) => `at {width}: ${{text}}`);
          }} catch (error) {{ all = [`at {width}: ${{error}}`]; }}
          const result = document.createElement('pre');
          result.id = 'result';
          result.textContent = JSON.stringify(all);
          document.body.replaceChildren(result);
        }})();
        </script></body>",
        text(&page.replacen("<script", &format!("{FRAMES}<script"), 1)),
        text(&format!("{SHARED}\n{script}")),
    );
    let path = folder.path().join("page.html");
    std::fs::write(&path, wrapper).unwrap();
    let profile = folder.path().join("profile");
    let output = Command::new(browser())
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1500,1000"])
        // Whatever is asked for by name does not exist.
        .args(["--host-resolver-rules=MAP * ~NOTFOUND", "--virtual-time-budget=20000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("file://{}", path.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let result = dom.split("<pre id=\"result\">").nth(1).and_then(|rest| rest.split("</pre>").next());
    let result = result
        .unwrap_or_else(|| panic!("no answer from the browser: {}", String::from_utf8_lossy(&output.stderr)));
    let result = result.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    serde_json::from_str(&result).unwrap_or_else(|error| panic!("{error}: {result}"))
}

/// Frames by the clock: without a window the browser need not draw any, and a page that waits for one would
/// wait for ever.
const FRAMES: &str = "<script>window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 16);</script>";

/// What holds for every page: nothing is wider than the window unless it scrolls by itself.
const SHARED: &str = r#"
const found = [];
const complain = (text) => { if (found.length < 20) found.push(text); };
const box = (node) => node.getBoundingClientRect();
const describe = (node) => `${node.localName}.${node.getAttribute('class') || ''} ${(node.textContent || '').slice(0, 40)}`;
const scrolls = (node) => {
  for (let at = node.parentElement; at && at !== document.body; at = at.parentElement) {
    if (['auto', 'scroll', 'hidden'].includes(page.getComputedStyle(at).overflowX)) return true;
  }
  return false;
};
if (document.documentElement.scrollWidth > page.innerWidth) complain('the page is wider than the window');
for (const node of document.body.querySelectorAll('*')) {
  if (box(node).right > page.innerWidth + 0.5 && !node.closest('svg svg, svg *') && !scrolls(node)) complain(`wider than the window: ${describe(node)}`);
}
const crossing = (a, b, by) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > by && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > by;
if (!document.documentElement.lang || !document.title || document.querySelectorAll('h1').length !== 1) complain('language, title or heading is missing');
"#;
