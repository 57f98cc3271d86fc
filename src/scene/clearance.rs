//! The `[clearance]` section as typed.

use super::reader::{Spanned, TableReader, required_value};
use super::values::FormulaText;
use crate::diag::Span;

/// The section as typed.
#[derive(Clone, Debug, Default)]
pub struct ClearanceFile {
    /// `minimum`
    pub minimum: Option<FormulaText>,
    /// `pairs` with their own minima.
    pub pairs: Vec<(PairFile, FormulaText)>,
    /// `ignore`
    pub ignored: Vec<IgnoredFile>,
    /// `touching`
    pub touching: Vec<PairFile>,
}

/// A pair that is excluded from the check, or some of its shapes.
#[derive(Clone, Debug)]
pub struct IgnoredFile {
    /// Which bodies.
    pub pair: PairFile,
    /// `reason`
    pub reason: Spanned<String>,
    /// `shapes`: numbers of shapes of the first and the second body, from 1; all if absent.
    pub shapes: Option<Spanned<Vec<[FormulaText; 2]>>>,
    /// `down_to`: the depth that is allowed.
    pub down_to: Option<FormulaText>,
}

/// Two names.
#[derive(Clone, Debug)]
pub struct PairFile {
    /// The names as typed; valid if there are two.
    pub names: Vec<Spanned<String>>,
    /// The entry.
    pub span: Span,
}

/// An output that is the distance of two bodies, or of groups of them.
#[derive(Clone, Debug)]
pub struct DistanceFile {
    /// Its name.
    pub name: Spanned<String>,
    /// `distance`: which bodies.
    pub pair: PairFile,
    /// `shapes`: numbers of shapes of the first and the second body, from 1; all if absent.
    pub shapes: Option<Spanned<Vec<[FormulaText; 2]>>>,
}

/// Reads an entry of `[outputs]` that is a table.
pub fn read_distance(r: &mut TableReader, name: Spanned<String>) -> Option<DistanceFile> {
    let (pair, shapes) = (read_pair(r, "distance"), r.rows("shapes"));
    let pair = pair?;
    Some(DistanceFile { name, pair, shapes })
}

/// Reads the section.
pub fn read_clearance(r: &mut TableReader) -> ClearanceFile {
    let minimum = r.formula("minimum");
    let pairs = r.tables("pairs", |p| {
        let pair = read_pair(p, "pair");
        let minimum = required_value(p, "minimum", |p, k| p.formula(k));
        Some((pair?, minimum?))
    });
    let ignored = r.tables("ignore", |p| {
        let pair = read_pair(p, "pair");
        let reason = required_value(p, "reason", |p, k| p.string(k));
        let (shapes, down_to) = (p.rows("shapes"), p.formula("down_to"));
        Some(IgnoredFile {
            pair: pair?,
            reason: reason?,
            shapes,
            down_to,
        })
    });
    let touching = r.tables("touching", |p| read_pair(p, "pair"));
    ClearanceFile {
        touching: touching.into_iter().flatten().collect(),
        minimum,
        pairs: pairs.into_iter().flatten().collect(),
        ignored: ignored.into_iter().flatten().collect(),
    }
}

fn read_pair(r: &mut TableReader, key: &'static str) -> Option<PairFile> {
    let span = r.span.clone();
    let names = required_value(r, key, |r, k| r.strings(k))?;
    Some(PairFile { names, span })
}
