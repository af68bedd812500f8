//! The page that `report --format html` writes, from runs of a small grid: it needs nothing beside it, says what the
//! report says, and works in a browser.

mod browser;
mod devtools;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;

/// Three cells in two worlds, of names that are markup where they are not escaped; a classical driver among them.
const SPEC: &str = r#"
name = "small"
seeds = { first = 0, count = 3 }
[train]
n_steps = 3_000
log_every = 1_000
[evaluate]
n_episodes = 12
worlds = [
    { name = "room </script><script>alert(1)</script>", time_limit = 20.0, world = { type = "room_10x15" } },
    { name = "crowd & \"co\"", time_limit = 20.0, world = { type = "room", obstacles = { count = 6 }, crowd = { n_movers = 4, speed = [0.3, 0.8], motion = { type = "waypoints", n_points = 4 } } } },
]
[[axis]]
name = "<i>who</i>"
[axis.levels]
"DQN <b>" = { "agent.target" = "dqn" }
"DDQN 'x'" = { "agent.target" = "double_dqn" }
"VFH" = { "policy.type" = "vfh" }
"#;

struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    /// The runs, made once for all tests.
    fn get() -> &'static Self {
        static BENCH: OnceLock<Bench> = OnceLock::new();
        BENCH.get_or_init(|| {
            let bench = Self { folder: tempfile::tempdir().unwrap() };
            fs::write(bench.path("spec.toml"), SPEC).unwrap();
            bench.succeed(&["run", "spec.toml", "--out", "out"]);
            bench
        })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn experiments(&self, args: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_experiments")).current_dir(self.folder.path()).args(args).output().unwrap()
    }

    fn succeed(&self, args: &[&str]) -> String {
        let output = self.experiments(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    fn fail(&self, args: &[&str]) -> String {
        let output = self.experiments(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        String::from_utf8(output.stderr).unwrap()
    }

    /// The page, written to a file of that name.
    fn page(&self, name: &str, more: &[&str]) -> String {
        self.succeed(&[&["report", "out", "--format", "html", "--out", name], more].concat());
        fs::read_to_string(self.path(name)).unwrap()
    }
}

/// What the page's scripts are given.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"<script type="application/json" id="data">"#).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn it_says_what_the_report_says() {
    let bench = Bench::get();
    let page = bench.page("numbers.html", &[]);
    let rows: Value = serde_json::from_str(&bench.succeed(&["report", "out", "--format", "json"])).unwrap();
    assert_eq!(data(&page)["rows"], rows);
    // Every row has its runs, and every seed its folder, as seen from the page.
    assert_eq!(page.matches("<details id=\"runs-").count(), 6);
    for run in fs::read_dir(bench.path("out/runs")).unwrap() {
        let id = run.unwrap().file_name().into_string().unwrap();
        assert!(page.contains(&format!("href=\"out/runs/{id}/\"")), "{id}");
    }
    assert!(!page.contains("otherwise than recorded: by"), "episodes driven again are those recorded");
}

/// Nobody arrives within a second; two cells share their runs.
const HASTE: &str = r#"
name = "haste"
seeds = { first = 0, count = 2 }
train = { n_steps = 1_000, log_every = 500 }
[evaluate]
n_episodes = 3
worlds = [{ name = "room", time_limit = 0.4, world = { type = "room_10x15" } }]
[[axis]]
name = "who"
[axis.levels]
"alone <b>" = {}
shielded = { "evaluate.shield" = { margin = 0.3 } }
vfh = { "policy.type" = "vfh" }
"#;

#[test]
fn it_says_which_seeds_collapsed_and_what_cells_are() {
    let bench = Bench::get();
    fs::write(bench.path("haste.toml"), HASTE).unwrap();
    bench.succeed(&["run", "haste.toml", "--out", "haste"]);
    bench.succeed(&["report", "haste", "--format", "html"]);
    let page = fs::read_to_string(bench.path("haste/report.html")).unwrap();
    assert!(page.contains("<dt>Collapsed</dt><dd>2 of 2 runs, in a world or all</dd>"), "a run counts once");
    for (row, is_trained) in [true, true, false].into_iter().enumerate() {
        let link = format!("<a href=\"#runs-{row}\" data-metric=\"collapsed\"><b>2/2</b></a>");
        assert_eq!(page.contains(&link), is_trained);
        let (_, runs) = page.split_once(&format!("<details id=\"runs-{row}\">")).unwrap();
        let (runs, _) = runs.split_once("</details>").unwrap();
        let n_verdicts = runs.matches("times out in room (100 % of evaluation episodes").count();
        assert_eq!(n_verdicts, if is_trained { 2 } else { 0 });
        assert_eq!(runs.contains(">collapsed</th>"), is_trained);
    }
    let (_, cells) = page.split_once("<section id=\"cells\">").unwrap();
    let (cells, _) = cells.split_once("</section>").unwrap();
    let row = |path: &str| -> Vec<&str> {
        let (_, row) = cells.split_once(&format!("<code>{path}</code></th>")).expect(path);
        row.split_once("</tr>").unwrap().0.split("<code>").skip(1).map(|cell| cell.split_once('<').unwrap().0).collect()
    };
    assert!(cells.contains("<th scope=\"col\">alone &lt;b&gt;</th><th scope=\"col\">shielded</th>"));
    let [alone, shielded, vfh]: [&str; 3] = row("evaluate.shield").try_into().unwrap();
    assert!(alone == "absent" && vfh == "absent" && shielded.contains("margin = 0.3"), "{shielded}");
    assert_eq!(row("agent"), ["{ \u{2026} }", "{ \u{2026} }", "absent"]);
    assert!(row("policy")[2].starts_with("type = &quot;vfh&quot;, "));
    assert!(!cells.contains("agent."), "what is in a table that not all have is the same in those that do");
}

#[test]
fn three_seeds_make_nothing_bold() {
    let page = Bench::get().page("bold.html", &[]);
    let (_, matrices) = page.split_once("Probability of more").unwrap();
    assert_eq!(matrices.matches("None is bold: that takes 6 training seeds").count(), 3, "of each metric");
    let tables: Vec<&str> = matrices.split("<table class=\"matrix\">").skip(1).collect();
    assert!(tables.len() == 3 && tables.iter().all(|table| !table.split_once("</table>").unwrap().0.contains("<b>")));
}

#[test]
fn it_needs_nothing_beside_it() {
    let page = Bench::get().page("alone.html", &[]);
    let rest = page.replace("http://www.w3.org/2000/svg", "");
    for outside in ["http:", "https:", "src=", "@import", "url(", "<link rel=\"stylesheet"] {
        assert!(!rest.contains(outside), "{outside}");
    }
    assert!(page.contains("default-src 'none'"), "and the browser would not fetch it");
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
}

#[test]
fn names_stay_text() {
    let page = Bench::get().page("names.html", &[]);
    let (markup, json) = page.split_once("id=\"data\">").unwrap();
    for name in ["<script>alert", "<b>", "<i>who", "& \"co\""] {
        // The only bold texts of the page are its own, of numbers.
        let found = markup
            .match_indices(name)
            .find(|(at, _)| !markup[at + name.len()..].starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c)));
        assert_eq!(found, None, "{name}");
    }
    assert!(markup.contains("DQN &lt;b&gt;") && markup.contains("room &lt;/script&gt;"));
    assert_eq!(json.matches("</script>").count(), 2, "the ends of the data and of the scripts");
    assert_eq!(data(&page)["rows"][0]["axes"]["<i>who</i>"], "DQN <b>");
}

#[test]
fn drives_are_chosen_by_rule_or_by_name() {
    let bench = Bench::get();
    let count = |page: &str| data(page)["drives"].as_array().unwrap().len();
    let one = bench.page("one.html", &[]);
    let two = bench.page("two.html", &["--drives", "2"]);
    for drive in data(&one)["drives"].as_array().unwrap() {
        let (why, outcome) = (drive["why"].as_str().unwrap(), drive["outcome"].as_str().unwrap());
        assert_eq!(why, format!("typical {outcome}"));
        assert!(one.contains(&format!("{why} (")) && one.contains(" % of episodes end so), seed "));
    }
    assert!((6..=18).contains(&count(&one)) && count(&two) > count(&one), "{} and {}", count(&one), count(&two));
    let pick = r#"*/crowd & "co"/1/7"#;
    let asked = bench.page("asked.html", &["--drive", pick]);
    let asked = data(&asked);
    let asked: Vec<_> =
        asked["drives"].as_array().unwrap().iter().filter(|drive| drive["why"] == "asked for").collect();
    assert_eq!(asked.len(), 2, "one of each cell that has the seed");
    assert!(asked.iter().all(|drive| drive["seed"] == 1 && drive["scenario"] == 7 && drive["is_as_recorded"] == true));
    assert!(asked.iter().all(|drive| drive["trace"]["n_movers"] == 4));
    for (pick, said) in [
        ("VGH/w/0/0", "no cell `VGH`"),
        ("VFH/w/0/0", "no world `w`"),
        (r#"VFH/crowd & "co"/9/0"#, "no seed 9"),
        (r#"VFH/crowd & "co"/0/12"#, "no scenario 12"),
        ("VFH/0/0", "write CELL/WORLD/SEED/SCENARIO"),
    ] {
        let error = bench.fail(&["report", "out", "--format", "html", "--out", "no.html", "--drive", pick]);
        assert!(error.contains(said), "{pick}: {error}");
    }
    assert!(bench.fail(&["report", "out", "--drives", "2"]).contains("go with --format html, svg or png"));
    assert!(
        bench.fail(&["report", "out", "--format", "html", "--out", "no/p.html"]).contains("there is no folder `no`")
    );
    assert!(!bench.path("no.html").exists());
}

#[test]
fn figures_are_files() {
    let bench = Bench::get();
    let listed = bench.succeed(&["report", "out", "--format", "svg", "--out", "figures"]);
    assert_eq!(fs::read_dir(bench.path("figures")).unwrap().count(), listed.lines().count());
    for start in ["speed-", "intervals-", "iqm", "profile-success", "curve-reached", "clearance", "drive-"] {
        let path = listed.lines().find(|line| line.starts_with(&format!("figures/{start}"))).expect(start);
        let svg = fs::read_to_string(bench.path(path)).unwrap();
        assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{path}");
    }
}

#[test]
fn figures_are_pixels_too() {
    let bench = Bench::get();
    let names = |listed: &str, ending: &str| -> Vec<String> {
        let names =
            listed.lines().map(|line| line.rsplit('/').next().unwrap().strip_suffix(ending).unwrap().to_owned());
        names.collect()
    };
    let drawn = names(&bench.succeed(&["report", "out", "--format", "svg", "--out", "drawn"]), ".svg");
    let painted = bench.succeed(&["report", "out", "--format", "png", "--out", "painted", "--scale", "1.5"]);
    assert_eq!(names(&painted, ".png"), drawn);
    for name in drawn {
        let svg = fs::read_to_string(bench.path(&format!("drawn/{name}.svg"))).unwrap();
        let picture = image::open(bench.path(&format!("painted/{name}.png"))).unwrap().to_rgba8();
        let side = |of: &str| {
            svg.split_once(&format!(" {of}=\"")).unwrap().1.split('"').next().unwrap().parse::<f64>().unwrap()
        };
        let size = [side("width"), side("height")].map(|side| (1.5 * side).round() as u32);
        assert_eq!([picture.width(), picture.height()], size, "{name}");
        assert!(picture.pixels().all(|pixel| pixel[3] == 255), "{name} stands on white");
        let n_dark = picture.pixels().filter(|pixel| pixel.0[..3].iter().all(|channel| *channel < 100)).count();
        assert!(n_dark > 500, "{name} has axes and words: {n_dark} dark pixels");
    }
    assert!(
        bench.fail(&["report", "out", "--format", "svg", "--scale", "2"]).contains("--scale goes with --format png")
    );
    assert!(bench.fail(&["report", "out", "--format", "png", "--scale", "99"]).contains("from 0.5 to 10"));
}

/// The bounds of what a text paints, and its pixels, line by line.
fn painted(text: &str) -> Option<([usize; 2], Vec<bool>)> {
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"40\" font-family=\"Helvetica, 'DejaVu Sans', sans-serif\">\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/><text x=\"5\" y=\"25\">{text}</text></svg>"
    );
    let png = headway_experiments::plot::PngRenderer::default().picture(&svg).unwrap().png(2.0).unwrap();
    let picture = image::load_from_memory(&png).unwrap().to_luma8();
    let dark: Vec<_> =
        picture.enumerate_pixels().filter(|(.., pixel)| pixel[0] < 200).map(|(x, y, _)| [x, y]).collect();
    let ends = |axis: usize| Some([dark.iter().map(|at| at[axis]).min()?, dark.iter().map(|at| at[axis]).max()?]);
    let [[left, right], [top, bottom]] = [ends(0)?, ends(1)?];
    let pixels = (top..=bottom).flat_map(|y| (left..=right).map(move |x| [x, y]));
    let size = [right - left + 1, bottom - top + 1].map(|side| side as usize);
    Some((size, pixels.map(|[x, y]| picture.get_pixel(x, y)[0] < 200).collect()))
}

#[test]
fn words_are_painted() {
    assert_eq!(painted(""), None);
    // What stands for a sign without a glyph, of which the font has none.
    let missing = painted("\u{901f}");
    assert!(missing.is_some() && missing == painted("\u{3044}"), "a box, whatever the sign");
    for sign in "success\u{3c4}m/s\u{b3}\u{2013}R\u{b7}10x15\u{2212}\u{b1}\u{394}".chars() {
        let glyph = painted(&sign.to_string());
        assert!(glyph.is_some() && glyph != missing, "{sign}");
    }
    let widths = ["R", "R \u{b7} 10x15"].map(|text| painted(text).unwrap().0[0]);
    assert!(widths[1] > 5 * widths[0], "{widths:?}");
}

/// What `report --format png` says of a grid of pure pursuits of these names, and the files that it leaves.
fn painted_grid(names: &[String], scale: &str) -> (Output, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let level = |(k, name): (usize, &String)| {
        let speed = 0.5 + 0.005 * k as f64;
        format!("\"{name}\" = {{ \"policy.type\" = \"pure_pursuit\", \"policy.desired_linear_vel\" = {speed} }}\n")
    };
    let levels: String = names.iter().enumerate().map(level).collect();
    let head = "name = \"drivers\"\nseeds = { first = 0, count = 1 }\nevaluate = { n_episodes = 1 }\n";
    fs::write(folder.path().join("spec.toml"), format!("{head}[[axis]]\nname = \"driver\"\n[axis.levels]\n{levels}"))
        .unwrap();
    let experiments = |args: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_experiments")).current_dir(folder.path()).args(args).output().unwrap()
    };
    let run = experiments(&["run", "spec.toml", "--out", "out"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let report = experiments(&["report", "out", "--format", "png", "--out", "painted", "--scale", scale]);
    let files = fs::read_dir(folder.path().join("painted")).into_iter().flatten();
    (report, files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect())
}

/// Found while they were painted: the folder was half full by then, and nothing said what would fit.
#[test]
fn too_large_figures_are_refused_before_any_is_written() {
    let names: Vec<_> = (0..120).map(|k| format!("driver {k}")).collect();
    let (report, files) = painted_grid(&names, "10");
    let message = String::from_utf8_lossy(&report.stderr);
    assert_eq!(report.status.code(), Some(2), "{message}");
    // 960 x (44 + 120 x 24 + 26), of which 2^28 pixels are the 9.737-fold.
    let said = "it would have 9600 x 29500 pixels, of which there may be 268435456 at most: the greatest scale that fits is 9.73";
    assert!(message.contains("error: --scale 10: `") && message.contains(said), "{message}");
    assert!(files.is_empty(), "{files:?}");
}

#[test]
fn signs_that_cannot_be_painted_are_named_once() {
    let (report, files) = painted_grid(&["速い".to_owned(), "\u{3c4}".to_owned()], "1");
    let message = String::from_utf8_lossy(&report.stderr);
    assert!(report.status.success() && !files.is_empty(), "{message}");
    let note = "warning: boxes stand in the figures for signs that their font lacks: `\u{3044}` (U+3044), `\u{901f}` (U+901F)\n";
    assert_eq!(message.matches(note).count(), 1, "{message}");
    assert_eq!(message.matches("U+").count(), 2, "{message}");
}

#[test]
fn what_is_unfinished_or_otherwise_is_said() {
    let bench = Bench::get();
    let copied = Command::new("cp").args(["-r", "out", "changed"]).current_dir(bench.folder.path()).status().unwrap();
    assert!(copied.success());
    let index: Value = serde_json::from_str(&fs::read_to_string(bench.path("changed/index.json")).unwrap()).unwrap();
    let run = |cell: usize, seed: usize| {
        bench.path("changed/runs").join(index["cells"][cell]["runs"][seed]["train_id"].as_str().unwrap())
    };
    fs::remove_file(run(0, 2).join("done")).unwrap();
    // Two runs change their policies, and what vouches for them.
    let of_policy = |line: &&str| line.ends_with("policy.safetensors");
    let dones = [0, 1].map(|seed| fs::read_to_string(run(1, seed).join("done")).unwrap());
    let policies = [0, 1].map(|seed| fs::read(run(1, seed).join("policy.safetensors")).unwrap());
    for (seed, other) in [(0, 1), (1, 0)] {
        let [own, its] = [seed, other].map(|k: usize| dones[k].lines().find(of_policy).unwrap());
        fs::write(run(1, seed).join("done"), dones[seed].replace(own, its)).unwrap();
        fs::write(run(1, seed).join("policy.safetensors"), &policies[other]).unwrap();
    }
    bench.succeed(&["report", "changed", "--format", "html"]);
    let page = fs::read_to_string(bench.path("changed/report.html")).unwrap();
    assert!(page.contains("unfinished: 6 of 7 runs are complete"), "VFH has one run");
    assert!(page.contains("went otherwise than recorded: by other code"));
    assert!(page.contains("href=\"./runs/"), "links lead on from the results folder");
}
