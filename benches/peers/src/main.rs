//! Huygens' rays beside Embree's; see `README.md`.
//!
//! `catalogue` makes meshes, `sets` their rays; `measure` has both sides answer them, in `rounds`;
//! `builds`, `agree` and `leaks` look at the rest, and `report` prints it.

mod agree;
mod builds;
mod catalogue;
mod clock;
mod embree;
mod leaks;
mod measure;
mod meshes;
mod options;
mod ours;
mod queue;
mod random;
mod report;
mod rounds;
mod sets;
mod sphere;
mod statistics;
mod table;

use clap::Parser;
use options::Options;
use std::process::ExitCode;

/// `20 * 4^8` triangles: the sphere that must not leak.
const LEAK_LEVEL: u32 = 8;

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    // One or two: the comparison of builds asks no more, and rays are traced by one.
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get().min(2));
    println!("{}\n", machine(threads)?);
    let (mut all, mut builds) = (Vec::new(), Vec::new());
    for name in options.meshes() {
        let subject = match catalogue::make(name, &options.data) {
            Ok(subject) => subject,
            Err(why) => {
                // Loud twice: where people watch, and where tables are kept.
                eprintln!("SKIPPED {name}: {why}");
                println!("SKIPPED {name}: {why}\n");
                continue;
            }
        };
        eprintln!("{name}: {} triangles", subject.mesh.triangles());
        if options.build_rounds() > 0 {
            let by_threads = builds::measure(&subject, threads, options.build_rounds())?;
            builds.push((subject.name, by_threads));
            eprintln!("  {}", report::builds_line(&builds[builds.len() - 1..]));
        }
        if options.builds_only {
            continue;
        }
        let (rays, warm_up) = (options.rays(), options.warm_up());
        let measured = measure::measure(&subject, rays, warm_up, options.rounds(), threads)?;
        eprintln!("  {}", report::last_line(std::slice::from_ref(&measured)));
        all.push(measured);
    }
    if all.is_empty() && builds.is_empty() {
        return Err("no mesh was measured".to_owned());
    }
    if options.builds_only {
        println!("{}", report::builds(&builds).text());
        println!("{}", report::builds_line(&builds));
        return Ok(());
    }
    println!("{}", report::rays(&all).text());
    let table = report::builds(&builds);
    if table.has_rows() {
        println!("{}", table.text());
    }
    println!("{}", report::memory(&all).text());
    println!("{}", report::agreement(&all).text());
    println!("{}", report::shadows(&all).text());
    if options.leak_rays() > 0 {
        let n = options.leak_rays();
        println!("Escapes from a closed mesh of 1,310,720 triangles, of {n} rays each:\n");
        println!("{}", leaks::table(LEAK_LEVEL, n, threads)?.text());
    }
    println!("{}", report::builds_line(&builds));
    println!("{}", report::last_line(&all));
    Ok(())
}

/// What the figures depend on.
fn machine(threads: usize) -> Result<String, String> {
    let read = |path| std::fs::read_to_string(path).unwrap_or_default();
    let info = read("/proc/cpuinfo");
    let line = |key: &str| info.lines().find(|line| line.starts_with(key));
    let value = |line: &str| line.split(':').nth(1).unwrap_or("").trim().to_owned();
    let model = line("model name").map_or_else(|| "unknown CPU".to_owned(), value);
    let build = if cfg!(target_feature = "avx512f") {
        "AVX-512"
    } else if cfg!(target_feature = "avx2") {
        "AVX2"
    } else {
        "SSE2"
    };
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let pages = read("/sys/kernel/mm/transparent_hugepage/enabled");
    let pages = pages.split(['[', ']']).nth(1).unwrap_or("unknown");
    let rays = huygens_kernels::many::form();
    let embree = embree::Device::new(threads)?.describe();
    Ok(format!(
        "{model}, {cores} cores; huge pages: {pages}. Huygens built for {build}, its rays in flight in the {rays} form; {embree}."
    ))
}
