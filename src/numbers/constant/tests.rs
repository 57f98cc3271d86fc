//! Decimals, operations and functions against numbers of forty digits.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

fn decimal(text: &str) -> Constant {
    match text.strip_prefix('-') {
        Some(rest) => -Constant::decimal(rest).unwrap(),
        None => Constant::decimal(text).unwrap(),
    }
}

/// Whether `found` says of `meant`, a sum of decimals far below each other, no more than is true, and enough.
fn holds(found: Constant, meant: &[&str], digits: f64) -> bool {
    let parts = meant.iter().map(|text| decimal(text));
    let off = parts.fold(found, |sum, part| sum - part);
    // The decimals of the test are known to 31 digits themselves.
    let size = decimal(meant[0]).number().abs();
    off.number().abs() <= off.error() && off.error() <= digits * size.max(1e-300)
}

#[test]
fn decimals_keep_their_digits() {
    for (text, is_exact) in [
        ("0", true),
        ("0.0e5", true),
        ("7", true),
        ("0.5", true),
        ("1.25e2", true),
        ("9007199254740993", false),
        ("0.1", false),
        ("1000.3", false),
        ("4.1e22", false),
        ("1e23", false),
        ("5e-324", false),
        ("123456789012345678901234567890.123456789", false),
        ("0.000000000000000000000000000000000000012345", false),
    ] {
        let constant = decimal(text);
        assert_eq!(constant.number(), text.parse::<f64>().unwrap(), "{text}");
        assert_eq!(constant.is_exact(), is_exact, "{text}: {constant:?}");
        let unit = f64::EPSILON * constant.number() + 2.0 * SMALLEST;
        assert!(constant.open() <= unit, "{text}");
    }
    // 2^53 + 1 is no f64, but the sum of two.
    let odd = decimal("9007199254740993") - decimal("9007199254740992");
    assert!(odd.number() == 1.0 && odd.open() < 1e-13, "{odd:?}");
    for text in ["", ".", "1.2.3", "1e999", "0x10", "1e", "--1", "nan", "inf"] {
        assert_eq!(Constant::decimal(text), None, "{text}");
    }
}

#[test]
fn what_cancels_is_known_to_what_is_left() {
    let difference = decimal("1000.3") - decimal("960.2");
    assert_eq!(difference.number(), 40.1);
    assert!(holds(difference, &["40.1"], 1e-27), "{difference:?}");
    let root = Scalar::sqrt(decimal("2")) * decimal("1e9") - decimal("1414213562");
    let meant = ["0.373095048801689", "-2.75790301921430328e-16"];
    assert!(holds(root, &meant, 1e-18), "{root:?}");
    let nothing = decimal("0.3") - decimal("0.1") - decimal("0.2");
    assert!(nothing.number().abs() <= nothing.error() && nothing.error() < 1e-29);
}

/// Values with 45 digits, computed with mpmath 1.3.
#[test]
fn functions_hold_values_of_forty_digits() {
    let one_tenth = decimal("0.1");
    type Case = (Constant, [&'static str; 2]);
    let cases: [Case; 9] = [
        (
            one_tenth.sin(),
            ["0.0998334166468282", "-4.7693185801589377973e-17"],
        ),
        (
            one_tenth.cos(),
            ["0.995004165278026", "-2.3390443801219612971e-16"],
        ),
        (
            one_tenth.exp(),
            ["1.10517091807565", "-2.3751882921735097533e-15"],
        ),
        (
            one_tenth.ln(),
            ["-2.30258509299405", "4.3159820085453156358e-15"],
        ),
        (
            one_tenth.acos(),
            ["1.47062890563334", "-3.1771142014878129419e-15"],
        ),
        (
            one_tenth.asin(),
            ["0.10016742116156", "-2.0365447682054730668e-16"],
        ),
        (
            decimal("3").atan(),
            ["1.24904577239825", "4.4258299170772810901e-15"],
        ),
        (
            decimal("10").power(one_tenth),
            ["1.25892541179417", "-2.7895760458936041994e-15"],
        ),
        (
            one_tenth.sqrt(),
            ["0.316227766016838", "-6.6800110645556728147e-17"],
        ),
    ];
    for (found, meant) in cases {
        // The digits above reach to 1e-29 or so.
        let off = meant.iter().fold(found, |sum, text| sum - decimal(text));
        assert!(
            off.number().abs() < 5e-29 && off.error() < 1e-26,
            "{found:?}: {off:?}"
        );
    }
    assert_eq!(Constant::exact(9.0).sqrt(), Constant::exact(3.0));
    assert!(Constant::exact(0.0).cos().is_exact());
    let half_turn = Constant::PI.sin();
    assert!(half_turn.number().abs() <= half_turn.error() && half_turn.error() < 1e-27);
}

/// Every operation on numbers that are open by more than their digits holds what the members give.
#[test]
fn errors_are_handed_on() {
    let open = |value: f64| Constant::within(value, 1e-9);
    let check = |name: &str, found: Constant, values: [f64; 2]| {
        for value in values {
            let off = (value - found.number()).abs();
            assert!(off <= found.open() + 1e-15, "{name}: {off:e} {found:?}");
        }
        assert!(found.open() < 2e-8, "{name}: {found:?}");
    };
    for value in [0.3, 0.7, 0.95] {
        let ends = [value - 1e-9, value + 1e-9];
        let x = open(value);
        check("sum", x + x, ends.map(|v| v + v));
        check("product", x * x, ends.map(|v| v * v));
        check("quotient", Constant::exact(1.0) / x, ends.map(|v| 1.0 / v));
        check("sin", x.sin(), ends.map(f64::sin));
        check("cos", x.cos(), ends.map(f64::cos));
        check("tan", x.tan(), ends.map(f64::tan));
        check("asin", x.asin(), ends.map(f64::asin));
        check("acos", x.acos(), ends.map(f64::acos));
        check("atan", x.atan(), ends.map(f64::atan));
        check("sqrt", x.sqrt(), ends.map(f64::sqrt));
        check("exp", x.exp(), ends.map(f64::exp));
        check("ln", x.ln(), ends.map(f64::ln));
        check("abs", (-x).abs(), ends);
        check("max", x.max(-x), ends);
    }
    // Whole numbers nearer than the error: one of two; no values: none.
    assert_eq!(Scalar::floor(open(2.0)).open(), GROW);
    assert_eq!(Scalar::floor(decimal("2.5")), Constant::exact(2.0));
    assert!(!Scalar::is_finite(Constant::exact(1.0) / open(0.0)));
    assert!(!Scalar::is_finite(open(-0.5).sqrt()));
    let root = open(0.0).sqrt();
    assert!(root.number() == 0.0 && root.open() >= 1e-9_f64.sqrt());
}

#[test]
fn quarter_turns_are_those_of_all_digits() {
    let degree = Constant::PI / Constant::exact(180.0);
    for quarters in [-5, -1, 0, 2, 7, 4000] {
        let angle = degree * Constant::exact(90.0 * f64::from(quarters));
        assert_eq!(angle.quarter_turns(), Some(i64::from(quarters)));
    }
    for angle in [
        decimal("1.5707963267948966"),
        degree * decimal("90.00000000000000000001"),
    ] {
        assert_eq!(angle.quarter_turns(), None, "{angle:?}");
    }
}

#[test]
fn enclosures_hold_the_number_meant() {
    let tenth = Interval::from_constant(decimal("0.1"));
    assert!(tenth.lo < 0.1 && tenth.hi > 0.1 && tenth.hi - tenth.lo < 1e-16);
    assert_eq!(
        Interval::from_constant(decimal("0.5")),
        Interval::point(0.5)
    );
    let wide = Interval::from_constant(Constant::within(1.0, 0.25));
    assert!(wide.lo <= 0.75 && wide.hi >= 1.25);
}
