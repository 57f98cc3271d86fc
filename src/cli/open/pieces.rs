//! Dimensions with tolerances: which, how large, and the family of all pieces within them.

use crate::analysis::enclosure::MOST_DIMENSIONS;
use crate::analysis::study::{ParametricMechanism, varied_names};
use crate::cli::term::outcome::Failure;
use crate::diag::Source;
use crate::model::mechanism::{Kind, Mechanism};
use crate::scene::{KeptIn, Overrides, Scene};

/// What has which tolerance, as the command line says.
pub struct AskedPieces<'a> {
    /// Names in place of the scene's own choice.
    pub vary: &'a [String],
    /// Of every dimension that has none of its own, in its unit.
    pub tolerance: Option<f64>,
    /// The option of that.
    pub option: &'static str,
    /// Times between samples are asked for, too.
    pub between: bool,
}

/// The family of all pieces, and the tolerances by name in internal units. `own` are those of intervals on the command line.
pub fn open_pieces(
    asked: &AskedPieces,
    own: &[(String, f64)],
    (source, overrides, drawn): (&Source, &Overrides, &Scene),
) -> Result<(ParametricMechanism, Vec<(String, f64)>), Failure> {
    let tolerances = piece_tolerances(asked, own, drawn)?;
    let parameters: Vec<String> = tolerances
        .iter()
        .map(|(name, _)| name.clone())
        .filter(|name| !is_input(&drawn.mechanism, name))
        .collect();
    let family = ParametricMechanism::varying(source, overrides, &parameters)?;
    refuse_kept(&family)?;
    Ok((family, tolerances))
}

/// Tolerances by name, in internal units.
fn piece_tolerances(
    asked: &AskedPieces,
    own: &[(String, f64)],
    drawn: &Scene,
) -> Result<Vec<(String, f64)>, Failure> {
    let mechanism = &drawn.mechanism;
    let study = drawn.study.iter().flat_map(|s| &s.variables);
    let of_study: Vec<(&str, f64)> = study
        .filter_map(|v| Some((v.name.as_str(), v.tolerance?)))
        .collect();
    let listed = if !asked.vary.is_empty() {
        varied_names(asked.vary, false, &drawn.dimensions)?
    } else if own.is_empty() && of_study.is_empty() {
        drawn.dimensions.clone()
    } else {
        of_study
            .iter()
            .map(|(name, _)| (*name).to_owned())
            .collect()
    };
    let mut all: Vec<String> = own.iter().map(|(name, _)| name.clone()).collect();
    all.extend(
        listed
            .into_iter()
            .filter(|name| !own.iter().any(|(n, _)| n == name)),
    );
    if all.is_empty() {
        let message =
            "nothing has a tolerance: name parameters with --vary, or write --param NAME=880+-0.2";
        return Err(Failure::usage(message, Vec::new()));
    }
    // Between samples the inputs are dimensions as well.
    let inputs = if asked.between {
        mechanism.inputs.len()
    } else {
        0
    };
    if all.len() + inputs > MOST_DIMENSIONS {
        let message = format!(
            "at most {MOST_DIMENSIONS} dimensions are enclosed together, found {}",
            all.len() + inputs
        );
        return Err(Failure::usage(
            message,
            vec!["name fewer with --vary".to_owned()],
        ));
    }
    let mut missing = Vec::new();
    let mut list = Vec::new();
    for name in all {
        let kind = kind_of(drawn, &name);
        let unit = mechanism.unit_of(kind).number();
        let given = own.iter().find(|(n, _)| *n == name).map(|(_, t)| t * unit);
        let of_study = of_study.iter().find(|(n, _)| *n == name).map(|(_, t)| *t);
        let general = asked.tolerance.map(|t| t * unit);
        match given.or(of_study).or(general) {
            Some(tolerance) => list.push((name, tolerance)),
            None => missing.push(name),
        }
    }
    if missing.is_empty() {
        return Ok(list);
    }
    Err(Failure::usage(
        format!("no tolerance is known of {}", missing.join(", ")),
        vec![format!(
            "give one for all with {} 0.1, or each its own: --param NAME=880+-0.2, or \
                 `[study.variables]` NAME = {{ tolerance = 0.1 }}",
            asked.option
        )],
    ))
}

fn is_input(mechanism: &Mechanism, name: &str) -> bool {
    mechanism.inputs.iter().any(|input| input.name == name)
}

/// What a parameter or input measures.
fn kind_of(drawn: &Scene, name: &str) -> Kind {
    let inputs = drawn.mechanism.inputs.iter();
    let input = inputs.filter(|i| i.name == name).map(|i| i.kind).next();
    let study = drawn.study.iter().flat_map(|s| &s.variables);
    let variable = study.filter(|v| v.name == name).map(|v| v.kind).next();
    let parameter = drawn.kinds.iter().find(|(n, _)| n == name).map(|(_, k)| *k);
    input.or(variable).or(parameter).unwrap_or(Kind::Number)
}

/// Drives and tracks keep the file's dimensions, and a computed one may stand in a measure: nothing would be true of
/// other pieces there.
fn refuse_kept(family: &ParametricMechanism) -> Result<(), Failure> {
    let Some(kept) = family.kept.first() else {
        return Ok(());
    };
    let place = match kept.place {
        KeptIn::Drive => "in a drive",
        KeptIn::Track => "in the ends of a track",
        KeptIn::Measure => "in a measure, by a parameter that is computed from it",
        KeptIn::Direction => "in the axis of a rotation",
    };
    Err(Failure::usage(
        format!(
            "`{}` stands {place}, where its tolerance would be left out",
            kept.name
        ),
        vec!["leave it out with --vary, or write the number there".to_owned()],
    ))
}
