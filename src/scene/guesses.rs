//! A scene's text with other start values.

use super::file;
use crate::diag::{Diagnostics, Source};

/// The text of `source` with these start values of unknowns, as numbers of the file; entries that are missing are added.
///
/// `None` if the text has mistakes, or would have some.
pub fn with_guess(source: &Source, values: &[(String, String)]) -> Option<String> {
    let mut diagnostics = Diagnostics::default();
    let file = file::read(source, &mut diagnostics);
    let mut text = source.text.clone();
    let (mut edits, mut added) = (Vec::new(), String::new());
    for (name, value) in values {
        match file.guess.iter().find(|(n, _)| n.value == *name) {
            Some((_, formula)) => edits.push((formula.span.clone(), value.clone())),
            None => added.push_str(&format!("{name} = {value}\n")),
        }
    }
    match file.guess.iter().map(|(_, formula)| formula.span.end).max() {
        // After the line of the last entry.
        Some(end) if !added.is_empty() => {
            let line = text[end..].find('\n').map_or(text.len(), |k| end + k + 1);
            edits.push((line..line, added));
        }
        None if !added.is_empty() => text.push_str(&format!("\n[guess]\n{added}")),
        _ => {}
    }
    edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    for (span, value) in edits {
        text.replace_range(span, &value);
    }
    let edited = Source {
        text,
        ..source.clone()
    };
    file::read(&edited, &mut diagnostics);
    (!diagnostics.has_errors()).then_some(edited.text)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::scene::{Overrides, builtin, load};

    #[test]
    fn start_values_are_replaced_and_added() {
        let source = builtin::find("sphere-torus").unwrap();
        let values = [("beta2", "12.5"), ("c.phi2", "80"), ("c.theta2", "1e-3")];
        let values = values.map(|(n, v)| (n.to_owned(), v.to_owned()));
        let mut other = source.clone();
        other.text = with_guess(&source, &values).unwrap();
        let mechanism = load(&other, &Overrides::default()).unwrap().mechanism;
        for (name, value) in &values {
            let index = mechanism.unknowns.iter().position(|u| u.name == *name);
            let guess = mechanism.guess[index.unwrap()].to_degrees();
            assert!(
                (guess - value.parse::<f64>().unwrap()).abs() < 1e-12,
                "{name}"
            );
        }
        // Without the section it is made.
        let bare = Source {
            text: "[chains]\na = \"Tx(x)\"\n[loops]\nA = \"a Tx(-2)\"\n".to_owned(),
            ..source
        };
        let text = with_guess(&bare, &[("x".to_owned(), "1.5".to_owned())]).unwrap();
        assert!(text.ends_with("\n[guess]\nx = 1.5\n"), "{text}");
    }
}
