//! The scenes that ship load without a warning, and a bare OBJ is framed and lit.

use huygens::scene::{self, Bsdf, Extent, Material, Projection, Scene, Sky};
use std::path::Path;

fn load(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name);
    let scene = scene::load(&path).expect(name);
    assert_eq!(scene.warnings, Vec::<String>::new(), "{name}");
    keeps_its_promises(&scene);
    scene
}

/// What the documentation of `Scene`'s tables says of them.
fn keeps_its_promises(scene: &Scene) {
    let mesh = &scene.mesh;
    assert_eq!(mesh.material.len(), mesh.triangles());
    assert!(mesh.vertices.iter().flatten().all(|x| x.is_finite()));
    for (triangle, &material) in mesh.indices.iter().zip(&mesh.material) {
        assert!(triangle.iter().all(|&v| (v as usize) < mesh.vertices.len()));
        assert!((material as usize) < scene.materials.len());
    }
    for material in &scene.materials {
        assert!(
            material
                .albedo(&scene.materials)
                .iter()
                .all(|a| (0.0..=1.0).contains(a))
        );
        let emission = material.emission.factor;
        assert!(emission.iter().all(|&e| e >= 0.0 && e.is_finite()));
    }
    let c = &scene.camera;
    let axes = [c.right, c.up, c.forward].map(|v| glam::DVec3::from_array(v.map(f64::from)));
    for (i, a) in axes.iter().enumerate() {
        for (j, b) in axes.iter().enumerate() {
            // Each component was rounded once to f32: 3 products of numbers of at most 1.
            let off = (a.dot(*b) - f64::from(u8::from(i == j))).abs();
            assert!(off <= 3.0 * f64::from(f32::EPSILON), "axes {i} and {j}");
        }
    }
    assert!(
        axes[0].cross(axes[1]).dot(axes[2]) < 0.0,
        "right, up, forward is left-handed"
    );
}

/// Twice a triangle's area times its unit normal.
fn area_vector(scene: &Scene, i: usize) -> glam::DVec3 {
    let [a, b, c] = scene
        .mesh
        .corners(i)
        .map(|v| glam::DVec3::from_array(v.map(f64::from)));
    (b - a).cross(c - a)
}

#[test]
fn cornell_box_is_the_measured_one() {
    let scene = load("cornell-box.toml");
    assert_eq!((scene.film.width, scene.film.height), (512, 512));
    assert_eq!(scene.mesh.triangles(), 12 + 2 + 2 + 2 + 20);
    assert_eq!(scene.camera.right, [-1.0, 0.0, 0.0]);
    // The film of the data page: half of 0.025 at focal length 0.035, to the angle's 6 digits.
    let Projection::Perspective { extent, lens: None } = scene.camera.projection else {
        panic!("a pinhole");
    };
    assert!((extent.half_width - 0.0125 / 0.035).abs() < 1e-6);
    let light = scene.materials.iter().position(|m| m.emits()).unwrap();
    let emitting = (0..scene.mesh.triangles())
        .filter(|&i| scene.mesh.material[i] as usize == light)
        .map(|i| area_vector(&scene, i))
        .sum::<glam::DVec3>();
    assert_eq!((0.5 * emitting).to_array(), [0.0, -13650.0, 0.0]);
    assert_eq!(scene.sky, None);
}

#[test]
fn many_lights_are_a_thousand() {
    let scene = load("many-lights.toml");
    let emits = |&i: &usize| scene.materials[scene.mesh.material[i] as usize].emits();
    assert_eq!((0..scene.mesh.triangles()).filter(emits).count(), 1000);
}

/// Every use of images at once, each file read once for each way of understanding it.
#[test]
fn textures_are_of_every_kind() {
    let scene = load("textures.toml");
    assert_eq!(scene.warnings, Vec::<String>::new());
    assert_eq!(scene.unsupported(), None);
    assert_eq!(
        scene.textures.len(),
        8,
        "leaves and glass twice, as colours and as numbers"
    );
    let has = |of: fn(&Material) -> bool| scene.materials.iter().any(of);
    assert!(has(|m| m.emission_varies()) && has(|m| m.normal_map.is_some()));
    assert!(has(|m| m.alpha.is_some_and(|a| a.cutoff.is_some())));
    assert!(has(|m| m.alpha.is_some_and(|a| a.cutoff.is_none())));
}

#[test]
fn furnace_is_closed_and_faces_inwards() {
    let scene = load("furnace.toml");
    assert_eq!(scene.mesh.triangles(), 12);
    for i in 0..12 {
        let corner = glam::DVec3::from_array(scene.mesh.corners(i)[0].map(f64::from));
        assert!(area_vector(&scene, i).dot(corner) < 0.0);
    }
    let edges: std::collections::HashSet<_> = scene
        .mesh
        .indices
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .collect();
    assert_eq!(edges.len(), 36, "every edge once in each direction");
    assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
}

#[test]
fn bedroom_is_of_sponzas_size_and_lit_by_its_pane() {
    let scene = load("bedroom.toml");
    assert!(scene.mesh.triangles() >= 66_445);
    let pane = scene.materials.iter().position(Material::emits).unwrap();
    for i in 0..scene.mesh.triangles() {
        if scene.mesh.material[i] as usize == pane {
            assert!(
                area_vector(&scene, i).x > 0.0,
                "the pane shines into the room"
            );
        }
    }
    let used = |m: &Material| {
        let i = scene.materials.iter().position(|n| n == m).unwrap();
        scene.mesh.material.contains(&(i as u32))
    };
    let brightest = scene.materials.iter().filter(|m| used(m));
    let brightest = brightest
        .flat_map(|m| m.albedo(&scene.materials))
        .fold(0.0, f32::max);
    assert_eq!(
        brightest, 0.91,
        "what the file says of its brightest reflectance"
    );
}

#[test]
fn veach_lights_have_equal_power() {
    let scene = load("veach-lights.toml");
    let mut power = std::collections::BTreeMap::new();
    for i in 0..scene.mesh.triangles() {
        let material = &scene.materials[scene.mesh.material[i] as usize];
        if material.emits() {
            let area = 0.5 * area_vector(&scene, i).length();
            *power.entry(&material.name).or_insert(0.0) +=
                area * std::f64::consts::PI * f64::from(material.emission.factor[0]);
        }
    }
    assert_eq!(power.len(), 4);
    for (name, watts) in power {
        // An edge of e between coordinates of up to 4 is off by at most 2^-23 * 4 / e, relatively;
        // e is at least 0.05, and an area has two edges.
        let relative = 2.0 * 4.0 / 0.05 * f64::from(f32::EPSILON);
        let exact = std::f64::consts::PI * 6.0 * 2.56;
        assert!((watts / exact - 1.0).abs() <= relative, "{name}: {watts} W");
    }
}

#[test]
fn depth_of_field_is_focused_on_a_cubes_front() {
    let scene = load("depth-of-field.toml");
    let Projection::Perspective {
        lens: Some(lens), ..
    } = scene.camera.projection
    else {
        panic!("a lens");
    };
    assert_eq!((lens.radius, lens.focus), (0.12, 6.0));
    let front = scene.camera.origin[2] - lens.focus;
    let green = scene.materials.iter().position(|m| m.name == "green");
    let green = green.unwrap() as u32;
    let corners = (0..scene.mesh.triangles())
        .filter(|&i| scene.mesh.material[i] == green)
        .flat_map(|i| scene.mesh.corners(i));
    assert_eq!(corners.map(|c| c[2]).fold(f32::MIN, f32::max), front);
}

#[test]
fn the_documented_example_loads_and_says_what_its_comments_say() {
    let text = include_str!("../docs/scene-format.md");
    let example = text.split("```toml\n").nth(1).unwrap();
    let example = example.split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("example.toml");
    std::fs::write(&path, example).unwrap();
    let scene = scene::load(&path).unwrap();
    keeps_its_promises(&scene);
    assert_eq!(scene.warnings, Vec::<String>::new());
    let normal_of = |name: &str| {
        let material = scene.materials.iter().position(|m| m.name == name).unwrap();
        let first = scene
            .mesh
            .material
            .iter()
            .position(|&m| m as usize == material);
        area_vector(&scene, first.unwrap()).normalize().to_array()
    };
    assert_eq!(normal_of("lamp"), [0.0, -1.0, 0.0], "shines downwards");
    assert_eq!(normal_of("default"), [0.0, 1.0, 0.0], "the floor faces up");
}

#[test]
fn the_hash_follows_the_image_and_not_the_layout() {
    let hash = |text: &str| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.toml");
        std::fs::write(&path, text).unwrap();
        scene::load(&path).unwrap().hash
    };
    let shape = "[[shapes]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n";
    let base = hash(shape);
    assert_eq!(
        base,
        hash(&format!(
            "# a comment\nname = \"x\"\n[settings]\nspp = 3\n{shape}"
        ))
    );
    for other in [
        "[sky]\nradiance = 0\n",
        "[film]\nwidth = 1281\n",
        "[film]\nfilter = \"box\"\n",
        "[camera]\norigin = [5, 5, 5]\ntarget = [0, 0, 0]\n",
        "[materials.a]\n",
    ] {
        assert_ne!(base, hash(&format!("{other}{shape}")), "{other}");
    }
    assert_ne!(base, hash(&shape.replace("max = [1", "max = [2")));
    // Cameras of one place differ by all that they are asked for; a lens of no size is none.
    let camera = |keys: &str| {
        let place = "[camera]\norigin = [5, 5, 5]\ntarget = [0, 0, 0]\n";
        hash(&format!("{place}{keys}\n{shape}"))
    };
    let pinhole = camera("");
    assert_eq!(pinhole, camera("aperture = 0\nfocus = 3"));
    let others = [
        "aperture = 0.5",
        "aperture = 0.5\nfocus = 3",
        "aperture = 0.25\nfocus = 3",
        "kind = \"orthographic\"\nwidth = 1",
        "kind = \"orthographic\"\nwidth = 2",
        "kind = \"panorama\"",
    ];
    let hashes: std::collections::HashSet<_> = others.iter().map(|k| camera(k)).collect();
    assert!(hashes.len() == others.len() && !hashes.contains(&pinhole));
}

#[test]
fn a_camera_is_what_its_keys_say() {
    let camera = |keys: &str| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.toml");
        let text = format!("[camera]\norigin = [0, 0, 5]\ntarget = [0, 0, 1]\n{keys}\n");
        std::fs::write(&path, text + "[film]\nwidth = 200\nheight = 100\n").unwrap();
        scene::load(&path).unwrap().camera.projection
    };
    let lens = |keys: &str| match camera(keys) {
        Projection::Perspective { lens, .. } => lens.map(|l| (l.radius, l.focus)),
        other => panic!("{other:?}"),
    };
    assert_eq!(lens(""), None);
    assert_eq!(lens("aperture = 0\nfocus = 3"), None);
    assert_eq!(lens("aperture = 0.5"), Some((0.5, 4.0)), "at the target");
    assert_eq!(lens("aperture = 0.5\nfocus = 3"), Some((0.5, 3.0)));
    // Along the view, not as the crow flies.
    assert_eq!(
        lens("aperture = 0.5\nfocus_at = [9, -7, 2]"),
        Some((0.5, 3.0))
    );
    let extent = Extent {
        half_width: 3.0,
        half_height: 1.5,
    };
    assert_eq!(
        camera("kind = \"orthographic\"\nwidth = 6"),
        Projection::Orthographic { extent }
    );
    assert_eq!(camera("kind = \"panorama\""), Projection::Panorama);
}

#[test]
fn a_bare_obj_gets_a_camera_and_a_sky() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plain.OBJ");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let scene = scene::load(&path).unwrap();
    keeps_its_promises(&scene);
    assert_eq!(scene.name, "plain");
    let sky = scene.sky.expect("nothing in it emits");
    let soft = Sky::Gradient {
        zenith: [1.5; 3],
        nadir: [0.3; 3],
    };
    assert_eq!(sky, soft);
    assert_eq!(scene.warnings, Vec::<String>::new());
}

#[test]
fn the_gem_is_closed_and_disperses() {
    let scene = load("gem.toml");
    let gem = |m: &Material| matches!(&m.bsdf, Bsdf::Dielectric(g) if g.dispersion.is_some());
    let gem = scene.materials.iter().position(gem).expect("a gem");
    let own = (0..scene.mesh.triangles()).filter(|&i| scene.mesh.material[i] == gem as u32);
    let areas: Vec<_> = own.map(|i| area_vector(&scene, i)).collect();
    // Of a closed surface the area vectors add up to nothing, but for the rounding of its corners.
    let (sum, total) = areas.iter().fold((glam::DVec3::ZERO, 0.0), |(v, a), n| {
        (v + *n, a + n.length())
    });
    assert!(sum.length() <= 8.0 * f64::from(f32::EPSILON) * total);
}

#[test]
fn the_fog_has_tea_and_milk_in_it() {
    let scene = load("fog.toml");
    let fog = scene.fog.expect("fog");
    assert_eq!(scene.media[fog.medium as usize].name, "mist");
    let tea = scene.media.iter().find(|m| m.name == "tea").expect("tea");
    // What the scene's first lines say of it, to their two digits.
    for (sigma, left) in tea.absorption.iter().zip([0.48, 0.12, 0.008]) {
        let found = (-1.2 * f64::from(*sigma)).exp();
        assert!((found - left).abs() <= 0.05 * left, "{found}");
    }
    assert_eq!(scene.media_in_use().count(), 3);
}

#[test]
fn of_the_scene_in_motion_two_instances_move() {
    let scene = load("motion.toml");
    let motions: Vec<_> = scene.instances.iter().map(|i| i.motion).collect();
    let [Some(wheel), Some(die), None] = motions[..] else {
        panic!("{motions:?}");
    };
    assert_eq!((wheel.travel, wheel.axis), ([0.0; 3], [0.0, 0.0, 1.0]));
    assert_eq!(wheel.turns, 30.0 / 360.0);
    assert_eq!(die.travel, [0.55, 0.3, 0.0]);
}
