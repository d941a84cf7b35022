//! The table of cases. To add one, add a row.

use crate::{beside, without, worn};
use huygens::scene::Scene;

/// A scene with and without an effect.
pub(crate) struct Case {
    /// The shipped scene's file, without `.toml`.
    pub(crate) scene: &'static str,
    /// What is compared.
    pub(crate) effect: &'static str,
    kind: Kind,
}

/// How the two scenes come about.
enum Kind {
    /// The shipped scene calls for it: this takes it away.
    Without(fn(&mut Scene)),
    /// Nothing in the shipped scene calls for it: this has all its walls wear it.
    Walls(fn(&mut Scene, usize)),
    /// A triangle that no ray meets wears it, instead of plain paint.
    Hidden(fn(&mut Scene, usize)),
    /// This brings something else that no ray meets.
    Beside(fn(&mut Scene)),
}

impl Case {
    /// What the filter looks at.
    pub(crate) fn name(&self) -> String {
        format!("{}/{}", self.scene, self.effect)
    }

    /// The scene without and with the effect.
    pub(crate) fn scenes(&self, shipped: &Scene) -> [Scene; 2] {
        let (mut without, mut with) = (shipped.clone(), shipped.clone());
        match self.kind {
            Kind::Without(change) => change(&mut without),
            Kind::Walls(change) => {
                for material in 0..with.materials.len() {
                    if !with.materials[material].emits() {
                        change(&mut with, material);
                    }
                }
            }
            Kind::Hidden(change) => {
                beside::hidden(&mut without);
                let material = beside::hidden(&mut with);
                change(&mut with, material);
            }
            Kind::Beside(change) => {
                beside::hidden(&mut without);
                change(&mut with);
            }
        }
        [without, with]
    }
}

const fn case(scene: &'static str, effect: &'static str, kind: Kind) -> Case {
    Case {
        scene,
        effect,
        kind,
    }
}

use Kind::{Beside, Hidden, Walls, Without};

const BOX: &str = "cornell-box";

/// All of them: first what an effect costs where rays meet it, then what it costs that it is there.
pub(crate) const CASES: &[Case] = &[
    case("gem", "dispersion", Without(without::one_index)),
    case(
        "depth-of-field",
        "depth of field",
        Without(without::pinhole),
    ),
    case("fog", "media", Without(without::clear_air)),
    case("fog", "fog alone", Without(without::no_fog)),
    case("motion", "motion", Without(without::freeze)),
    case("textures", "textures", Without(without::paint)),
    case(
        "textures",
        "normal and bump maps",
        Without(without::flatten),
    ),
    case("textures", "opacity", Without(without::whole)),
    case(
        "textures",
        "image of emission",
        Without(without::even_lamps),
    ),
    case(
        "glass-and-metal",
        "compensation",
        Without(without::scatter_once),
    ),
    case("bedroom", "environment map", Without(without::even_sky)),
    case("bedroom", "shading normals", Without(without::facets)),
    case(
        "many-lights",
        "light tree, over power",
        Without(without::by_power),
    ),
    case(
        "many-lights",
        "light tree, over uniform",
        Without(without::uniformly),
    ),
    case(BOX, "light tree of two", Beside(beside::along_a_tree)),
    case(BOX, "walls: diffuse, three passes", Walls(worn::diffuse)),
    case(BOX, "walls: rough diffuse", Walls(worn::rough_diffuse)),
    case(BOX, "walls: polished metal", Walls(worn::mirror)),
    case(BOX, "walls: rough metal", Walls(worn::metal)),
    case(BOX, "walls: brushed metal", Walls(worn::brushed)),
    case(BOX, "walls: thin panes", Walls(worn::pane)),
    case(BOX, "walls: frosted panes", Walls(worn::frosted_pane)),
    case(BOX, "walls: principled", Walls(worn::principled)),
    case(BOX, "walls: mix", Walls(worn::mix)),
    case(BOX, "hidden: rough diffuse", Hidden(worn::rough_diffuse)),
    case(BOX, "hidden: metal", Hidden(worn::metal)),
    case(BOX, "hidden: principled", Hidden(worn::principled)),
    case(BOX, "hidden: mix", Hidden(worn::mix)),
    case(BOX, "hidden: dispersive glass", Hidden(worn::prism)),
    case(BOX, "hidden: filled glass", Hidden(worn::filled)),
    case(BOX, "hidden: alpha mask", Hidden(worn::cut)),
    case(BOX, "hidden: image", Hidden(worn::image)),
    case(BOX, "hidden: sphere", Beside(beside::ball)),
    case(BOX, "hidden: copy", Beside(beside::copy)),
    case(BOX, "hidden: moving copy", Beside(beside::moving_copy)),
];
