//! A room with many materials.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

/// A closed room with lamps under its ceiling and turned boxes on its floor.
pub(super) fn make(_: &Path) -> io::Result<String> {
    const BOXES: u32 = 500;
    // Numerical Recipes' linear congruential generator: the same scene everywhere.
    let mut state = 7u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let mut text = String::from(
        "name = \"interior\"\n\
         [camera]\norigin = [-8.5, 3, -5.5]\ntarget = [3, 1, 2]\nfov = 70\n\
         [materials.wall]\nalbedo = [0.75, 0.72, 0.68]\n\
         [materials.lamp]\nalbedo = 0.5\nemission = [18, 16, 12]\n",
    );
    let mut add = |line: String| {
        let _ = writeln!(text, "{line}");
    };
    for m in 0..62 {
        let [r, g, b] = [0; 3].map(|_| 0.15 + 0.7 * random());
        let color = format!("[{r:.3}, {g:.3}, {b:.3}]");
        let roughness = 0.1 + 0.5 * random();
        // Half of them plain diffuse, the others in turn what stands in rooms.
        let kind = match m % 8 {
            1 => format!("albedo = {color}\nroughness = {roughness:.2}"),
            3 => format!("kind = \"conductor\"\nmetal = \"aluminium\"\nroughness = {roughness:.2}"),
            5 => format!(
                "kind = \"principled\"\nbase_color = {color}\nroughness = {roughness:.2}\n\
                 clearcoat = 1"
            ),
            7 => "kind = \"dielectric\"\nior = 1.5".to_owned(),
            _ => format!("albedo = {color}"),
        };
        add(format!("[materials.m{m}]\n{kind}"));
    }
    add("[[shapes]]\nmaterial = \"wall\"\n\
         box = { min = [-10, 0, -7], max = [10, 5, 7], inward = true }"
        .to_owned());
    for lamp in 0..12 {
        let (x, z) = (
            f64::from(lamp % 4) * 5.0 - 8.0,
            f64::from(lamp / 4) * 4.5 - 5.0,
        );
        add(format!(
            "[[shapes]]\nmaterial = \"lamp\"\n\
             rectangle = {{ corner = [{x}, 4.9, {z}], edges = [[1, 0, 0], [0, 0, 0.5]] }}"
        ));
    }
    for i in 0..BOXES {
        let (x, z) = (random() * 18.0 - 9.0, random() * 12.0 - 6.0);
        let [a, b, c] = [0; 3].map(|_| 0.05 + 0.3 * random() * random());
        let height = 0.1 + 1.8 * random() * random();
        let turn = random() * 90.0;
        add(format!(
            "[[shapes]]\nmaterial = \"m{}\"\n\
             box = {{ min = [{:.3}, 0.001, {:.3}], max = [{a:.3}, {height:.3}, {b:.3}] }}\n\
             transform = [{{ rotate = {{ axis = [{:.3}, 1, 0], degrees = {turn:.2} }} }}, \
             {{ translate = [{x:.3}, {:.3}, {z:.3}] }}]",
            i % 62,
            -a,
            -b,
            0.2 * random(),
            0.2 + c * 3.0
        ));
    }
    Ok(text)
}
