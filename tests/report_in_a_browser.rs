//! The page of a study, in a real browser: what it shows, what its controls do, and that nothing is
//! wrong in the console. Skipped, loudly, where there is no Chromium.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs in the page before anything else: remembers what goes wrong, and what is fetched.
const BEFORE: &str = r#"<script>
window.wrong = [];
window.addEventListener("error", (e) => wrong.push("error: " + e.message));
for (const level of ["error", "warn"]) {
  const old = console[level];
  console[level] = (...words) => { wrong.push(level + ": " + words.join(" ")); old(...words); };
}
</script>"#;

/// Runs at the end: uses every control as a reader would, and writes down what came of it.
const AFTER: &str = r##"<script>
const said = {};
const all = (selector) => [...document.querySelectorAll(selector)];
const tip = document.getElementById("tip");
const mark = document.querySelector("[data-tip]");
mark.dispatchEvent(new PointerEvent("pointerenter"));
said.tip = !tip.hidden && tip.textContent === mark.dataset.tip;
mark.dispatchEvent(new PointerEvent("pointerleave"));
said.tip_goes = tip.hidden;

const column = (index) => all("tbody tr").map((row) => row.cells[index]);
const headers = all("th").map((h) => h.textContent);
const error = headers.indexOf("error");
const numbers = () => column(error).map((c) => Number(c.dataset.number));
const sorted = (n, sign) => n.every((v, i) => i === 0 || sign * (v - n[i - 1]) >= 0);
all("th button")[error].click();
said.ascending = sorted(numbers(), 1);
all("th button")[error].click();
said.descending = sorted(numbers(), -1);
const before = column(0).length;
all("th button")[0].click();
const names = column(0).map((c) => c.textContent);
said.by_name = names.length === before && sorted(names.map((n, i) => i === 0 ? 0 : n.localeCompare(names[i - 1])).map((c) => c >= 0 ? 1 : 0).slice(1), 1);

const row = document.querySelector("tbody tr");
const on = () => all(".plot.pointed .line.on").map((line) => line.dataset.name);
row.dispatchEvent(new PointerEvent("pointerenter"));
const plots = all(".plot").length;
said.row_points = on().length === plots && on().every((name) => name === row.cells[0].textContent);
row.dispatchEvent(new PointerEvent("pointerleave"));
said.row_lets_go = on().length === 0;
said.base_rows = all("tr.base").length;

const visible = () => all("#error-time .line .drawn").filter((l) => l.getBoundingClientRect().width > 0);
said.lines = visible().length;
const button = all("[data-show]").find((b) => b.dataset.show === "depth");
if (button) {
  button.click();
  said.depth_only = visible().every((l) => ["depth", "base"].includes(l.parentNode.dataset.group));
  said.some_depth = visible().length > 1;
  all("[data-show]")[0].click();
  said.all_again = visible().length === said.lines;
}
document.querySelector("#error-time .key").dispatchEvent(new MouseEvent("click", { bubbles: true }));
said.one_hidden = visible().length === said.lines - 1;

const slider = document.querySelector(".strip input");
if (slider) {
  const cut = () => getComputedStyle(document.querySelector(".strip .truth")).clipPath;
  said.half_at_first = cut();
  slider.value = 25;
  slider.dispatchEvent(new Event("input"));
  said.uncovered = cut();
  said.images = all(".strip img").filter((i) => i.complete && i.naturalWidth > 0).length;
  said.reference = getComputedStyle(document.querySelector(".strip .truth")).backgroundImage.slice(0, 27);
}
said.requests = performance.getEntriesByType("resource").map((r) => r.name).filter((n) => !n.startsWith("data:"));
said.sentences = all(".advice").map((p) => p.textContent).join(" ");
said.wrong = window.wrong;
const found = document.createElement("script");
found.type = "application/json";
found.id = "said";
found.textContent = JSON.stringify(said);
document.body.append(found);
</script>"##;

fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let paths = std::env::var_os("PATH")?;
    let all = names.iter().flat_map(|name| {
        let folders: Vec<PathBuf> = std::env::split_paths(&paths).collect();
        folders.into_iter().map(move |folder| folder.join(name))
    });
    let found = all.into_iter().find(|path| path.is_file());
    if found.is_none() {
        eprintln!("SKIPPED: no chromium on the path, so the report is not seen in a browser");
    }
    found
}

fn accuracy(folder: &Path, args: &str) {
    let output = Command::new(env!("CARGO_BIN_EXE_huygens"))
        .current_dir(folder)
        .arg("accuracy")
        .args(args.split_whitespace())
        .output()
        .expect("huygens runs");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

/// What the page in `file` says of itself in the browser.
fn said(browser: &Path, folder: &Path, file: &str) -> serde_json::Value {
    let page = std::fs::read_to_string(folder.join(file)).expect("written");
    for fetched in ["src=\"http", "href=\"http", "url(http", "@import"] {
        assert!(!page.contains(fetched), "{fetched}");
    }
    let page = page.replacen("<head>", &format!("<head>{BEFORE}"), 1);
    let page = page.replacen("</body>", &format!("{AFTER}</body>"), 1);
    std::fs::write(folder.join("driven.html"), page).expect("written");
    let url = format!("file://{}", folder.join("driven.html").display());
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"])
        .args([
            "--host-resolver-rules=MAP * ~NOTFOUND",
            "--virtual-time-budget=3000",
        ])
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .arg(url)
        .output()
        .expect("the browser runs");
    let dom = String::from_utf8_lossy(&output.stdout);
    let at = "<script type=\"application/json\" id=\"said\">";
    let said = dom
        .split(at)
        .nth(1)
        .and_then(|s| s.split("</script>").next());
    serde_json::from_str(said.expect("the page was driven to its end")).expect("JSON")
}

#[test]
fn the_page_of_a_scene_works() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell-box.toml");
    std::fs::copy(scene, folder.path().join("box.toml")).expect("copied");
    let args = "box.toml --size 16x16 --spp 4 --repetitions 2 --reference-error 20% \
                --vary strategy,depth --html a.html --quiet";
    accuracy(folder.path(), args);
    let said = said(&browser, folder.path(), "a.html");
    for yes in [
        "tip",
        "tip_goes",
        "ascending",
        "descending",
        "by_name",
        "row_points",
        "row_lets_go",
        "depth_only",
        "some_depth",
        "all_again",
        "one_hidden",
    ] {
        assert_eq!(said[yes], true, "{yes}: {said}");
    }
    let sentences = said["sentences"].as_str().expect("text");
    assert!(sentences.contains(" reaches an error of 2% in "), "{said}");
    // The base, three more strategies, four depths.
    assert_eq!(said["lines"], 8, "{said}");
    assert_eq!(said["base_rows"], 1, "{said}");
    assert_eq!(said["images"], 8, "{said}");
    assert_eq!(said["half_at_first"], "inset(0px 0px 0px 50%)");
    assert_eq!(said["uncovered"], "inset(0px 0px 0px 25%)");
    assert_eq!(said["reference"], "url(\"data:image/png;base64,");
    assert_eq!(said["requests"], serde_json::json!([]));
    assert_eq!(said["wrong"], serde_json::json!([]));
}

#[test]
fn the_page_of_an_integral_works() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    accuracy(
        folder.path(),
        "pi --samples 1024 --html a.html --svg . --quiet",
    );
    let said = said(&browser, folder.path(), "a.html");
    for yes in ["tip", "ascending", "descending", "one_hidden"] {
        assert_eq!(said[yes], true, "{yes}: {said}");
    }
    assert_eq!(said["lines"], 3);
    assert_eq!(said["requests"], serde_json::json!([]));
    assert_eq!(said["wrong"], serde_json::json!([]));
    // A plot alone is a picture that the browser shows.
    let svg = std::fs::read_to_string(folder.path().join("error-time.svg")).expect("written");
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
}
