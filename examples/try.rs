use huygens::{film::Film, geometry::Geometry, scene, settings::*, wave};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut sc = scene::load(a[1].as_ref()).unwrap();
    let g = Geometry::build(&sc.mesh);
    let n: u32 = a[2].parse().unwrap();
    sc.film.width = n;
    sc.film.height = n;
    let spp = a[3].parse().unwrap();
    for st in [
        Strategy::Uniform,
        Strategy::Cosine,
        Strategy::Light,
        Strategy::Mis,
    ] {
        for it in [Integrator::Path, Integrator::Reference] {
            if it == Integrator::Reference && st != Strategy::Cosine {
                continue;
            }
            let s = Settings {
                spp,
                strategy: st,
                integrator: it,
                max_depth: Some(8),
                ..sc.settings.clone()
            };
            let f = Film::new(n, n, s.tile);
            let r = wave::render(&sc, &g, &s, &f, &wave::Control::default());
            let im = f.develop();
            let m: Vec<f64> = (0..3)
                .map(|c| im.mean.iter().map(|p| f64::from(p[c])).sum::<f64>() / (n * n) as f64)
                .collect();
            let v: Vec<f64> = (0..3)
                .map(|c| {
                    im.variance
                        .iter()
                        .map(|p| f64::from(p[c]))
                        .sum::<f64>()
                        .sqrt()
                        / (n * n) as f64
                })
                .collect();
            println!(
                "{st:?} {it:?} {m:.5?} +- {v:.5?} {:.2}s rays {} {} {} dropped {:?} depth {}",
                r.seconds, r.camera_rays, r.bounce_rays, r.shadow_rays, r.dropped, r.mean_depth
            );
            if st == Strategy::Mis {
                for s in &r.stages {
                    println!(
                        "{} calls {} {:.3}s in {} out {} lanes {:.3}",
                        s.name,
                        s.calls,
                        s.seconds,
                        s.items_in,
                        s.items_out,
                        s.lanes_busy as f64 / s.lanes_issued as f64
                    );
                }
            }
        }
    }
}
