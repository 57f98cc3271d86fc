//! Equations that grow by magnitudes within the range of an unknown: what is said of them does not depend on units.

use crate::program::Workspace;
use serde_json::Value;

const SATURATION: f64 = 1e-12;
const THERMAL: f64 = 0.025;
const RESISTANCE: f64 = 1000.0;

/// The voltage of a diode in series with a resistor at a source, by bisection.
fn diode_voltage(source: f64) -> f64 {
    let excess = |v: f64| RESISTANCE * SATURATION * (v / THERMAL).exp_m1() + v - source;
    let (mut low, mut high) = (0.0, source);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match excess(middle) < 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

/// The circuit with the voltage in units of `volt`, the current in units of `ampere`, both equations times a factor.
fn circuit(source: &str, [volt, ampere]: [f64; 2], factor: f64) -> String {
    format!(
        "duration = 1\n[inputs]\nV = \"{source}\"\n[equations]\n\
         diode = \"{factor:e}*({ampere:e}*i - {SATURATION:e}*(exp({volt:e}*v/{THERMAL}) - 1))\"\n\
         mesh = \"{factor:e}*(V - {RESISTANCE}*{ampere:e}*i - {volt:e}*v)\"\n[guess]\nv = 0\ni = 0\n\
         [measures]\nlast = {{ of = \"v\", take = \"last\" }}\n"
    )
}

#[test]
fn a_steep_equation_is_regular_in_all_units() {
    let folder = Workspace::new();
    for last in [1e-3, 1.0, 5.0] {
        for source in [format!("{last}*t"), format!("{last} + 0*t")] {
            for (units, factor) in [
                ([1.0, 1.0], 1.0),
                ([1e-3, 1e-6], 1.0),
                ([1e3, 1e-3], 1e6),
                ([1.0, 1e-9], 1e-9),
            ] {
                folder.write("diode.toml", circuit(&source, units, factor));
                let label = format!("{source} {units:?} {factor}");
                let run = folder.run(&["check", "diode.toml", "--json", "r.json"]);
                let text = run.text();
                assert_eq!(run.code, 0, "{label}\n{text}");
                assert!(!text.contains("singular"), "{label}\n{text}");
                let report: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
                let sigma = report["sigma_min"].as_f64().unwrap();
                assert!(sigma > 1e-3, "{label}: {sigma}");
                let found = report["measures"][0]["value"].as_f64().unwrap() * units[0];
                let known = diode_voltage(last);
                assert!((found - known).abs() < 1e-12 * known, "{label}: {found}");
                // Nothing is a length here.
                assert!(
                    text.contains("relative to the terms of each equation"),
                    "{text}"
                );
                assert!(!text.contains(" m,") && !text.contains(" m;"), "{text}");
            }
        }
    }
}

/// Where only constants are left of an equation, their rounding is no closure error; constants beyond all numbers are constants.
#[test]
fn constants_are_terms() {
    let folder = Workspace::new();
    for equation in [
        "x + 0.1 + 0.2 - 0.3",
        "x - phi + 1e5/3 - 1e5*(1/3)",
        "x - phi + exp(-1e300)",
        "x - phi + 1e-99999999999",
    ] {
        folder.write(
            "constants.toml",
            format!("duration = 1\n[inputs]\nphi = \"t\"\n[equations]\ne = \"{equation}\"\n"),
        );
        let run = folder.run(&["check", "constants.toml"]);
        assert_eq!(run.code, 0, "{equation}\n{}", run.text());
    }
}
