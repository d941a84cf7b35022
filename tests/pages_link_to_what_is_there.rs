//! The pages' links lead somewhere: to files that ship, and to headings that they have.

use std::fs;
use std::path::{Path, PathBuf};

/// All pages: those at the root, and all below `docs` and `benches`.
fn pages(root: &Path) -> Vec<PathBuf> {
    let mut folders = vec![root.join("docs"), root.join("benches")];
    let mut found = Vec::new();
    let mut sort = |path: PathBuf, folders: &mut Vec<PathBuf>| {
        if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        } else if path.is_dir() {
            folders.push(path);
        }
    };
    for entry in fs::read_dir(root).expect("the root") {
        let path = entry.expect("an entry").path();
        if path.is_file() {
            sort(path, &mut folders);
        }
    }
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            sort(entry.expect("an entry").path(), &mut folders);
        }
    }
    found
}

/// A heading's anchor, as the usual viewers make it: lower case, words joined by hyphens.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
    let heading = heading.trim_start_matches('#').trim().to_lowercase();
    heading
        .chars()
        .filter(kept)
        .collect::<String>()
        .replace(' ', "-")
}

/// Targets of `[text](target)`.
fn links(text: &str) -> impl Iterator<Item = &str> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
}

#[test]
fn links_lead_to_files_and_headings() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut broken, mut followed) = (Vec::new(), 0);
    for page in pages(root) {
        let text = fs::read_to_string(&page).expect("a page");
        for link in links(&text).filter(|l| !l.contains("://")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => page.clone(),
                file => page.parent().expect("a folder").join(file),
            };
            let there = match (fs::read_to_string(&target), heading) {
                (Err(_), "") => target.exists(),
                (Err(_), _) => false,
                (Ok(_), "") => true,
                (Ok(text), _) => {
                    let mut headings = text.lines().filter(|l| l.starts_with('#'));
                    headings.any(|l| anchor(l) == heading)
                }
            };
            followed += 1;
            if !there {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(followed > 20, "the pages have links");
    assert!(broken.is_empty(), "{broken:#?}");
}
