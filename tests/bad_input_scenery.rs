//! What is wrong with a scene's camera and lights is said in one line: place, what was found, what was
//! expected.

mod scene_folder;

use scene_folder::Folder;

/// The message for a scene of this text, without the folder's name.
#[track_caller]
fn message(scene: &str) -> String {
    Folder::new().with("s.toml", scene).error("s.toml")
}

/// The warnings that a scene of this text gives.
fn warnings(scene: &str) -> Vec<String> {
    Folder::new().with("s.toml", scene).scene("s.toml").warnings
}

/// A camera at (0, 0, 5) that looks at the origin, and further keys.
fn lens_message(keys: &str) -> String {
    message(&format!(
        "[camera]\norigin = [0, 0, 5]\ntarget = [0, 0, 0]\n{keys}\n"
    ))
}

#[test]
fn motions_that_cannot_be() {
    let camera = "[camera]\norigin = [0, 0, 5]\ntarget = [0, 0, 0]\n";
    for (said, wrong) in [
        (
            "motion = { rotate = { axis = [0, 0, 0], degrees = 9 } }",
            "s.toml:4:21: camera.motion.rotate: the axis is zero, expected a direction",
        ),
        (
            "motion = { rotate = { axis = [0, 1, 0], degrees = -400 } }",
            "s.toml:4:21: camera.motion.rotate: found -400 degrees, expected a turn of at most 360",
        ),
        (
            "motion = { translate = [1, 2] }",
            "s.toml:4:24: camera.motion.translate: found an array of length 2, expected an array of length 3",
        ),
        (
            "motion = { scale = 2 }",
            "s.toml:4:12: unknown key `scale` in `camera.motion`, expected `translate` or `rotate`",
        ),
    ] {
        assert_eq!(message(&format!("{camera}{said}\n")), wrong);
    }
    let instance = "[[objects.o.shapes]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n\
                    [[instances]]\nobject = \"o\"\n\
                    motion = { rotate = { axis = [1, 0, 0], degrees = 361 } }\n";
    assert_eq!(
        message(instance),
        "s.toml:5:21: instances[0].motion.rotate: found 361 degrees, expected a turn of at most 360"
    );
}

#[test]
fn media_that_cannot_be() {
    for (text, wrong) in [
        (
            "[media.a]\nabsorption = -1\n",
            "s.toml:2:14: media.a.absorption: found -1, expected a finite number of at least 0",
        ),
        (
            "[media.a]\nscattering = [1, 2, -0.5]\n",
            "s.toml:2:21: media.a.scattering: found -0.5, expected a finite number of at least 0",
        ),
        (
            "[media.a]\ng = 1\n",
            "s.toml:2:5: media.a.g: found 1, expected a number from -0.999 to 0.999",
        ),
        (
            "[media.a]\ng = -1.5\n",
            "s.toml:2:5: media.a.g: found -1.5, expected a number from -0.999 to 0.999",
        ),
        (
            "[media.a]\nabsorption = 3e38\nscattering = 3e38\n",
            "s.toml:1:1: media.a: absorption and scattering together are beyond 32-bit floats",
        ),
        (
            "[media.mist]\n[fog]\nmedium = \"mits\"\n",
            "s.toml:3:10: fog.medium: no medium `mits`, did you mean `mist`?",
        ),
        (
            "[media.mist]\n[fog]\nmedium = \"mist\"\nwithin = { min = [0, 0, 0], max = [1, 0, 1] }\n",
            "s.toml:4:10: fog.within: found a box without volume, expected `min` below `max` on each \
             axis",
        ),
        (
            "[media.mist]\n[materials.m]\nkind = \"dielectric\"\nthin = true\ninterior = \"mist\"\n",
            "s.toml:5:12: materials.m.interior: found in a `thin` pane, which has no inside",
        ),
        (
            "[materials.m]\nkind = \"dielectric\"\ninterior = \"mist\"\n",
            "s.toml:3:12: materials.m.interior: no medium `mist`, expected none",
        ),
        (
            "[media.mist]\n[materials.m]\nkind = \"dielectric\"\nthin = true\nexterior = \"mist\"\n",
            "s.toml:5:12: materials.m.exterior: found in a `thin` pane, which has no inside",
        ),
        (
            "[media.mist]\n[materials.m]\nkind = \"principled\"\nexterior = \"mist\"\n",
            "s.toml:4:12: materials.m.exterior: `exterior` is for what light passes: `transmission` is \
             0, or all is metal",
        ),
    ] {
        assert_eq!(message(text), wrong);
    }
}

#[test]
fn cameras_of_unknown_kinds_and_keys_of_other_kinds() {
    assert_eq!(
        lens_message("kind = \"ortographic\""),
        "s.toml:4:8: camera.kind: unknown value `ortographic`, did you mean `orthographic`?"
    );
    assert_eq!(
        lens_message("apertur = 1"),
        "s.toml:4:1: unknown key `apertur` in `camera`, did you mean `aperture`?"
    );
    assert_eq!(
        lens_message("width = 3"),
        "s.toml:4:9: camera.width: `width` is for kind = \"orthographic\", \
         the camera is \"perspective\""
    );
    assert_eq!(
        lens_message("kind = \"orthographic\"\nwidth = 3\nfov = 30"),
        "s.toml:6:7: camera.fov: `fov` is for kind = \"perspective\", \
         the camera is \"orthographic\""
    );
    assert_eq!(
        lens_message("kind = \"panorama\"\naperture = 0.5"),
        "s.toml:5:12: camera.aperture: `aperture` is for kind = \"perspective\", \
         the camera is \"panorama\""
    );
    assert_eq!(
        lens_message("kind = \"orthographic\""),
        "s.toml:1:1: camera: an orthographic camera needs `width`, \
         the extent of the image in scene units"
    );
    assert_eq!(
        lens_message("kind = \"orthographic\"\nwidth = 0"),
        "s.toml:5:9: camera.width: found 0, expected a finite number above 0"
    );
    assert_eq!(
        lens_message("kind = \"orthographic\"\nwidth = 1e-45"),
        "s.toml:5:9: camera.width: the image is too small or too large for 32-bit floats"
    );
}

#[test]
fn lenses_that_cannot_be() {
    assert_eq!(
        lens_message("aperture = -0.1"),
        "s.toml:4:12: camera.aperture: found -0.1, expected 0 or a finite number above 0"
    );
    assert_eq!(
        lens_message("focus = 3"),
        "s.toml:4:9: camera.focus: does nothing without `aperture`, the radius of the lens"
    );
    assert_eq!(
        lens_message("aperture = 0.1\nfocus = 0"),
        "s.toml:5:9: camera.focus: found 0, expected a finite number above 0"
    );
    assert_eq!(
        lens_message("aperture = 0.1\nfocus = 3\nfocus_at = [0, 0, 0]"),
        "s.toml:6:12: camera.focus_at: expected either `focus` or `focus_at`, found both"
    );
    assert_eq!(
        lens_message("aperture = 0.1\nfocus_at = [0, 0, 6]"),
        "s.toml:5:12: camera.focus_at: the point lies behind the camera, expected one before it"
    );
    assert_eq!(
        lens_message("aperture = 1e20\nfocus = 1e-20"),
        "s.toml:5:9: camera.focus: the focus is too near or too far for 32-bit floats"
    );
    let matrix = "[camera]\nmatrix = [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\naperture = 1\n";
    assert_eq!(
        message(matrix),
        "s.toml:3:12: camera.aperture: a lens needs `focus` or `focus_at` \
         where there is no `target`"
    );
}

#[test]
fn skies_that_contradict_themselves() {
    assert_eq!(
        message("[sky]\nradiance = 1\nsun = [0, 1, 0]\n"),
        "s.toml:1:1: sky: expected exactly one of `radiance`, `map` and `sun`"
    );
    assert_eq!(
        message("[sky]\nradiance = 1\nscale = 2\n"),
        "s.toml:3:9: sky.scale: a sky of `radiance` has no `scale`"
    );
    assert_eq!(
        message("[sky]\nsun = [0, 1, 0]\nrotate = 2\n"),
        "s.toml:3:10: sky.rotate: a sky of `sun` has no `rotate`"
    );
    assert_eq!(
        message("[sky]\nsun = [1, -0.1, 0]\n"),
        "s.toml:2:7: sky.sun: is not above the horizon, expected a sun that is up"
    );
    assert_eq!(
        message("[sky]\nsun = [0, 1, 0]\nturbidity = 1\n"),
        "s.toml:3:13: sky.turbidity: found 1, expected a number from 2 to 10"
    );
    assert_eq!(
        message("[sky]\nsun = [0, 1, 0]\nup = [0, 0, 0]\n"),
        "s.toml:3:6: sky.up: found a vector of length 0, expected a direction"
    );
}

#[test]
fn lights_that_are_wrong() {
    let light = |text: &str| message(&format!("[[lights]]\n{text}\n"));
    let point = "point = { position = [0, 1, 0] }\n";
    let sun = "sun = { from = [0, 1, 0] }\n";
    assert_eq!(
        light("power = 1"),
        "s.toml:1:1: lights[0]: expected exactly one of `point`, `spot` and `sun`"
    );
    assert_eq!(
        light(&format!("{point}{sun}power = 1")),
        "s.toml:1:1: lights[0]: expected exactly one of `point`, `spot` and `sun`"
    );
    assert_eq!(
        light(point),
        "s.toml:1:1: lights[0]: expected either `power` or `intensity`"
    );
    assert_eq!(
        light(sun),
        "s.toml:1:1: lights[0]: expected either `irradiance` or `radiance`"
    );
    assert_eq!(
        light(&format!("{point}irradiance = 1")),
        "s.toml:3:14: lights[0].irradiance: a point and a spot have a `power` or an `intensity`, not \
         `irradiance`"
    );
    assert_eq!(
        light(&format!("{sun}power = 1")),
        "s.toml:3:9: lights[0].power: a sun has an `irradiance` or a `radiance`, not `power`"
    );
    assert_eq!(
        light(&format!("{sun}radiance = 1")),
        "s.toml:3:12: lights[0].radiance: a sun without an `angle` has no `radiance`: expected \
         `irradiance`"
    );
    assert_eq!(
        light(&format!("{point}power = -1")),
        "s.toml:3:9: lights[0].power: found -1, expected a finite number of at least 0"
    );
    assert_eq!(
        light("sun = { from = [0, 1, 0], angle = 1e-9 }\nirradiance = 1e30"),
        "s.toml:3:14: lights[0].irradiance: is beyond 32-bit floats for a light of this angle"
    );
    assert_eq!(
        light("spot = { position = [1, 1, 0], target = [1, 1, 0], angle = 20 }\npower = 1"),
        "s.toml:2:41: lights[0].spot.target: is where the light stands, expected another point"
    );
    assert_eq!(
        light("spot = { position = [1, 1, 0], target = [1, 0, 0], angle = 180 }\npower = 1"),
        "s.toml:2:60: lights[0].spot.angle: found 180, expected an angle above 0 and below 180 degrees"
    );
    assert_eq!(
        warnings("[[lights]]\nname = \"dead\"\npoint = { position = [0, 1, 0] }\npower = 0\n")[0],
        "light `dead` is black: left out"
    );
}
