//! `mechanim show`: chains and loops as matrices.

use crate::cli::args::board::{BoardFormat, ShowArgs};
use crate::cli::io;
use crate::cli::open::pose::coordinates_at;
use crate::cli::open::scene::open_changed;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::model::notation::{Notation, WrittenChain};
use crate::report::matrices::ShownChains;
use std::path::Path;

/// Runs the verb.
pub fn run_show(args: &ShowArgs, term: &Term) -> Result<Outcome, Failure> {
    let open = open_changed(&args.scene, |overrides| overrides.notation = true, term)?;
    let notation = open.scene.notation.clone().unwrap_or_default();
    let chains = chosen_chains(args, &notation)?;
    let coordinates = coordinates_at(&open, args.at)?;
    let shown = ShownChains::new(
        &open.scene.mechanism,
        &notation,
        &chains,
        (args.at, &coordinates),
    );
    let text = match args.board_format() {
        BoardFormat::Text => shown.text(),
        BoardFormat::Latex => shown.latex(),
        BoardFormat::Html => shown.html(),
        BoardFormat::Json => format!("{:#}\n", shown.json()),
    };
    let out = args.out.as_deref().unwrap_or(Path::new("-"));
    io::write_text(&args.scene, out, &text)?;
    Ok(Outcome::Done)
}

/// The requested chains and loops; all loops if none is requested.
fn chosen_chains<'n>(
    args: &ShowArgs,
    notation: &'n Notation,
) -> Result<Vec<&'n WrittenChain>, Failure> {
    let chosen = args.chains.iter().map(|name| named_chain(name, notation));
    let chosen: Vec<&WrittenChain> = chosen.collect::<Result<_, _>>()?;
    Ok(match chosen.is_empty() {
        true => notation.loops.iter().collect(),
        false => chosen,
    })
}

fn named_chain<'n>(name: &str, notation: &'n Notation) -> Result<&'n WrittenChain, Failure> {
    notation.find(name).ok_or_else(|| {
        let all = notation.chains.iter().chain(&notation.loops);
        let names = all.map(|chain| chain.name.as_str());
        Failure::unknown_name("chain or loop", name, names)
    })
}
