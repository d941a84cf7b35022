//! A render runs what its scene calls for, and nothing else.

mod common;
mod scene_folder;

use common::scenes;
use huygens::film::Film;
use huygens::geometry::Geometry;
use huygens::scene::material::{Cauchy, Dielectric};
use huygens::scene::{Bsdf, Fog, Medium, Motion, Scene};
use huygens::settings::{Integrator, Settings, Strategy};
use huygens::wave::{self, Control, Plan};
use scene_folder::Folder;

fn plan(scene: &Scene, settings: &Settings) -> Plan {
    wave::plan(scene, &Geometry::build(&scene.mesh), settings)
}

fn effects(plan: &Plan) -> Vec<&str> {
    plan.effects.iter().map(|e| e.name).collect()
}

fn queues(plan: &Plan) -> Vec<(&str, Vec<&str>)> {
    plan.queues
        .iter()
        .map(|q| (q.name, q.columns.clone()))
        .collect()
}

/// Stages that did anything in a small render.
fn ran(scene: &Scene, settings: &Settings) -> Vec<&'static str> {
    let film = Film::new(scene.film.width, scene.film.height, 16);
    let geometry = Geometry::build(&scene.mesh);
    let stats = wave::render(scene, &geometry, settings, &film, &Control::default());
    stats.stages.iter().map(|s| s.name).collect()
}

fn settings() -> Settings {
    Settings {
        spp: 4,
        threads: 1,
        ..Settings::default()
    }
}

const PATHS: [&str; 9] = [
    "origin",
    "direction",
    "throughput",
    "pdf",
    "leaves",
    "slot",
    "pixel",
    "sample",
    "bounces",
];
const SHADOWS: [&str; 8] = [
    "origin",
    "direction",
    "t_max",
    "leaves",
    "reaches",
    "radiance",
    "slot",
    "bounces",
];

#[test]
fn a_diffuse_box_runs_and_holds_nothing_else() {
    let scene = scenes::cornell_box(16);
    let plan = plan(&scene, &settings());
    assert_eq!(
        effects(&plan),
        [
            "emissive triangles",
            "plain diffuse",
            "roulette",
            "next-event estimation"
        ]
    );
    let stages = [
        "generate",
        "intersect",
        "sort",
        "shade: emission",
        "shade: surface",
        "occlude",
        "roulette",
        "film",
    ];
    assert_eq!(plan.stages, stages);
    assert_eq!(ran(&scene, &settings()), stages);
    assert_eq!(
        queues(&plan),
        [
            ("paths", PATHS.to_vec()),
            ("hits", vec!["primitive", "t", "u", "v"]),
            ("emission list", vec!["index"]),
            ("shade: surface", vec!["index"]),
            ("scattered", PATHS.to_vec()),
            ("shadows", SHADOWS.to_vec()),
            ("occlusion", vec!["occluded"]),
        ]
    );
}

#[test]
fn without_light_samples_there_are_no_occlusion_rays() {
    let scene = scenes::cornell_box(16);
    let settings = Settings {
        strategy: Strategy::Cosine,
        ..settings()
    };
    let plan = plan(&scene, &settings);
    assert!(!plan.stages.contains(&"occlude"));
    assert!(
        !queues(&plan)
            .iter()
            .any(|q| q.0 == "shadows" || q.0 == "occlusion")
    );
    assert_eq!(ran(&scene, &settings), plan.stages);
}

#[test]
fn a_rough_wall_adds_its_own_stages_and_queues() {
    let mut scene = scenes::cornell_box(16);
    let before = plan(&scene, &settings());
    if let Bsdf::Diffuse { roughness, .. } = &mut scene.materials[0].bsdf {
        *roughness = 0.5;
    }
    let after = plan(&scene, &settings());
    let added = |a: Vec<&str>, b: Vec<&str>| -> Vec<String> {
        let new = a.into_iter().filter(|s| !b.contains(s));
        new.map(str::to_owned).collect()
    };
    assert_eq!(added(effects(&after), effects(&before)), ["rough diffuse"]);
    assert_eq!(
        added(after.stages.clone(), before.stages.clone()),
        ["interact", "sample lights", "shade: rough diffuse"]
    );
    let names =
        |plan: &Plan| -> Vec<String> { plan.queues.iter().map(|q| q.name.to_owned()).collect() };
    let new: Vec<String> = names(&after)
        .into_iter()
        .filter(|q| !names(&before).contains(q))
        .collect();
    assert_eq!(
        new,
        [
            "shade: rough diffuse",
            "surfaces",
            "drawn numbers",
            "light samples"
        ]
    );
    assert_eq!(ran(&scene, &settings()), after.stages);
    assert!(after.effects.iter().any(|e| e.name == "rough diffuse"
        && e.reason == format!("material `{}`", scene.materials[0].name)));
}

#[test]
fn images_add_a_stage_and_a_queue_where_surfaces_read_them() {
    let folder = Folder::new();
    let image = image::ImageBuffer::from_pixel(2, 2, image::Rgb([100u8, 150, 200]));
    image.save(folder.path("i.png")).unwrap();
    let scene = |albedo: &str| {
        let text = format!(
            "[sky]\nradiance = 1\n[film]\nwidth = 16\nheight = 16\n\
             [materials.other]\nkind = \"conductor\"\nmetal = \"gold\"\n\
             [materials.m]\nroughness = 0.5\nalbedo = {albedo}\n\
             [[shapes]]\nmaterial = \"m\"\nbox = {{ min = [0, 0, 0], max = [1, 1, 1] }}\n\
             [[shapes]]\nmaterial = \"other\"\nbox = {{ min = [2, 0, 0], max = [3, 1, 1] }}\n"
        );
        folder.scene_of(&text)
    };
    let plain = plan(&scene("0.5"), &settings());
    let textured = scene("{ file = \"i.png\" }");
    let read = plan(&textured, &settings());
    let added = |a: Vec<&'static str>, b: &[&'static str]| -> Vec<&'static str> {
        a.into_iter().filter(|s| !b.contains(s)).collect()
    };
    assert_eq!(added(read.stages.clone(), &plain.stages), ["texture"]);
    let names = |plan: &Plan| -> Vec<&'static str> { plan.queues.iter().map(|q| q.name).collect() };
    assert_eq!(added(names(&read), &names(&plain)), ["textured surfaces"]);
    assert_eq!(
        read.effects.len() - plain.effects.len(),
        1,
        "nothing else is called for"
    );
    let effect = read.effects.iter().find(|e| e.name == "textures");
    assert_eq!(effect.map(|e| &e.reason[..]), Some("material `m`"));
    assert_eq!(ran(&textured, &settings()), read.stages);
}

/// Dispersion is asked for by a glass that disperses, and adds a stage and a column a path.
#[test]
fn a_dispersive_glass_adds_wavelengths_and_plain_glass_does_not() {
    let with = |dispersion| {
        let mut scene = scenes::cornell_box(16);
        scene.materials[0].bsdf = Bsdf::Dielectric(Box::new(Dielectric {
            dispersion,
            ..Dielectric::default()
        }));
        scene
    };
    let plain = plan(&with(None), &settings());
    assert!(!plain.stages.contains(&"disperse"));
    assert!(!queues(&plain).iter().any(|q| q.0.contains("wavelengths")));
    let scene = with(Some(Cauchy::from_abbe(1.5, 40.0)));
    let dispersive = plan(&scene, &settings());
    let glass = scene.materials[0].name.clone();
    let reason = |name: &str| dispersive.effects.iter().find(|e| e.name == name);
    assert_eq!(
        reason("dispersion").expect("an effect").reason,
        format!("material `{glass}`")
    );
    assert!(dispersive.stages.contains(&"disperse"));
    for queue in ["wavelengths", "scattered wavelengths"] {
        let found = queues(&dispersive).into_iter().find(|q| q.0 == queue);
        assert_eq!(found.expect(queue).1, ["wavelength"]);
    }
    assert_eq!(ran(&scene, &settings()), dispersive.stages);
}

/// Fog adds a stage and a column; that it scatters, a list and a kernel.
#[test]
fn a_medium_adds_its_stages_and_nothing_else_does() {
    let with = |scattering: [f32; 3]| {
        let mut scene = scenes::cornell_box(16);
        scene.media.push(Medium {
            name: "mist".into(),
            absorption: [1e-4; 3],
            scattering,
            g: 0.0,
        });
        scene
    };
    let unused = plan(&with([1e-3; 3]), &settings());
    assert!(!unused.stages.contains(&"travel"), "nothing is filled");
    let fog = |scattering| {
        let mut scene = with(scattering);
        scene.fog = Some(Fog {
            medium: 0,
            bounds: None,
        });
        scene
    };
    let absorbing = plan(&fog([0.0; 3]), &settings());
    assert!(absorbing.stages.contains(&"travel"));
    assert!(!absorbing.stages.contains(&"shade: medium"));
    let scene = fog([1e-3; 3]);
    let scattering = plan(&scene, &settings());
    let reason = |name: &str| scattering.effects.iter().find(|e| e.name == name);
    assert_eq!(
        reason("media").expect("an effect").reason,
        "the scene's `fog`"
    );
    assert_eq!(
        reason("scattering medium").expect("an effect").reason,
        "medium `mist`, of the scene's `fog`"
    );
    for queue in ["media", "scattered media"] {
        let found = queues(&scattering).into_iter().find(|q| q.0 == queue);
        assert_eq!(found.expect(queue).1, ["medium"]);
    }
    assert_eq!(ran(&scene, &settings()), scattering.stages);
    let look = Settings {
        integrator: Integrator::Normals,
        ..settings()
    };
    assert!(!plan(&scene, &look).stages.contains(&"travel"));
}

/// Motion adds a stage, a column a path and one an occlusion ray; stillness adds nothing.
#[test]
fn what_moves_adds_times_and_what_stands_does_not() {
    let mut scene = scenes::cornell_box(16);
    let still = plan(&scene, &settings());
    assert!(!still.stages.contains(&"shutter"));
    assert!(!queues(&still).iter().any(|q| q.0.contains("times")));
    scene.camera_motion = Some(Motion {
        travel: [10.0, 0.0, 0.0],
        axis: [0.0, 1.0, 0.0],
        turns: 0.0,
    });
    let moves = plan(&scene, &settings());
    let motion = moves.effects.iter().find(|e| e.name == "motion");
    assert_eq!(motion.expect("an effect").reason, "the camera's `motion`");
    for queue in ["times", "scattered times", "shadow times"] {
        let found = queues(&moves).into_iter().find(|q| q.0 == queue);
        assert_eq!(found.expect(queue).1, ["time"]);
    }
    let mut others = queues(&moves);
    others.retain(|q| !q.0.contains("times"));
    assert_eq!(others, queues(&still));
    assert_eq!(ran(&scene, &settings()), moves.stages);
}
