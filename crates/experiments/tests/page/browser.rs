//! The page in a browser, headless: Chromium, from the variable `CHROMIUM` or the path; skipped where there is none.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::Bench;

/// Uses the page and notes what came of it.
const PROBE: &str = include_str!("probe.js");
/// The longest that a small page may take to load, ms. Ten times what it takes, for machines with other things to do.
const MAX_LOAD: f64 = 5000.0;

fn chromium() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM").filter(|path| !path.is_empty()) {
        return Some(path.into());
    }
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(|path| path.is_file())
}

/// What the probe found on a page, in a window of this size.
fn probe(chromium: &Path, page: &Path, size: &str) -> Value {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run"])
        .args([
            "--disable-background-networking",
            "--hide-scrollbars",
            "--timeout=60000",
            "--virtual-time-budget=60000",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--window-size={size}"))
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let (_, rest) = dom.split_once(r#"<pre id="probe">"#).unwrap_or_else(|| {
        panic!("the probe did not finish: {}\n{}", &dom[..dom.len().min(500)], String::from_utf8_lossy(&output.stderr))
    });
    let json = rest.split_once("</pre>").unwrap().0;
    serde_json::from_str(&json.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")).unwrap()
}

#[test]
fn it_works_in_a_browser() {
    let Some(chromium) = chromium() else {
        // Said where `--nocapture` shows it; there is nothing to test with.
        eprintln!("skipped: no Chromium; CHROMIUM names one");
        return;
    };
    let bench = Bench::get();
    let page = bench.page("browser.html", &[]);
    let probed = bench.path("probed.html");
    fs::write(&probed, page.replacen("<title>", &format!("<script>{PROBE}</script><title>"), 1)).unwrap();
    for size in ["1280,900", "500,800"] {
        let found = probe(&chromium, &probed, size);
        assert_eq!(found["errors"].as_array().unwrap().len(), 0, "{size}: {}", found["errors"]);
        assert_eq!(found["failed"].as_array().unwrap().len(), 0, "{size}: {}", found["failed"]);
        assert!(found["drives"].as_u64().unwrap() >= 6);
        assert!(found["loaded"].as_f64().unwrap() < MAX_LOAD, "{size}: loaded in {} ms", found["loaded"]);
    }
}
