use super::*;
use huygens::scene::{Camera, Extent, FilmSpec, Mesh, Projection};
use huygens::settings::Settings;
use huygens::wave::BounceStats;
use serde_json::Value;
use std::collections::BTreeSet;

pub(crate) fn scene() -> Scene {
    Scene {
        name: "test".into(),
        hash: [1; 32],
        camera: Camera {
            origin: [0.0; 3],
            forward: [0.0, 0.0, -1.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
            projection: Projection::Perspective {
                extent: Extent {
                    half_width: 1.0,
                    half_height: 0.5,
                },
                lens: None,
            },
        },
        film: FilmSpec {
            width: 20,
            height: 10,
            filter: Filter::BlackmanHarris,
        },
        mesh: Mesh::default(),
        materials: Vec::new(),
        spheres: Vec::new(),
        objects: Vec::new(),
        instances: Vec::new(),
        textures: Vec::new(),
        sky: None,
        lights: Vec::new(),
        media: Vec::new(),
        camera_motion: None,
        fog: None,
        settings: Settings {
            ao_distance: Some(2.5),
            ..Settings::default()
        },
        warnings: Vec::new(),
    }
}

pub(crate) fn render() -> RenderStats {
    RenderStats {
        seconds: 2.0,
        cpu_seconds: Some(3.5),
        worker_seconds: 3.75,
        threads: 2,
        samples: 12_800,
        camera_rays: 12_800,
        bounce_rays: 20_000,
        shadow_rays: 7_200,
        mean_depth: 1.5625,
        stopped: false,
        stages: vec![StageStats {
            name: "intersect",
            bounces: vec![BounceStats::default()],
            ..StageStats::default()
        }],
        dropped: vec![Dropped {
            stage: "film",
            count: 2,
            examples: vec![(1, 2, 3)],
        }],
        untraceable: vec![Dropped {
            stage: "intersect",
            count: 1,
            examples: vec![(4, 5, 6)],
        }],
        timelines: Vec::new(),
    }
}

/// Adds the path of every field under `value`: `a.b`, and `a[].b` for the elements of a list.
pub(crate) fn paths(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(fields) => {
            for (name, field) in fields {
                let dot = if path.is_empty() { "" } else { "." };
                paths(field, &format!("{path}{dot}{name}"), found);
            }
        }
        Value::Array(elements) if elements.iter().any(Value::is_object) => {
            for element in elements {
                paths(element, &format!("{path}[]"), found);
            }
        }
        _ => {
            found.insert(path.to_owned());
        }
    }
}

/// The first column of the tables under the heading `heading` of docs/stats.md.
pub(crate) fn documented(heading: &str) -> BTreeSet<String> {
    let text = include_str!("../../../docs/stats.md");
    let section = text.split("\n## ").find(|s| s.starts_with(heading));
    let rows = section.expect("the heading").lines();
    rows.filter_map(|row| row.strip_prefix("| `")?.split('`').next())
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_layout_is_the_documented_one() {
    let stats = Stats::new(&scene(), Path::new("a.toml"), render(), &[]);
    let json = serde_json::to_value(&stats).expect("serialised");
    let mut found = BTreeSet::new();
    paths(&json, "", &mut found);
    assert_eq!(found, documented("render --stats"));
    assert_eq!(json["schema"], SCHEMA);
}

#[test]
fn rates_and_totals() {
    let stats = Stats::new(&scene(), Path::new("a.toml"), render(), &[]);
    assert_eq!(stats.rays.total, 40_000);
    assert_eq!(stats.rays.per_second, 20_000.0);
    assert_eq!(stats.samples.per_second, 6_400.0);
    assert_eq!(stats.samples.asked, 20 * 10 * 64);
    assert_eq!(stats.dropped.total, 2);
}

#[test]
fn a_render_of_no_time_has_rates_of_zero_and_not_infinity() {
    let stats = Stats::new(&scene(), Path::new("a"), RenderStats::default(), &[]);
    assert_eq!(
        (stats.rays.per_second, stats.samples.per_second),
        (0.0, 0.0)
    );
}
