//! The scenes that come with the program: the files of `scenes/`, compiled in.

use crate::diag::Source;

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Name on the command line.
    pub name: &'static str,
    /// The file's text.
    pub text: &'static str,
}

macro_rules! builtin {
    ($($name:literal),* $(,)?) => {
        [$(Builtin { name: $name, text: include_str!(concat!("../../scenes/", $name, ".toml")) }),*]
    };
}

/// All of them, in the order of the list.
pub const ALL: [Builtin; 25] = builtin![
    "gearshift",
    "gearshift-optimised",
    "gearshift-left",
    "twin-steer",
    "slider-crank",
    "feeder",
    "rope-drum",
    "lifting-arm",
    "dyads",
    "dyads-bars",
    "torus-torus",
    "seven-r",
    "sphere-torus",
    "rsrrr",
    "rurrrr",
    "sphere-sphere",
    "rsur",
    "rurur",
    "rrsrr",
    "four-bar",
    "peaucellier",
    "hooke-joint",
    "bennett",
    "bricard",
    "sarrus",
];

/// The built-in scene of that name.
pub fn find_builtin(name: &str) -> Option<Source> {
    ALL.iter()
        .find(|scene| scene.name == name)
        .map(|scene| Source {
            name: scene.name.to_owned(),
            text: scene.text.to_owned(),
        })
}
