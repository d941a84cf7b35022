use super::*;
use proptest::prelude::*;

#[test]
fn what_is_no_density_is_refused() {
    let new = |values: &[f64]| {
        Table::new(0.0, 1.0, values)
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(new(&[]), "a table of 0 values is no rectangle");
    assert_eq!(
        new(&[1.0, -2.0]),
        "value 1 is -2, expected a finite number of 0 or more"
    );
    assert_eq!(
        new(&[f64::NAN]),
        "value 0 is NaN, expected a finite number of 0 or more"
    );
    let sum = "expected a finite number above 0";
    assert_eq!(new(&[0.0, 0.0]), format!("the values add up to 0, {sum}"));
    assert_eq!(new(&[1e308; 3]), format!("the values add up to inf, {sum}"));
    assert_eq!(
        Table::new(1.0, 1.0, &[1.0]),
        Err(TableError::Interval(1.0, 1.0))
    );
    let two = |columns, values: &[f64]| Table2::new([0.0; 2], [1.0; 2], columns, values);
    assert_eq!(two(2, &[1.0; 3]), Err(TableError::Shape(3)));
    assert_eq!(two(0, &[1.0]), Err(TableError::Shape(1)));
    let [index, value] = [3.0, -1.0];
    let error = TableError::Value {
        index: index as usize,
        value,
    };
    assert_eq!(two(2, &[1.0, 1.0, 1.0, value]), Err(error));
}

fn table() -> impl Strategy<Value = Table> {
    let value = prop_oneof![Just(0.0), 0.0..1.0, 1e-300..1e-290, 1e10..1e20];
    let values = prop::collection::vec(value, 1..40);
    let ends = (-1e6..1e6f64, 1e-3..1e3f64);
    (values, ends).prop_filter_map("all zero", |(values, (low, extent))| {
        Table::new(low, low + extent, &values).ok()
    })
}

proptest! {
    #[test]
    fn samples_have_a_density_and_the_cdf_undoes_them(
        table in table(),
        u in prop_oneof![0.0..1.0, Just(0.0), Just(1.0 - 0.5 * f64::EPSILON)],
    ) {
        let x = table.sample([u]);
        prop_assert!(table.pdf(&x) > 0.0);
        // Rounding x by 2^-53 of the interval's magnitude moves the cdf by so much times the
        // pdf; a clamped or rounded sum moves it by some 2^-52 a cell.
        let magnitude = table.low.abs().max(table.high.abs());
        let slack = (4.0 * magnitude * table.pdf(&x) + 40.0) * f64::EPSILON;
        prop_assert!((table.cdf(x) - u).abs() <= slack, "{} for {}", table.cdf(x), u);
    }

    #[test]
    fn the_density_integrates_to_one(table in table()) {
        let n = table.values.len();
        let cells = (0..n).map(|i| {
            let [start, end] = [table.edge(i), table.edge(i + 1)];
            // Not the middle: that of a narrow cell may round to its end.
            table.pdf(&start) * (end - start)
        });
        let relative = table.low.abs().max(table.high.abs()) / (table.high - table.low);
        let slack = (n as f64 + 4.0 * relative * n as f64) * 2.0 * f64::EPSILON;
        prop_assert!((cells.sum::<f64>() - 1.0).abs() <= slack);
    }
}
