//! Camera rays: each projection against its formula in f64, and the points of the lens.

mod common;

use common::{CORNERS, Source, Suite};
use huygens_kernels::camera::{Orthographic, Panorama, Perspective, Projection, ThinLens};
use huygens_kernels::disk::sample_concentric;
use huygens_kernels::lanes::{Fx, LANES};
use huygens_kernels::vec3::Vec3x;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Half a unit in the last place of 1: one rounding.
const ROUNDING: f64 = 1.0 / 16_777_216.0;
/// Bound of `math::sin_cos_turn`.
const SIN_COS: f64 = 1.2e-7;
/// What a coordinate of a lens point may be off: ratio, angle and product round once each, and the
/// sine or cosine.
const LENS: f64 = SIN_COS + 4.0 * ROUNDING;

type Point = [f64; 3];

fn wide(v: [f32; 3]) -> Point {
    v.map(f64::from)
}

/// `a + s b`.
fn add(a: Point, s: f64, b: Point) -> Point {
    std::array::from_fn(|c| a[c] + s * b[c])
}

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|c| a[c] * b[c]).sum()
}

fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: Point) -> Point {
    a.map(|c| c / length(a))
}

fn distance(a: Point, b: Point) -> f64 {
    length(add(a, -1.0, b))
}

/// Shirley and Chiu (1997), as they print it.
fn concentric_twin(u: f64, v: f64) -> [f64; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0; 2];
    }
    let (r, phi) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * b / a)
    } else {
        (b, FRAC_PI_2 - FRAC_PI_4 * a / b)
    };
    [r * phi.cos(), r * phi.sin()]
}

#[test]
fn lens_points_are_uniform_over_the_disk() {
    const RINGS: usize = 16;
    const SECTORS: usize = 48;
    let mut source = Source(23);
    let mut observed = [0u64; RINGS * SECTORS];
    for _ in 0..(1 << 20) / LANES {
        let [x, y] = sample_concentric(source.unit_lanes(), source.unit_lanes());
        for lane in 0..LANES {
            let [x, y] = [x, y].map(|c| f64::from(c.as_array()[lane]));
            // Rings of equal area.
            let ring = (((x * x + y * y) * RINGS as f64) as usize).min(RINGS - 1);
            let turn = (y.atan2(x) / TAU).rem_euclid(1.0);
            let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
            observed[ring * SECTORS + sector] += 1;
        }
    }
    let mut suite = Suite::default();
    suite.test_uniform("lens", &observed);
    suite.finish();
}

#[test]
fn the_ends_of_the_unit_square_lie_on_the_disk() {
    for v in CORNERS {
        let [x, y] = sample_concentric(Fx::new(CORNERS), Fx::splat(v));
        for lane in 0..LANES {
            let [x, y] = [x, y].map(|c| f64::from(c.as_array()[lane]));
            let twin = concentric_twin(f64::from(CORNERS[lane]), f64::from(v));
            assert!((x - twin[0]).abs() <= LENS && (y - twin[1]).abs() <= LENS);
            assert!(x * x + y * y <= 1.0 + 4.0 * LENS);
        }
    }
    let middle = sample_concentric(Fx::splat(0.5), Fx::splat(0.5));
    assert_eq!(middle.map(|c| c.to_array()), [[0.0; LANES]; 2]);
}

/// Cameras about one frame, somewhere and turned somehow, of 64 by 48 pixels.
struct Cameras {
    forward: Point,
    focus: f64,
    pinhole: Perspective,
    lens: ThinLens,
    parallel: Orthographic,
    panorama: Panorama,
}

const SIZE: [f32; 2] = [64.0, 48.0];

impl Cameras {
    fn new(seed: u64) -> Self {
        let mut source = Source(seed);
        let forward = wide(source.direction());
        let other = wide(source.direction());
        let cross = |a: Point, b: Point| -> Point {
            std::array::from_fn(|c| {
                a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3]
            })
        };
        let forward = unit(forward);
        let right = unit(cross(forward, other));
        let up = cross(right, forward);
        let f32s = |v: Point| v.map(|c| c as f32);
        let scaled = |v: Point, s: f64| f32s(v.map(|c| c * s));
        let mut within = |low: f64, high: f64| low + (high - low) * f64::from(source.unit());
        let origin: Point = std::array::from_fn(|_| within(-5.0, 5.0));
        let half = within(0.05, 2.0);
        let (across, down) = (2.0 * half / 64.0, -2.0 * half / 64.0);
        let corner = |middle| add(add(middle, -half, right), half * 48.0 / 64.0, up);
        let (radius, focus) = (within(0.0, 2.0), within(0.5, 50.0));
        let pinhole = Perspective {
            origin: f32s(origin),
            corner: f32s(corner(forward)),
            right: scaled(right, across),
            down: scaled(up, down),
        };
        Self {
            forward,
            focus,
            pinhole,
            lens: ThinLens {
                pinhole,
                radii: [scaled(right, radius), scaled(up, radius)],
                slopes: [scaled(right, radius / focus), scaled(up, radius / focus)],
            },
            parallel: Orthographic {
                corner: f32s(corner(origin)),
                right: scaled(right, across),
                down: scaled(up, down),
                forward: f32s(forward),
            },
            panorama: Panorama {
                origin: f32s(origin),
                forward: f32s(forward),
                right: f32s(right),
                up: f32s(up),
                turns: [1.0 / SIZE[0], 0.5 / SIZE[1]],
            },
        }
    }

    /// `corner + x right + y down`, and the sum of the magnitudes added.
    fn in_image(
        corner: [f32; 3],
        right: [f32; 3],
        down: [f32; 3],
        [x, y]: [f64; 2],
    ) -> (Point, f64) {
        let [corner, right, down] = [corner, right, down].map(wide);
        let sum = length(corner) + x.abs() * length(right) + y.abs() * length(down);
        (add(add(corner, x, right), y, down), sum)
    }
}

/// A ray in the first lane of a kernel's answer.
fn ray(camera: &impl Projection, at: [f32; 2], lens: [f32; 2]) -> (Point, Point) {
    let (origin, direction) = camera.ray(Fx::splat(at[0]), Fx::splat(at[1]), lens.map(Fx::splat));
    for v in [origin, direction] {
        assert!((1..LANES).all(|lane| v.lane(lane) == v.lane(0)));
    }
    (wide(origin.lane(0)), wide(direction.lane(0)))
}

/// What normalising adds: three roundings of the square, half as much of its root, that of the root,
/// of the quotient and of the product.
const NORMALISED: f64 = 5.0 * ROUNDING;

fn unit_to(value: Point, expected: Point, bound: f64) -> Result<(), TestCaseError> {
    prop_assert!(
        (length(value) - 1.0).abs() <= 2.0 * NORMALISED,
        "length of {value:?}"
    );
    prop_assert!(
        distance(value, expected) <= bound,
        "{value:?} for {expected:?}, {bound:e}"
    );
    Ok(())
}

proptest! {
    #[test]
    fn lens_points_agree_with_their_twin(u in 0u32..1 << 24, v in 0u32..1 << 24) {
        let (u, v) = (u as f32 / 16_777_216.0, v as f32 / 16_777_216.0);
        let point = sample_concentric(Fx::splat(u), Fx::splat(v));
        let twin = concentric_twin(f64::from(u), f64::from(v));
        for (value, twin) in point.into_iter().zip(twin) {
            prop_assert!((f64::from(value.as_array()[0]) - twin).abs() <= LENS);
        }
    }

    /// Positions as far outside of the image as the widest filter reaches.
    #[test]
    fn rays_agree_with_their_twins(
        seed: u64,
        x in -1.65f32..65.65,
        y in -1.65f32..49.65,
        lens in prop::array::uniform2(0u32..1 << 24),
    ) {
        let cameras = Cameras::new(seed);
        let lens = lens.map(|u| u as f32 / 16_777_216.0);
        let (at, wide_at) = ([x, y], [x, y].map(f64::from));

        // A pinhole: two roundings of what is added, then normalised.
        let c = &cameras.pinhole;
        let (towards, sum) = Cameras::in_image(c.corner, c.right, c.down, wide_at);
        let (origin, direction) = ray(c, at, lens);
        prop_assert_eq!(origin, wide(c.origin));
        let off = 2.0 * sum * ROUNDING / length(towards);
        unit_to(direction, unit(towards), 2.0 * off + NORMALISED)?;

        // A lens: its point may be off on either axis; three more roundings.
        let t = &cameras.lens;
        let [s, r] = concentric_twin(f64::from(lens[0]), f64::from(lens[1]));
        let [across, upwards] = t.radii.map(wide);
        let radius = length(across);
        let from = add(add(wide(c.origin), s, across), r, upwards);
        let (origin, direction) = ray(t, at, lens);
        let size = length(wide(c.origin)) + 2.0 * radius;
        let moved = 2.0 * LENS * radius + 2.0 * ROUNDING * size;
        prop_assert!(distance(origin, from) <= moved, "{origin:?} for {from:?}");
        let [across, upwards] = t.slopes.map(wide);
        let slope = length(across);
        let through = add(add(towards, -s, across), -r, upwards);
        let off = 2.0 * LENS * slope + ROUNDING * (2.0 * sum + 6.0 * slope + length(through));
        unit_to(direction, unit(through), 2.0 * off / length(through) + NORMALISED)?;

        // Parallel rays.
        let o = &cameras.parallel;
        let (from, sum) = Cameras::in_image(o.corner, o.right, o.down, wide_at);
        let (origin, direction) = ray(o, at, lens);
        prop_assert_eq!(direction, wide(o.forward));
        prop_assert!(distance(origin, from) <= 2.0 * ROUNDING * sum);

        // A panorama: the turn is a product of at most 1.03 and loses its whole part, two roundings;
        // so an angle is off by 2 pi of that and of the polynomial.
        let p = &cameras.panorama;
        let [width, height] = SIZE.map(f64::from);
        let (longitude, theta) = (TAU * wide_at[0] / width - PI, PI * wide_at[1] / height);
        let [forward, right, up] = [p.forward, p.right, p.up].map(wide);
        let level = add(forward.map(|f| f * longitude.cos()), longitude.sin(), right);
        let expected = add(up.map(|u| u * theta.cos()), theta.sin(), level);
        let (origin, direction) = ray(p, at, lens);
        prop_assert_eq!(origin, wide(p.origin));
        // The width's reciprocal is exact, the height's rounds: three roundings of a turn. Sine and
        // cosine of two angles (off by both bounds together), and four roundings of products and
        // sums on each of three axes; the frame itself is orthonormal to a rounding a component.
        let angle = TAU * 3.0 * 1.03 * ROUNDING + 2f64.sqrt() * SIN_COS;
        let off = 2.0 * angle + 4.0 * 3f64.sqrt() * ROUNDING;
        unit_to(direction, unit(expected), 2.0 * off + NORMALISED)?;
    }

    /// However far apart they start, all rays of one point of the image meet in the plane of focus.
    #[test]
    fn a_point_in_the_plane_of_focus_is_sharp(
        seed: u64,
        x in 0.0f32..64.0,
        y in 0.0f32..48.0,
        lens in prop::array::uniform2(0.0f32..1.0),
    ) {
        let cameras = Cameras::new(seed);
        let (focus, forward) = (cameras.focus, cameras.forward);
        let c = &cameras.pinhole;
        let (towards, sum) = Cameras::in_image(c.corner, c.right, c.down, [x, y].map(f64::from));
        let sharp = add(wide(c.origin), focus, towards);
        let (origin, direction) = ray(&cameras.lens, [x, y], lens);
        // Along the ray to the plane.
        let depth = focus + dot(wide(c.origin), forward) - dot(origin, forward);
        let met = add(origin, depth / dot(direction, forward), direction);
        // Where it starts is off as above and by the lens's radii's own rounding; its direction,
        // over the distance, by what it is off across the view.
        let radius = length(wide(cameras.lens.radii[0]));
        let reach = depth / dot(direction, forward);
        let moved = 3.0 * LENS * radius + 3.0 * ROUNDING * (length(wide(c.origin)) + 2.0 * radius);
        let slope = radius / focus;
        let through = focus / dot(direction, forward) / focus;
        let off = 3.0 * LENS * slope + ROUNDING * (3.0 * sum + 8.0 * slope + through);
        let turned = 2.0 * off / through + NORMALISED;
        let bound = (moved + reach * turned) / dot(direction, forward);
        prop_assert!(distance(met, sharp) <= bound, "{} from it, {bound}", distance(met, sharp));
    }

    #[test]
    fn a_lens_of_radius_zero_is_a_pinhole(seed: u64, x in 0.0f32..64.0, y in 0.0f32..48.0, u in 0.0f32..1.0, v in 0.0f32..1.0) {
        let mut lens = Cameras::new(seed).lens;
        (lens.radii, lens.slopes) = ([[0.0; 3]; 2], [[0.0; 3]; 2]);
        prop_assert_eq!(ray(&lens, [x, y], [u, v]), ray(&lens.pinhole, [x, y], [u, v]));
    }
}

#[test]
fn a_panorama_has_its_directions_where_they_belong() {
    let camera = Panorama {
        origin: [1.0, 2.0, 3.0],
        forward: [0.0, 0.0, -1.0],
        right: [1.0, 0.0, 0.0],
        up: [0.0, 1.0, 0.0],
        turns: [1.0 / 64.0, 1.0 / 64.0],
    };
    for (at, expected) in [
        ([32.0, 16.0], [0.0, 0.0, -1.0]),
        ([48.0, 16.0], [1.0, 0.0, 0.0]),
        ([16.0, 16.0], [-1.0, 0.0, 0.0]),
        ([0.0, 16.0], [0.0, 0.0, 1.0]),
        ([64.0, 16.0], [0.0, 0.0, 1.0]),
        ([5.0, 0.0], [0.0, 1.0, 0.0]),
        ([5.0, 32.0], [0.0, -1.0, 0.0]),
        // Beyond the edges: the other side, and over the pole.
        ([-16.0, 16.0], [1.0, 0.0, 0.0]),
        ([80.0, 16.0], [-1.0, 0.0, 0.0]),
        ([32.0, -16.0], [0.0, 0.0, 1.0]),
        ([48.0, 48.0], [-1.0, 0.0, 0.0]),
    ] {
        let (_, direction) = ray(&camera, at, [0.0; 2]);
        // All turns are exact here; each component is a product of two of the polynomial's values.
        let off = distance(direction, expected);
        assert!(off <= 4.0 * SIN_COS, "{at:?} is {direction:?}");
    }
}

#[test]
fn splatted_frames_do_not_mix_lanes() {
    let camera = Cameras::new(3).lens;
    let x: [f32; LANES] = std::array::from_fn(|lane| lane as f32 * 7.5);
    let (origin, direction) = camera.ray(
        Fx::new(x),
        Fx::splat(9.0),
        [Fx::new(CORNERS), Fx::splat(0.75)],
    );
    let lane_of = |v: Vec3x, lane| wide(v.lane(lane));
    for lane in 0..LANES {
        let alone = ray(&camera, [x[lane], 9.0], [CORNERS[lane], 0.75]);
        assert_eq!((lane_of(origin, lane), lane_of(direction, lane)), alone);
    }
}
