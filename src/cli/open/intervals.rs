//! Parameters that the command line gives as intervals: `880+-0.2`, `880±0.2`, `879.8..880.2`.

use crate::cli::args::scene::SceneArgs;
use crate::cli::term::outcome::Failure;

/// The scene with the middle of every interval, and the half-widths in the file's units.
pub fn interval_middles(args: &SceneArgs) -> Result<(SceneArgs, Vec<(String, f64)>), Failure> {
    let mut scene = args.clone();
    let mut widths = Vec::new();
    for (name, text) in &mut scene.parameters {
        if let Some((middle, half)) = named_interval(name, text)? {
            *text = middle;
            widths.push((name.clone(), half));
        }
    }
    Ok((scene, widths))
}

/// Refuses intervals where numbers are meant: `40+-0.5` would also be read as the formula 39.5.
pub fn refuse_intervals(args: &SceneArgs) -> Result<(), Failure> {
    for (name, text) in &args.parameters {
        let is_interval = ["+-", "±", ".."].iter().any(|sign| text.contains(sign));
        if is_interval {
            let message = format!("`{name}={text}` is an interval, and a number is required here");
            let hints = vec![
                "`enclose` and `check` take intervals; `tolerance` takes --tolerance".to_owned(),
            ];
            return Err(Failure::usage(message, hints));
        }
    }
    Ok(())
}

/// The middle of an interval as a formula, and its half-width; `None` if the text is not an interval.
fn named_interval(name: &str, text: &str) -> Result<Option<(String, f64)>, Failure> {
    let wrong = |message: String| {
        let hint = "write --param NAME=880+-0.2 or --param NAME=879.8..880.2";
        Err(Failure::usage(message, vec![hint.to_owned()]))
    };
    if let Some((middle, half)) = text.split_once("+-").or_else(|| text.split_once('±')) {
        return match half.trim().parse::<f64>() {
            Ok(half) if half >= 0.0 && half.is_finite() => {
                Ok(Some((middle.trim().to_owned(), half)))
            }
            _ => wrong(format!("`{name}`: `{}` is not a tolerance", half.trim())),
        };
    }
    let Some((low, high)) = text.split_once("..") else {
        return Ok(None);
    };
    let [low, high] = [low, high].map(|end| end.trim().parse::<f64>());
    match (low, high) {
        (Ok(low), Ok(high)) if low > high => wrong(format!(
            "`{name}`: the lower end {low} of the interval is above the upper end {high}"
        )),
        (Ok(low), Ok(high)) if (high - low).is_finite() => {
            let middle = 0.5 * low + 0.5 * high;
            // Both ends are included, however the middle was rounded.
            let half = (middle - low).max(high - middle).next_up();
            Ok(Some((format!("{middle:?}"), half)))
        }
        _ => wrong(format!("`{name}`: `{text}` is not an interval")),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn intervals_are_told_from_formulas() {
        assert_eq!(
            named_interval("L", "880+-0.2").unwrap().unwrap(),
            ("880".to_owned(), 0.2)
        );
        assert_eq!(
            named_interval("L", "2*k ± 1").unwrap().unwrap(),
            ("2*k".to_owned(), 1.0)
        );
        let (middle, half) = named_interval("L", "879.8..880.2").unwrap().unwrap();
        let middle: f64 = middle.parse().unwrap();
        assert!(middle - half <= 879.8 && middle + half >= 880.2 && half < 0.2001);
        for none in ["880", "2*(k + -1)", "-3"] {
            assert_eq!(named_interval("L", none).unwrap(), None);
        }
        for wrong in ["2..1", "880+-x", "880+--1", "a..b", "1..inf"] {
            assert!(named_interval("L", wrong).is_err(), "{wrong}");
        }
    }
}
