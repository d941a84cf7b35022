use huygens::{film::Film, geometry::Geometry, scene, settings::*, wave};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut sc = scene::load(a[1].as_ref()).unwrap();
    let g = Geometry::build(&sc.mesh);
    let n: u32 = a[2].parse().unwrap();
    sc.film.width = n;
    sc.film.height = n;
    let spp = a[3].parse().unwrap();
    for (i, it) in [
        Integrator::Path,
        Integrator::Reference,
        Integrator::Normals,
        Integrator::Albedo,
    ]
    .into_iter()
    .enumerate()
    {
        let s = Settings {
            spp,
            strategy: Strategy::Mis,
            integrator: it,
            max_depth: Some(8),
            ..sc.settings.clone()
        };
        let f = Film::new(n, n, s.tile);
        wave::render(&sc, &g, &s, &f, &wave::Control::default());
        let im = f.develop();
        let mut b = image::RgbImage::new(n, n);
        for (p, v) in b.pixels_mut().zip(&im.mean) {
            p.0 = v.map(|c| (c.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8);
        }
        b.save(format!("/tmp/img{i}.png")).unwrap();
        println!("{:?}", im.mean[(n * n / 2 + n / 2) as usize]);
    }
}
