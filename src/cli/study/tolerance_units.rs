//! Tolerance studies in units: sums over the pieces of a unit, and the result of all of them together.

use crate::analysis::piece_sums::PieceSums;
use crate::analysis::tolerance::SampleBatch;
use crate::analysis::tolerance_study::ToleranceStudy;
use crate::cli::args::sweep::RowsArgs;
use crate::cli::interrupt::CANCEL;
use crate::cli::io;
use crate::cli::open::tolerance::OpenTolerance;
use crate::cli::term::outcome::Failure;
use crate::parts::folder::Folder;
use crate::parts::merge::Merge;
use crate::parts::plan::MOST_UNITS;
use crate::report::tolerance::{SHARES, ToleranceReport};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Pieces held in memory before they are summed.
const HELD: u64 = 1 << 14;

/// Pieces from which the time of a unit is estimated.
const TRIED: usize = 512;

/// The study of an opened one.
pub fn study_of(opened: &OpenTolerance) -> Result<ToleranceStudy<'_>, Failure> {
    let study = ToleranceStudy::new(&opened.loaded, opened.general, opened.batch);
    Ok(study?)
}

/// The sums over some pieces; nothing after Ctrl-C. `watch` receives the number finished.
pub fn sums_of(
    study: &ToleranceStudy,
    items: Range<u64>,
    threads: usize,
    watch: &dyn Fn(u64),
) -> Option<Vec<f64>> {
    let mut sums = PieceSums::new(&study.bins());
    for first in items.clone().step_by(HELD as usize) {
        let samples = (items.end - first).min(HELD) as usize;
        let batch = SampleBatch {
            samples,
            first: first as usize,
            threads,
            ..study.batch()
        };
        let made = |made: usize| watch(first - items.start + made as u64);
        let pieces = study.pieces_of(batch, &CANCEL, &made);
        if pieces.made < samples {
            return None;
        }
        sums.add(&pieces);
    }
    Some(sums.record())
}

/// Pieces of a unit that takes about `time` on one thread, a power of two. The total does not depend on it.
pub fn unit_size(study: &ToleranceStudy, pieces: u64, time: Duration) -> u64 {
    let begun = Instant::now();
    let batch = SampleBatch {
        samples: TRIED,
        threads: 1,
        ..study.batch()
    };
    study.pieces_of(batch, &CANCEL, &|_| {});
    let piece = begun.elapsed().as_secs_f64().max(1e-6) / TRIED as f64;
    let size = ((time.as_secs_f64() / piece) as u64).max(1);
    (1 << size.ilog2()).max(pieces.div_ceil(MOST_UNITS))
}

/// Adds up all parts of a study, and reports the result.
pub fn merge(folder: &Folder, opened: &OpenTolerance, rows: &RowsArgs) -> Result<String, Failure> {
    refuse_rows(rows)?;
    let study = study_of(opened)?;
    let bins = study.bins();
    let mut sums = PieceSums::new(&bins);
    Merge::new(folder)?.each_part(&mut |numbers| {
        let part = PieceSums::of_record(&bins, numbers);
        sums.join(part.ok_or_else(|| Failure::Internal("a part contains no sums".to_owned()))?);
        Ok::<(), Failure>(())
    })?;
    // A report is written as a whole or not at all.
    let study = study.with_extremes(&AtomicBool::new(false));
    let report = ToleranceReport {
        study: &study,
        pieces: &sums.summary(&SHARES),
        first: 0,
        seconds: None,
    };
    if let Some(path) = &rows.out {
        io::write_document(path, &report.document())?;
    }
    Ok(report.text())
}

/// Refuses files of rows and charts: only sums over the pieces are kept.
pub fn refuse_rows(rows: &RowsArgs) -> Result<(), Failure> {
    let is_json = |path: &Path| {
        path == Path::new("-")
            || path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("json"))
    };
    if rows.plot.is_some() || rows.out.as_deref().is_some_and(|path| !is_json(path)) {
        let message = "a study of pieces keeps only sums, so that it has a report but no table";
        let hint = "--out report.json; `mechanim tolerance --csv` writes every piece";
        return Err(Failure::usage(message, vec![hint.to_owned()]));
    }
    Ok(())
}
