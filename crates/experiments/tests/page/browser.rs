//! The page in a browser without a window: Chromium, from the variable `CHROMIUM` or the path; skipped where there is none.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::Bench;
use super::devtools::Browser;

/// Uses the page and notes what came of it.
const PROBE: &str = include_str!("probe.js");
/// The longest that a small page may take to load, ms: ten times what it takes, for machines with other things to do.
const MAX_LOAD: f64 = 5000.0;

/// The browser, if there is one; or says so.
fn chromium() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM").filter(|path| !path.is_empty()) {
        return Some(path.into());
    }
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let mut paths = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let found = paths.find(|path| path.is_file() && !is_snap(path));
    if found.is_none() {
        // Where even stderr is closed, nobody misses it.
        let _ = writeln!(io::stderr(), "skipped: there is no Chromium on the path; CHROMIUM names one");
    }
    found
}

/// Whether it is run by snap, in whose cage no other program's temporary files can be seen: by a link, or by a script that asks for it.
fn is_snap(path: &Path) -> bool {
    let target = fs::canonicalize(path).unwrap_or_default();
    let is_script = fs::metadata(path).is_ok_and(|metadata| metadata.len() < 10_000);
    let asks_for_it = || fs::read_to_string(path).is_ok_and(|script| script.contains("/snap/bin/"));
    target.starts_with("/snap") || target.ends_with("bin/snap") || is_script && asks_for_it()
}

/// Where a browser finds a file.
fn url_of(path: &Path) -> String {
    let path = path.display().to_string();
    format!("file://{}", path.replace('%', "%25").replace('#', "%23").replace('?', "%3F"))
}

#[test]
fn it_works_in_a_browser() {
    let Some(chromium) = chromium() else { return };
    let bench = Bench::get();
    bench.page("browser.html", &[]);
    let url = url_of(&bench.path("browser.html"));
    for (width, height, scheme) in [(1280, 900, "light"), (390, 844, "dark")] {
        let mut browser = Browser::start(&chromium);
        let is_phone = width < 500;
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone });
        browser.call("Emulation.setDeviceMetricsOverride", metrics);
        let scheme = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        browser.call("Emulation.setEmulatedMedia", scheme);
        browser.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": PROBE }));
        browser.call("Page.navigate", json!({ "url": url }));
        // The page of before may still be there when it is first asked.
        let found = browser.wait_for(
            "new Promise((tell) => { const ask = () => globalThis.probe?.drives ? probe.result.then(tell) : setTimeout(ask, 50); ask(); })",
        );
        assert_eq!(found["failed"], json!([]), "{width} pixels");
        assert!(found["drives"].as_u64().is_some_and(|n| n >= 6), "{found}");
        sorts_by_key(&mut browser);
        prints_what_is_closed(&mut browser);
        assert_eq!(browser.complaints, [] as [String; 0], "{width} pixels");
        assert!(found["loaded"].as_f64().is_some_and(|loaded: f64| loaded < MAX_LOAD), "{width} pixels: {found}");
    }
}

/// The head of a column takes the focus, and Enter sorts by it.
fn sorts_by_key(browser: &mut Browser) {
    browser.wait_for("document.querySelector('.results th.n[data-metric] button').focus()");
    let sort = "document.activeElement.closest('th').getAttribute('aria-sort')";
    assert_eq!(browser.wait_for(sort), Value::Null);
    for kind in ["keyDown", "keyUp"] {
        let enter = json!({ "type": kind, "key": "Enter", "code": "Enter", "windowsVirtualKeyCode": 13, "text": "\r" });
        browser.call("Input.dispatchKeyEvent", enter);
    }
    assert_eq!(browser.wait_for(sort), "ascending");
}

/// On paper all lists and tables are open, whatever is closed in the window.
fn prints_what_is_closed(browser: &mut Browser) {
    let n_visible =
        "[...document.querySelectorAll('details:not([open]) table')].filter((table) => table.checkVisibility()).length";
    let n_closed = browser.wait_for("document.querySelectorAll('details:not([open])').length");
    assert!(n_closed.as_u64().is_some_and(|n| n >= 5), "six lists of runs, of which one was opened");
    assert_eq!(browser.wait_for(n_visible), 0);
    browser.call("Emulation.setEmulatedMedia", json!({ "media": "print" }));
    assert_eq!(browser.wait_for(n_visible), n_closed);
}

#[test]
fn a_broken_page_is_found_out() {
    let Some(chromium) = chromium() else { return };
    let mut browser = Browser::start(&chromium);
    let page = "data:text/html,<script>console.error('told');nothing.here</script><img src='https://example.invalid/'>";
    browser.call("Page.navigate", json!({ "url": page }));
    let ready = "new Promise((tell) => { const ask = () => document.readyState === 'complete' && location.protocol === 'data:' ? tell(true) : setTimeout(ask, 50); ask(); })";
    assert_eq!(browser.wait_for(ready), Value::Bool(true));
    let said = browser.complaints.join("\n");
    assert!(said.contains("told") && said.contains("nothing is not defined"), "{said}");
}
