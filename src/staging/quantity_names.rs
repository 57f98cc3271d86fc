//! Names of quantities as in handwriting: Greek letters and subscripts.

/// Names of the Greek letters.
const GREEK: [(&str, char); 36] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("eps", 'ε'),
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

/// A name as its letter, or word, and what stands below it: `beta1` and `L6s` are `beta`, `1` and `L`, `6s`.
pub fn split_symbol(name: &str) -> (&str, &str) {
    let digit = name
        .find(|c: char| c.is_ascii_digit())
        .unwrap_or(name.len());
    let stem = &name[..digit];
    let is_letter = stem.chars().count() == 1 || greek_word(stem).is_some();
    match is_letter || name[digit..].chars().all(|c| c.is_ascii_digit()) {
        true if !stem.is_empty() => (stem.strip_suffix('_').unwrap_or(stem), &name[digit..]),
        _ => (name, ""),
    }
}

/// The name of a Greek letter, if it is one.
pub fn greek_word(stem: &str) -> Option<&'static str> {
    let known = GREEK.iter().find(|(word, _)| *word == stem);
    known.map(|(word, _)| *word)
}

/// Names in a formula as by hand: Greek letters, subscripts, a real minus.
pub fn written_names(text: &str) -> String {
    let mut out = String::new();
    let mut word = String::new();
    for c in text.chars().chain(['\0']) {
        if c.is_alphanumeric() || c == '_' {
            word.push(c);
            continue;
        }
        out.push_str(&written_symbol(&word));
        word.clear();
        match c {
            '\0' => {}
            '-' => out.push('\u{2212}'),
            c => out.push(c),
        }
    }
    out
}

/// The label of a curve: names as by hand, also those of a rate such as `dh/dphi`.
pub fn written_label(text: &str) -> String {
    let parts: Vec<&str> = text.split('/').collect();
    let rates: Vec<String> = parts.iter().filter_map(|part| written_rate(part)).collect();
    match (parts.len(), rates.as_slice()) {
        (2, [of, per]) => format!("{of}/{per}"),
        _ => written_names(text),
    }
}

/// One side of a rate: `d²h`, `dphi²`.
fn written_rate(part: &str) -> Option<String> {
    let inner = part.strip_prefix('d')?;
    let name = inner.trim_matches(['²', '³', '⁴', '⁵', '⁶', '⁷', '⁸']);
    let is_name = |c: char| c.is_alphanumeric() || "._".contains(c);
    (!name.is_empty() && name.chars().all(is_name))
        .then(|| format!("d{}", inner.replacen(name, &written_names(name), 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_formulas_as_by_hand() {
        for (text, written) in [
            ("gamma - phi", "γ \u{2212} φ"),
            ("dh/dphi", "dh/dφ"),
            ("d²beta2/dbeta1²", "d²β₂/dβ₁²"),
            ("delta/d", "δ/d"),
            ("M.x", "M.x"),
            ("c.theta1", "c.θ₁"),
        ] {
            assert_eq!(written_label(text), written);
        }
        for (name, parts) in [
            ("beta1", ("beta", "1")),
            ("L6s", ("L", "6s")),
            ("crank", ("crank", "")),
            ("XR1", ("XR", "1")),
        ] {
            assert_eq!(split_symbol(name), parts);
        }
    }

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
