//! What the numbers of a study come to, in sentences.

use super::{Cost, Family, SceneCurve, SceneStudy, Target, Verdict};

/// Choices within this factor of each other are told as equals: what timing scatters on a machine
/// that does other things too, and what few renders leave open of an error.
const ALIKE: f64 = 1.15;

/// Sentences of a paragraph: which choice reaches the relative error `goal` soonest, what the others need, and what
/// they cannot reach. `duration` writes seconds.
#[must_use]
pub fn advice(study: &SceneStudy, goal: f64, duration: impl Fn(f64) -> String) -> Vec<String> {
    let percent = format!("{}%", tidy(100.0 * goal));
    let told = |c: Cost| match c {
        Cost::Measured(s) => duration(s),
        Cost::Extrapolated(s) => format!("about {}", duration(s)),
        Cost::Never(floor) => format!("stays {} off", share(floor)),
        Cost::Unknown => "unknown".into(),
    };
    let mut ways: Vec<(&SceneCurve, f64)> = study
        .measured()
        .filter(|c| kind(c.family) == Kind::Way)
        .filter_map(|c| Some((c, c.cost_of(goal).seconds()?)))
        .collect();
    ways.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut sentences = Vec::new();
    if let (Some((best, fastest)), Some((worst, slowest))) = (ways.first(), ways.last()) {
        let mut text = format!(
            "{} reaches an error of {percent} in {}",
            best.curve.name,
            told(best.cost_of(goal))
        );
        if slowest > &(ALIKE * fastest) {
            text += &format!(
                "; {} needs {}, {} as long",
                worst.curve.name,
                told(worst.cost_of(goal)),
                times(slowest / fastest)
            );
        }
        sentences.push(text);
        let base = ways.iter().find(|(c, _)| c.family == Family::Base);
        if let Some((base, seconds)) = base
            && base.curve.name != best.curve.name
        {
            let text = if *seconds <= ALIKE * fastest {
                format!("the scene's own {} is about as quick", base.curve.name)
            } else {
                let (name, factor) = (&base.curve.name, times(seconds / fastest));
                format!(
                    "the scene's own {name} needs {factor} as long: try {}",
                    best.options
                )
            };
            sentences.push(text);
        }
    } else {
        sentences.push(format!(
            "no choice was measured well enough to say what {percent} costs"
        ));
    }
    sentences.extend(depths(study, goal, &told));
    sentences.extend(rays(study));
    sentences.extend(against_base(study, goal));
    sentences.extend(study.target.as_ref().map(|t| met(t, &duration)));
    sentences.iter().map(|s| finished(s)).collect()
}

/// With a capital letter, but for the name of a choice, and a full stop.
fn finished(sentence: &str) -> String {
    let named = sentence
        .split(' ')
        .next()
        .is_some_and(|word| word.contains('+'));
    let mut letters = sentence.chars();
    match letters.next().filter(|_| !named) {
        Some(first) => format!("{}{}.", first.to_uppercase(), letters.as_str()),
        None => format!("{sentence}."),
    }
}

#[derive(PartialEq)]
enum Kind {
    /// A way to the same image.
    Way,
    /// To an image of its own, or told by itself.
    Other,
}

fn kind(family: Family) -> Kind {
    match family {
        Family::Base | Family::Strategy | Family::Sampler | Family::Combined | Family::Lights => {
            Kind::Way
        }
        Family::Depth
        | Family::Roulette
        | Family::Split
        | Family::Textures
        | Family::Wave
        | Family::Precision
        | Family::Target => Kind::Other,
    }
}

/// The smallest depth that reaches the goal, and how far off the next smaller one stays.
fn depths(study: &SceneStudy, goal: f64, told: &impl Fn(Cost) -> String) -> Option<String> {
    let all: Vec<&SceneCurve> = study
        .measured()
        .filter(|c| c.family == Family::Depth)
        .collect();
    let fails = |c: &&&SceneCurve| matches!(c.cost_of(goal), Cost::Never(_));
    let last_failing = all.iter().rfind(fails);
    let first_reaching = all.iter().find(|c| c.cost_of(goal).seconds().is_some());
    let off = |c: &SceneCurve| share(c.bias());
    match (last_failing, first_reaching) {
        (Some(bad), Some(good)) => Some(format!(
            "{} stays {} off however long it renders; {} reaches the goal in {}",
            bad.curve.name,
            off(bad),
            good.curve.name,
            told(good.cost_of(goal))
        )),
        (Some(bad), None) => Some(format!(
            "{} stays {} off however long it renders",
            bad.curve.name,
            off(bad)
        )),
        (None, Some(good)) => Some(format!("{} already reaches the goal", good.curve.name)),
        (None, None) => None,
    }
}

/// Whether renders that end by their error can be believed.
fn met(target: &Target, duration: &impl Fn(f64) -> String) -> String {
    let [goal, own, true_error] =
        [target.goal, target.estimated, target.measured].map(|e| share(tidy(e)));
    let chance = target.measured_error;
    let chance = chance.map_or(String::new(), |e| format!(" +- {}", share(e)));
    let found = format!(
        "rendered until {goal}, it ends after {:.0} samples a pixel in {} at {own} by its own estimate, \
         and at {true_error}{chance} by the reference",
        target.samples,
        duration(target.seconds),
    );
    let percent = 100.0 * (target.ratio() - 1.0).abs();
    let way = if target.ratio() > 1.0 { "more" } else { "less" };
    let half = || {
        let half = share(target.half_in);
        format!("half of the squared error lies in {half} of the values")
    };
    let why = match target.verdict {
        Verdict::Holds => return format!("{found}: the estimate holds"),
        Verdict::Chance if target.renders == 1 => {
            "one render does not tell how others scatter".into()
        }
        Verdict::Chance => format!("which {} renders may scatter by", target.renders),
        Verdict::Reference => format!(
            "but the reference's own error of {} is too much to judge by: --reference-error {}",
            share(target.reference_error),
            share(target.judge())
        ),
        Verdict::Safe => "which is on the safe side".into(),
        Verdict::FewPaths => format!(
            "{}, so few bright paths decide, and where none was met the estimate knows of none",
            half()
        ),
        Verdict::Unexplained => format!("{}, which does not explain it", half()),
    };
    format!("{found}, {percent:.0}% {way} than estimated: {why}")
}

/// How the choices that concern one thing alone compare with the scene's own settings.
fn against_base(study: &SceneStudy, goal: f64) -> Vec<String> {
    let (mut cheaper, mut dearer, mut sentences) = (Vec::new(), Vec::new(), Vec::new());
    for curve in study.measured() {
        let name = &curve.curve.name;
        match (curve.family, curve.efficiency) {
            (Family::Roulette | Family::Split | Family::Wave, Some(e)) if e > ALIKE => {
                cheaper.push(format!("{name} ({} as efficient)", times(e)));
            }
            (Family::Roulette | Family::Split | Family::Wave, Some(e)) if e < 1.0 / ALIKE => {
                dearer.push(format!("{name} ({} as long)", times(1.0 / e)));
            }
            (Family::Textures, _) => sentences.extend(images(study, curve)),
            (Family::Precision, _) => sentences.extend(precision(study, curve, goal)),
            _ => {}
        }
    }
    let told = |what: &str, names: &[String]| {
        let names = names.join(", ");
        (!names.is_empty()).then(|| format!("the same error takes {what} with {names}"))
    };
    let all = [told("less time", &cheaper), told("longer", &dearer)];
    all.into_iter().flatten().chain(sentences).collect()
}

/// How many more rays branches cast for the same samples.
fn rays(study: &SceneStudy) -> Option<String> {
    let base = study.curves.first()?;
    let of = |c: &SceneCurve, rung: usize| Some(c.curve.points.get(rung)?.rays? as f64);
    let factor = |c: &SceneCurve| {
        let rung = c.curve.points.len().checked_sub(1)?;
        Some(of(c, rung)? / of(base, rung)?)
    };
    let all = study.measured().filter(|c| c.family == Family::Split);
    let all: Vec<String> = all
        .filter_map(|c| Some(format!("{} {}", c.curve.name, times(factor(c)?))))
        .collect();
    (!all.is_empty()).then(|| format!("rays for the same samples: {}", all.join(", ")))
}

/// How far apart the two ways to read images are, and what the other costs.
fn images(study: &SceneStudy, curve: &SceneCurve) -> Option<String> {
    let cost = a_sample(curve)? / a_sample(study.curves.first()?)?;
    let apart = match curve.bias() {
        bias if bias > 0.0 => format!("differ from the scene's own by {}", share(bias)),
        _ => "show the same to within the noise".to_owned(),
    };
    let name = &curve.curve.name;
    Some(format!(
        "{name} {apart} and take {} as long for the same samples",
        times(cost)
    ))
}

/// Seconds of a sample a pixel, on the last rung.
fn a_sample(curve: &SceneCurve) -> Option<f64> {
    let last = curve.curve.points.last()?.point;
    Some(last.seconds / last.samples as f64)
}

/// What f64 costs: against the same strategy with the same kind of numbers where that was measured.
fn precision(study: &SceneStudy, curve: &SceneCurve, goal: f64) -> Option<String> {
    let twin = study
        .measured()
        .find(|c| c.curve.name == "cosine+independent");
    let last = curve.curve.points.last()?;
    let agrees = if last.believed_bias_squared() > 0.0 {
        format!("differs from the wave by {}", share(curve.bias()))
    } else {
        "agrees with the wave to within the noise".to_owned()
    };
    let cost = twin
        .and_then(|t| Some(a_sample(curve)? / a_sample(t)?))
        .map_or_else(
            || {
                let base = study.curves[0].cost_of(goal).seconds();
                let own = curve.cost_of(goal).seconds();
                let factor = own.zip(base).map(|(own, base)| times(own / base));
                factor.map_or(String::new(), |f| {
                    format!(" and takes {f} as long to the same error")
                })
            },
            |factor| format!(" and takes {} as long for the same samples", times(factor)),
        );
    Some(format!("the {} {agrees}{cost}", curve.curve.name))
}

/// `2.3 times`.
fn times(factor: f64) -> String {
    if factor < 10.0 {
        format!("{factor:.1} times")
    } else {
        format!("{factor:.0} times")
    }
}

/// A share as a percentage of two digits.
fn share(part: f64) -> String {
    let percent = 100.0 * part;
    let decimals = if percent < 10.0 { 1 } else { 0 };
    format!("{percent:.decimals$}%")
}

/// A number without needless digits.
fn tidy(number: f64) -> f64 {
    (number * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests;
