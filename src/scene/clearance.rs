//! The `[clearance]` section: as typed.

use super::reader::{Spanned, TableReader, required};
use super::values::FormulaText;
use crate::diag::Span;

/// The section as typed.
#[derive(Clone, Debug, Default)]
pub struct ClearanceFile {
    /// `minimum`
    pub minimum: Option<FormulaText>,
    /// `pairs` with their own minima.
    pub pairs: Vec<(PairFile, FormulaText)>,
    /// `ignore` with the reasons.
    pub ignored: Vec<(PairFile, Spanned<String>)>,
    /// `touching`
    pub touching: Vec<PairFile>,
}

/// Two names.
#[derive(Clone, Debug)]
pub struct PairFile {
    /// The names as typed, two if they are right.
    pub names: Vec<Spanned<String>>,
    /// The entry.
    pub span: Span,
}

/// Reads the section.
pub fn read(r: &mut TableReader) -> ClearanceFile {
    let minimum = r.formula("minimum");
    let pairs = r.tables("pairs", |p| {
        let pair = pair(p);
        let minimum = required(p, "minimum", |p, k| p.formula(k));
        Some((pair?, minimum?))
    });
    let ignored = r.tables("ignore", |p| {
        let pair = pair(p);
        let reason = required(p, "reason", |p, k| p.string(k));
        Some((pair?, reason?))
    });
    let touching = r.tables("touching", |p| pair(p));
    ClearanceFile {
        touching: touching.into_iter().flatten().collect(),
        minimum,
        pairs: pairs.into_iter().flatten().collect(),
        ignored: ignored.into_iter().flatten().collect(),
    }
}

fn pair(r: &mut TableReader) -> Option<PairFile> {
    let span = r.span.clone();
    let names = required(r, "pair", |r, k| r.strings(k))?;
    Some(PairFile { names, span })
}
