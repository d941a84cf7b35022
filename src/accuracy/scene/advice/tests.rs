//! Sentences from numbers made up for them.

use super::*;
use crate::accuracy::End;
use crate::accuracy::scene::study::tests::curve;

fn of(name: &str, family: Family, points: [(f64, f64, f64); 2]) -> SceneCurve {
    let mut curve = curve(points);
    curve.curve.name = name.into();
    curve.family = family;
    curve
}

/// What is said of a choice of `family` beside a base of 2 s for the same samples.
fn beside_base(family: Family, points: [(f64, f64, f64); 2]) -> String {
    let base = of(
        "mis+sobol",
        Family::Base,
        [(1.0, 0.2, 0.0), (2.0, 0.1, 0.0)],
    );
    let mut choice = of("finest images", family, points);
    choice.efficiency = choice.efficiency_over(&base);
    let study = SceneStudy {
        curves: vec![base, choice],
        end: End::Complete,
        target: None,
    };
    advice(&study, 0.05, |s| format!("{s} s")).join(" ")
}

#[test]
fn the_two_ways_to_read_images_are_told_apart_where_they_differ() {
    let far = beside_base(Family::Textures, [(2.0, 0.2, 9e-4), (4.0, 0.1, 9e-4)]);
    let expected = "Finest images differ from the scene's own by 3.0% and take 2.0 times as long for the \
                    same samples.";
    assert!(far.contains(expected), "{far}");
    let near = beside_base(Family::Textures, [(1.0, 0.2, 0.0), (2.0, 0.1, 0.0)]);
    assert!(
        near.contains(" show the same to within the noise and take 1.0 times"),
        "{near}"
    );
}

#[test]
fn dear_and_cheap_choices_are_told_and_those_alike_are_not() {
    let said =
        |factor: f64| beside_base(Family::Wave, [(factor, 0.2, 0.0), (2.0 * factor, 0.1, 0.0)]);
    assert!(
        said(2.0).contains("The same error takes longer with finest images (2.0 times as long).")
    );
    assert!(
        said(0.5).contains(
            "The same error takes less time with finest images (2.0 times as efficient)."
        )
    );
    assert!(!said(1.1).contains("The same error"));
}

/// Every verdict has its reason, with the numbers that it rests on.
#[test]
fn an_estimate_that_is_off_is_explained() {
    let said = |verdict, measured, renders| {
        let target = Target {
            goal: 0.2,
            renders,
            estimated: 0.19,
            measured,
            measured_error: (renders > 1).then_some(0.01),
            samples: 100.0,
            seconds: 1.0,
            half_in: 0.012,
            reference_error: 0.15,
            verdict,
        };
        met(&target, &|s| format!("{s} s"))
    };
    for (verdict, measured, renders, end) in [
        (
            Verdict::Holds,
            0.19,
            4,
            "19% +- 1.0% by the reference: the estimate holds",
        ),
        (
            Verdict::Chance,
            0.23,
            1,
            ", 21% more than estimated: one render does not tell how others scatter",
        ),
        (Verdict::Chance, 0.23, 4, ": which 4 renders may scatter by"),
        (
            Verdict::Reference,
            0.23,
            4,
            "reference's own error of 15% is too much to judge by: --reference-error 5.0%",
        ),
        (
            Verdict::Safe,
            0.1,
            4,
            ", 47% less than estimated: which is on the safe side",
        ),
        (
            Verdict::FewPaths,
            0.4,
            4,
            ": half of the squared error lies in 1.2% of the values, so few bright \
                                     paths decide, and where none was met the estimate knows of none",
        ),
        (
            Verdict::Unexplained,
            0.4,
            4,
            "lies in 1.2% of the values, which does not explain it",
        ),
    ] {
        let text = said(verdict, measured, renders);
        assert!(text.ends_with(end), "{text}\n{end}");
    }
}
