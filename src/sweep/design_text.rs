//! The text form of designs: `grid:a=0..10:11,b=1..2:5`, `lhs:1000,a=0..10`, `sobol:1024`.

use super::design::{Design, DesignAxis, DesignSampling, MOST_DESIGNS};

/// The default range of a parameter, in the file's unit: that of the scene's study.
pub struct OwnRange {
    /// The parameter.
    pub name: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
}

/// Whether a text starts with the keyword of a design, and so is not a file name.
pub fn is_written_out(text: &str) -> bool {
    let kinds = ["grid:", "lhs:", "sobol:"];
    kinds.iter().any(|kind| text.starts_with(kind))
}

/// Reads a design. `own` gives the ranges of parameters named without one, or, if none are named, of all parameters.
///
/// Errors, in words: what is wrong with the text.
pub fn read_design(text: &str, own: &[OwnRange], seed: u64) -> Result<Design, String> {
    let (kind, rest) = text.split_once(':').ok_or("write grid:, lhs: or sobol:")?;
    let mut parts = rest.split(',').map(str::trim);
    if kind == "grid" {
        let axes = parts.map(|part| read_axis(part, own, true));
        let axes = axes.collect::<Result<Vec<_>, _>>()?;
        refuse_doubles(&axes)?;
        return Design::grid(axes);
    }
    let count = read_count(parts.next().unwrap_or_default())?;
    let mut axes = parts
        .map(|part| read_axis(part, own, false))
        .collect::<Result<Vec<_>, _>>()?;
    if axes.is_empty() {
        axes = own
            .iter()
            .map(OwnRange::axis)
            .collect::<Result<Vec<_>, _>>()?;
    }
    if axes.is_empty() {
        return Err(format!(
            "needs parameters, as in {kind}:{count},NAME=0..10: the scene gives no ranges of its own"
        ));
    }
    refuse_doubles(&axes)?;
    let spread = match kind {
        "lhs" => DesignSampling::LatinHypercube { seed },
        _ => DesignSampling::Sobol,
    };
    Design::spread(axes, spread, count)
}

impl OwnRange {
    fn is_bounded(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Errors: the scene gives it no range.
    fn axis(&self) -> Result<DesignAxis, String> {
        if !self.is_bounded() {
            return Err(format!(
                "the scene gives `{0}` no range: write {0}=LOW..HIGH",
                self.name
            ));
        }
        Ok(DesignAxis {
            name: self.name.clone(),
            low: self.low,
            high: self.high,
            count: 1,
        })
    }
}

/// A number of designs or values, `1000` or `1e6`.
pub fn read_count(text: &str) -> Result<u64, String> {
    let whole = |v: &f64| v.fract() == 0.0 && (1.0..=MOST_DESIGNS as f64).contains(v);
    let value = text.parse::<f64>().ok().filter(whole);
    let value = value.map(|v| v as u64);
    value.ok_or_else(|| format!("`{text}`: a whole number from 1 to {MOST_DESIGNS}"))
}

/// `NAME`, `NAME=LOW..HIGH` or `NAME=VALUE`; on a grid followed by `:COUNT`.
fn read_axis(text: &str, own: &[OwnRange], is_grid: bool) -> Result<DesignAxis, String> {
    let (range, count) = match (is_grid, text.rsplit_once(':')) {
        (true, Some((range, count))) => (range, read_count(count.trim())?),
        _ => (text, 1),
    };
    let (name, low, high) = match range.split_once('=') {
        None => {
            let mut bounded = own.iter().filter(|o| o.is_bounded());
            let known = bounded.find(|o| o.name == range.trim());
            let known = known.ok_or_else(|| {
                format!("`{text}`: write NAME=LOW..HIGH; the scene's study gives no range for it")
            })?;
            (range, known.low, known.high)
        }
        Some((name, values)) => match values.split_once("..") {
            Some((low, high)) => (name, read_value(low)?, read_value(high)?),
            None => (name, read_value(values)?, read_value(values)?),
        },
    };
    let axis = DesignAxis {
        name: name.trim().to_owned(),
        low,
        high,
        count,
    };
    refuse_range(&axis, text, is_grid)?;
    Ok(axis)
}

fn refuse_range(axis: &DesignAxis, text: &str, is_grid: bool) -> Result<(), String> {
    if axis.name.is_empty() {
        return Err(format!("`{text}` names no parameter"));
    }
    if axis.low > axis.high {
        let (low, high) = (axis.low, axis.high);
        return Err(format!(
            "`{text}`: the range is reversed; write {high}..{low}"
        ));
    }
    if axis.low == axis.high && axis.count > 1 {
        return Err(format!(
            "`{text}`: a single value cannot be used {} times",
            axis.count
        ));
    }
    if is_grid && axis.low < axis.high && axis.count == 1 {
        return Err(format!(
            "`{text}`: give the number of values, such as {}={}..{}:11",
            axis.name, axis.low, axis.high
        ));
    }
    Ok(())
}

fn refuse_doubles(axes: &[DesignAxis]) -> Result<(), String> {
    for (k, axis) in axes.iter().enumerate() {
        if axes[..k].iter().any(|other| other.name == axis.name) {
            return Err(format!("`{}` appears twice in the design", axis.name));
        }
    }
    Ok(())
}

fn read_value(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok();
    let value = value.filter(|v| v.is_finite());
    value.ok_or_else(|| format!("`{}` is not a finite number", text.trim()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn own() -> Vec<OwnRange> {
        vec![OwnRange {
            name: "c".to_owned(),
            low: 3.0,
            high: 4.0,
        }]
    }

    #[test]
    fn designs_are_read_as_written() {
        let grid = read_design("grid:a=0..10:11, b=-1..1:3,c:2,d=7", &own(), 1).unwrap();
        assert_eq!(grid.count(), 66);
        assert_eq!(grid.values(65), [10.0, 1.0, 4.0, 7.0]);
        let lhs = read_design("lhs:1e3,a=0..1", &own(), 1).unwrap();
        assert_eq!((lhs.count(), lhs.names()), (1000, vec!["a".to_owned()]));
        let sobol = read_design("sobol:8", &own(), 1).unwrap();
        assert_eq!(sobol.values(1), [3.5]);
    }

    #[test]
    fn what_cannot_be_meant_is_refused() {
        for (text, why) in [
            ("grid:a=10..0:11", "reversed"),
            ("grid:a=0..10", "number of values"),
            ("grid:a=0..nan:3", "not a finite number"),
            ("grid:a=0..inf:3", "not a finite number"),
            ("grid:a=1..1:3", "cannot be used"),
            ("grid:a=0..1:2,a=0..1:2", "twice"),
            ("grid:x:3", "gives no range"),
            ("grid:=0..1:3", "names no parameter"),
            ("grid:a=0..1:0", "whole number"),
            ("lhs:1e19", "whole number"),
            ("lhs:10000000000000000000", "whole number"),
            ("lhs:0", "whole number"),
            ("lhs:2.5", "whole number"),
            ("sobol:nan", "whole number"),
        ] {
            let refused = read_design(text, &own(), 1).unwrap_err();
            assert!(refused.contains(why), "{text}: {refused}");
        }
        assert!(
            read_design("lhs:8", &[], 1)
                .unwrap_err()
                .contains("needs parameters")
        );
        assert!(is_written_out("lhs:8") && !is_written_out("table.csv"));
    }
}
