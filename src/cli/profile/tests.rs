use super::*;
use crate::cli::stats::tests::paths;
use huygens::wave::StageStats;
use std::collections::BTreeSet;

fn profile() -> Profile {
    let stage = StageStats {
        name: "intersect",
        items_in: 800,
        seconds: 1.0,
        lanes_busy: 800,
        lanes_issued: 1000,
        bytes_read: 8000,
        counted: Some([1.0; COUNTERS.len()]),
        bounces: vec![wave::BounceStats {
            items_in: 800,
            ..wave::BounceStats::default()
        }],
        ..StageStats::default()
    };
    let render = RenderStats {
        stages: vec![stage],
        worker_seconds: 1.0,
        ..RenderStats::default()
    };
    let none = Some("there is none".to_owned());
    let mut counters: BTreeMap<_, _> = COUNTERS.into_iter().map(|c| (c, none.clone())).collect();
    counters.insert("page_faults", None);
    Profile {
        schema: SCHEMA,
        program: "huygens",
        version: "1",
        scene: "test".into(),
        settings: "--spp 4".into(),
        threads: 2,
        wave: 2048,
        seconds: 0.5,
        cpu_seconds: Some(1.0),
        worker_seconds: 1.0,
        samples: 100,
        rays: 800,
        limits: Limits {
            gigaoperations: 80.0,
            near: 40.0,
            far: 10.0,
        },
        counters,
        visits_counted: false,
        kernels: rows(&render, COUNTERS.map(|c| c == "page_faults")),
        bounces: bounces(&render),
    }
}

#[test]
fn the_report_shows_what_there_is_and_says_what_there_is_not() {
    let text = profile().text();
    assert!(
        text.contains("intersect            100.0% 1250000.00"),
        "{text}"
    );
    assert!(
        text.contains("these are 100.0% of the workers' 1.00 s"),
        "{text}"
    );
    assert!(text.contains("not to be read here: branch_misses, context_switches, cycles"));
    assert!(
        text.contains("page_faults") && !text.contains("IPC"),
        "{text}"
    );
    assert!(text.contains(&"#".repeat(40)), "{text}");
    assert!(text.contains("build with --features visits"), "{text}");
}

/// The fields of the tables of docs/profiling.md.
#[test]
fn the_layout_is_the_documented_one() {
    let json = serde_json::to_value(profile()).expect("serialised");
    let mut found = BTreeSet::new();
    paths(&json, "", &mut found);
    // Named by the counter; documented as one.
    let named = |p: String| match p.rsplit_once('.') {
        Some((table @ ("counters" | "kernels[].counted"), _)) => format!("{table}.NAME"),
        _ => p,
    };
    let found: BTreeSet<String> = found.into_iter().map(named).collect();
    let text = include_str!("../../../docs/profiling.md");
    let section = text.split("\n## ").find(|s| s.starts_with("JSON"));
    let rows = section.expect("the section").lines();
    let documented = rows.filter_map(|row| row.strip_prefix("| `")?.split('`').next());
    let documented: BTreeSet<String> = documented.map(str::to_owned).collect();
    assert_eq!(found, documented);
}
