//! Triangles of the world among spheres and copies: a hit is where it is, to the bit, whatever it shares a
//! vector with.

mod common;

use common::Source;
use huygens_kernels::instance::{Guide, Instance, OWN_MATERIAL};
use huygens_kernels::interpolate::{Attributes, Interpolated};
use huygens_kernels::lanes::{Fx, LANES, Ux};
use huygens_kernels::motion::STILL;
use huygens_kernels::octahedral;
use huygens_kernels::others::{Object, Others};
use huygens_kernels::sphere::Sphere;
use huygens_kernels::surface::Place;
use huygens_kernels::tables::Triangles;
use huygens_kernels::vec3::Vec3x;

const TRIANGLES: usize = 64;

/// The bits of a lane of all that is known of a hit.
fn bits(triangles: &Triangles, attributes: &Attributes, primitive: Ux, lane: usize) -> Vec<u32> {
    let (u, v) = (Fx::splat(0.3), Fx::splat(0.25));
    let place = Place::of(triangles, primitive, u, v, || None);
    let there = Interpolated::met(
        triangles,
        attributes,
        primitive,
        || place.outside,
        (u, v),
        || None,
    );
    let vector = |v: Vec3x| v.lane(lane).map(f32::to_bits).to_vec();
    let number = |x: Fx| x.as_array()[lane].to_bits();
    let mut all = vec![place.material.as_array()[lane], number(place.clearance)];
    all.extend([place.point, place.outside].map(vector).concat());
    all.extend([there.coherence, there.uv_per_length].map(number));
    all.extend(there.uv.map(number));
    let vectors = [
        there.normal,
        there.tangent,
        there.bitangent,
        there.gradient_u,
        there.gradient_v,
    ];
    all.extend(vectors.map(vector).concat());
    all
}

#[test]
fn a_hit_is_the_same_whatever_shares_its_vector() {
    let mut source = Source(7);
    // Zeros of either sign among them.
    let vertices: Vec<[f32; 3]> = (0..3 * TRIANGLES)
        .map(|i| {
            [0, 1, 2].map(|k| {
                if (i + k) % 5 == 0 {
                    -0.0
                } else {
                    source.unit() - 0.5
                }
            })
        })
        .collect();
    let indices: Vec<[u32; 3]> = (0..TRIANGLES as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let normals: Vec<u32> = (0..vertices.len())
        .map(|_| octahedral::encode([0, 1, 2].map(|_| f64::from(source.unit()) - 0.4)))
        .collect();
    let uvs: Vec<[f32; 2]> = (0..vertices.len())
        .map(|_| [source.unit(), source.unit()])
        .collect();
    let attributes = Attributes {
        normals: &normals,
        uvs: &uvs,
    };
    let material: Vec<u32> = (0..TRIANGLES as u32).collect();
    let object = Object {
        vertices: &vertices,
        indices: &indices,
        material: &material,
        attributes,
    };
    let first = TRIANGLES as u32;
    let instance = Instance {
        to_object: [[0.0, 2.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0]],
        to_world: [[0.0, 2.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0]],
        origin: [3.0, 4.0, 5.0],
        first: first + 1,
        material: OWN_MATERIAL,
        motion: STILL,
        ..bytemuck::Zeroable::zeroed()
    };
    let guide = Guide::new(&[instance], 2 * first + 1);
    let others = Others {
        first,
        spheres: &[Sphere {
            centre: [1.0, 2.0, 3.0],
            radius: 0.5,
        }],
        sphere_material: &[0],
        sphere_turns: &[],
        sphere_selection: &[0.0],
        instances: &[instance],
        motions: &[],
        guide: &guide,
        objects: &[object],
    };
    let alone = Triangles {
        vertices: &vertices,
        indices: &indices,
        material: &material,
        others: None,
    };
    let among = Triangles {
        others: Some(others),
        ..alone
    };
    for i in 0..first - 8 {
        let plain = Ux::new(std::array::from_fn(|lane| i + lane as u32));
        for (lane, other) in [(3, first), (5, first + 4), (0, first + 9)] {
            let mut mixed = plain.to_array();
            mixed[lane] = other;
            // A sphere and a copy.
            mixed[(lane + 2) % LANES] = 2 * first - 1;
            for kept in (0..LANES).filter(|&k| mixed[k] < first) {
                let expected = bits(&alone, &attributes, plain, kept);
                let [all, some] =
                    [plain, Ux::new(mixed)].map(|p| bits(&among, &attributes, p, kept));
                assert_eq!(all, expected, "triangle {i}, lane {kept}");
                assert_eq!(some, expected, "triangle {i}, lane {kept}, {mixed:?}");
            }
        }
    }
}
