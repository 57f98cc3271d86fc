//! Names of quantities as they are written by hand: Greek letters and subscripts.

/// Names of the Greek letters.
const GREEK: [(&str, char); 35] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("omicron", 'ο'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Xi", 'Ξ'),
    ("Pi", 'Π'),
    ("Sigma", 'Σ'),
    ("Upsilon", 'Υ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
];

/// `phi` as `φ`, `beta1` and `beta_1` as `β₁`, `s2` as `s₂`; other names as they are.
pub fn written_symbol(name: &str) -> String {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &name[stem.len()..];
    let stem = match digits {
        "" => stem,
        _ => stem.strip_suffix('_').unwrap_or(stem),
    };
    let greek = GREEK.iter().find(|(word, _)| *word == stem);
    let letter = match (greek, stem.chars().count()) {
        (Some((_, letter)), _) => letter.to_string(),
        (None, 1) => stem.to_owned(),
        _ => return name.to_owned(),
    };
    let below = digits
        .bytes()
        .filter_map(|digit| char::from_u32(u32::from('₀') + u32::from(digit - b'0')));
    letter.chars().chain(below).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greek_and_subscripts_are_written_as_by_hand() {
        for (name, written) in [
            ("phi", "φ"),
            ("beta1", "β₁"),
            ("psi12", "ψ₁₂"),
            ("beta_1", "β₁"),
            ("s2", "s₂"),
            ("p", "p"),
            ("crank", "crank"),
            ("crank2", "crank2"),
            ("Phi", "Φ"),
            ("phi_a", "phi_a"),
        ] {
            assert_eq!(written_symbol(name), written);
        }
    }
}
