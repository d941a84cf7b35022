//! What must hold of the tables, whichever builder they come from.

use super::*;
use std::collections::HashSet;

/// `n` blades in all directions through one another, twenty times as long as wide: what makes the builder cut.
fn blades(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut state = 5u64;
    let mut signed = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(77);
        ((state >> 40) as f32) / 8_388_608.0 - 1.0
    };
    for i in 0..n {
        let (at, along) = ([(); 3].map(|()| signed()), [(); 3].map(|()| signed()));
        let end = |s: f32, width: f32| std::array::from_fn(|k| at[k] + 0.15 * s * along[k] + width);
        mesh.vertices
            .extend([end(-1.0, 0.0), end(1.0, 0.0), end(1.0, 0.01)]);
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh.material = vec![0; mesh.indices.len()];
    mesh
}

#[test]
fn tables_are_the_same_for_any_number_of_threads() {
    // Enough for both builders to fork and to bin in parallel.
    let mesh = blades(40_000);
    for preset in [Preset::Fast, Preset::Balanced, Preset::Best] {
        let build = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            let geometry = pool.install(|| Geometry::build_with(&mesh, preset));
            let nodes: &[u8] = bytemuck::cast_slice(&geometry.layout.nodes);
            let blocks: &[u8] = bytemuck::cast_slice(&geometry.layout.blocks);
            (blake3::hash(nodes), blake3::hash(blocks))
        };
        let one = build(1);
        for threads in [2, 3] {
            assert_eq!(build(threads), one, "{preset:?} with {threads} threads");
        }
    }
}

#[test]
fn leaves_hold_no_triangle_twice_and_together_all() {
    let mesh = blades(3000);
    let geometry = Geometry::build_with(&mesh, Preset::Best);
    assert!(
        geometry.triangles() > mesh.triangles(),
        "nothing was cut: {}",
        geometry.triangles()
    );
    let mut all = HashSet::new();
    let mut references = 0;
    // A leaf is a block.
    for block in &geometry.layout.blocks[..] {
        // Unused lanes repeat the last used one.
        let mut lanes = block.primitive.to_array().to_vec();
        lanes.dedup();
        references += lanes.len();
        let distinct: HashSet<u32> = lanes.iter().copied().collect();
        assert_eq!(distinct.len(), lanes.len(), "{lanes:?}");
        all.extend(distinct);
    }
    assert_eq!(all.len(), mesh.triangles());
    assert_eq!(references, geometry.triangles());
}

#[test]
fn best_costs_less_where_triangles_are_long() {
    let mesh = blades(3000);
    let [balanced, best] = [Preset::Balanced, Preset::Best]
        .map(|preset| Geometry::build_with(&mesh, preset).sah_cost());
    assert!(best < balanced, "{best} and {balanced}: cuts gain nothing");
}
