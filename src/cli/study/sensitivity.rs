//! `mechanim sensitivity`: the exact derivative of every measure by every dimension, ranked; suggested tolerances.

use crate::analysis::study::DefaultVariables;
use crate::cli::args::study::SensitivityArgs;
use crate::cli::io;
use crate::cli::open::study::open_study;
use crate::cli::pictures::sensitivity_bars as sensitivity_plot;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::report::sensitivity::SensitivityTable;

/// Runs the verb.
pub fn run_sensitivity(args: &SensitivityArgs, term: &Term) -> Result<Outcome, Failure> {
    let plot = args.plot.as_deref();
    let plot = plot.map(|path| sensitivity_plot::open_bars(&args.scene, path));
    let plot = plot.transpose()?;
    let study = open_study(&args.scene, &args.vary, DefaultVariables::All, term)?;
    let family = &study.family;
    let nominal = study.nominal()?;
    let rank = study.ranking(&nominal, args.rank.as_deref())?;
    let allowed = match &args.scatter {
        Some((name, scatter)) => {
            let measure = study.ranking(&nominal, Some(name))?;
            let unit = family.units(family.measures.list[measure].kind);
            Some((measure, scatter / unit))
        }
        None => None,
    };
    let table = SensitivityTable::new(family, &nominal, rank, allowed);
    if let Some(plot) = plot {
        plot.write(&table, rank)?;
    }
    let document = table.document();
    match &args.out {
        Some(path)
            if path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("csv")) =>
        {
            io::write_text(&args.scene, path, &table.csv())?;
        }
        Some(path) => io::write_json(&args.scene, path, &document)?,
        None => {}
    }
    io::print_beside(term, args.out.as_deref(), &table.text(rank))?;
    Ok(Outcome::Done)
}
