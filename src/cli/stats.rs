//! `--stats`: the numbers of a render for scripts. The layout is an interface: `docs/stats.md`
//! documents it, and a test holds the two together.

use huygens::film::output::{OutputError, write_atomically};
use huygens::scene::{Filter, Scene};
use huygens::settings::{Integrator, Strategy};
use huygens::wave::account::Dropped;
use huygens::wave::{RenderStats, StageStats};
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// Version of the layout. It grows when a field changes its meaning or goes; new fields may appear
/// without that.
pub(crate) const SCHEMA: u32 = 1;

/// The whole file.
#[derive(Debug, Serialize)]
pub(crate) struct Stats {
    schema: u32,
    program: &'static str,
    version: &'static str,
    scene: SceneStats,
    image: ImageStats,
    settings: SettingsStats,
    pub(crate) seconds: Seconds,
    pub(crate) samples: Samples,
    pub(crate) rays: Rays,
    /// Mean number of scattering events on a path.
    pub(crate) mean_depth: f64,
    pub(crate) threads: usize,
    pub(crate) peak_memory_bytes: Option<u64>,
    pub(crate) interrupted: bool,
    pub(crate) dropped: DroppedStats,
    warnings: Vec<String>,
    pub(crate) outputs: Vec<String>,
    pub(crate) stages: Vec<StageStats>,
}

#[derive(Debug, Serialize)]
struct SceneStats {
    name: String,
    file: String,
    hash: String,
    triangles: usize,
    vertices: usize,
    materials: usize,
}

#[derive(Debug, Serialize)]
struct ImageStats {
    width: u32,
    height: u32,
    filter: Filter,
}

#[derive(Debug, Serialize)]
struct SettingsStats {
    integrator: Integrator,
    strategy: Strategy,
    spp: u32,
    max_depth: Option<u32>,
    roulette: bool,
    seed: u32,
    ao_distance: Option<f32>,
    wave: usize,
    tile: u32,
}

/// Wall-clock seconds of each phase.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Seconds {
    pub(crate) load: f64,
    pub(crate) build: f64,
    pub(crate) render: f64,
    pub(crate) write: f64,
    pub(crate) total: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Samples {
    pub(crate) done: u64,
    asked: u64,
    pub(crate) per_second: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Rays {
    pub(crate) camera: u64,
    pub(crate) bounce: u64,
    pub(crate) shadow: u64,
    total: u64,
    pub(crate) per_second: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct DroppedStats {
    pub(crate) total: u64,
    pub(crate) stages: Vec<Dropped>,
}

impl Stats {
    /// The numbers of `render`, a render of `scene` from `file`; what follows it is still empty.
    pub(crate) fn new(
        scene: &Scene,
        file: &Path,
        render: RenderStats,
        warnings: &[String],
    ) -> Self {
        let s = &scene.settings;
        let per_second = |n: u64| {
            if render.seconds > 0.0 {
                n as f64 / render.seconds
            } else {
                0.0
            }
        };
        let rays = render.camera_rays + render.bounce_rays + render.shadow_rays;
        let pixels = u64::from(scene.film.width) * u64::from(scene.film.height);
        Self {
            schema: SCHEMA,
            program: "huygens",
            version: env!("CARGO_PKG_VERSION"),
            scene: SceneStats {
                name: scene.name.clone(),
                file: file.display().to_string(),
                hash: blake3::Hash::from_bytes(scene.hash).to_hex().to_string(),
                triangles: scene.mesh.triangles(),
                vertices: scene.mesh.vertices.len(),
                materials: scene.materials.len(),
            },
            image: ImageStats {
                width: scene.film.width,
                height: scene.film.height,
                filter: scene.film.filter,
            },
            settings: SettingsStats {
                integrator: s.integrator,
                strategy: s.strategy,
                spp: s.spp,
                max_depth: s.max_depth,
                roulette: s.roulette,
                seed: s.seed,
                ao_distance: s.ao_distance,
                wave: s.wave,
                tile: s.tile,
            },
            seconds: Seconds {
                render: render.seconds,
                ..Seconds::default()
            },
            samples: Samples {
                done: render.samples,
                asked: pixels * u64::from(s.spp),
                per_second: per_second(render.samples),
            },
            rays: Rays {
                camera: render.camera_rays,
                bounce: render.bounce_rays,
                shadow: render.shadow_rays,
                total: rays,
                per_second: per_second(rays),
            },
            mean_depth: render.mean_depth,
            threads: render.threads,
            peak_memory_bytes: None,
            interrupted: render.stopped,
            dropped: DroppedStats {
                total: render.dropped.iter().map(|d| d.count).sum(),
                stages: render.dropped,
            },
            warnings: warnings.to_vec(),
            outputs: Vec::new(),
            stages: render.stages,
        }
    }

    /// Writes them to `path`, atomically.
    pub(crate) fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_atomically(path, |writer| -> std::io::Result<()> {
            serde_json::to_writer_pretty(&mut *writer, self)?;
            writer.write_all(b"\n")
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use huygens::scene::{FilmSpec, Mesh, Perspective};
    use huygens::settings::Settings;
    use huygens::wave::BounceStats;
    use serde_json::Value;
    use std::collections::BTreeSet;

    pub(crate) fn scene() -> Scene {
        Scene {
            name: "test".into(),
            hash: [1; 32],
            camera: Perspective {
                origin: [0.0; 3],
                forward: [0.0, 0.0, -1.0],
                right: [1.0, 0.0, 0.0],
                up: [0.0, 1.0, 0.0],
                half_width: 1.0,
                half_height: 0.5,
            },
            film: FilmSpec {
                width: 20,
                height: 10,
                filter: Filter::BlackmanHarris,
            },
            mesh: Mesh::default(),
            materials: Vec::new(),
            sky: None,
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
        let text = include_str!("../../docs/stats.md");
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
}
