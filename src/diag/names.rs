//! Hints for unknown names: the name that may have been meant, or else all there are.

/// Maximum number of known names that a hint lists when none resembles the unknown one.
pub(super) const MOST_LISTED: usize = 6;

/// Smallest similarity (Jaro-Winkler, 0 to 1) at which another name is suggested.
const SIMILAR: f64 = 0.75;

/// A hint for an unknown name: the known name that resembles it, or else all known names.
pub fn name_hint<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    match nearest_name(word, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => list_names(known),
    }
}

/// A hint that lists all known names.
pub fn list_names<'a>(known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    match known.is_empty() {
        true => "there are none".to_owned(),
        false => format!("known: {}", known.join(", ")),
    }
}

/// The known name most similar to `word`, if any is.
pub(super) fn nearest_name<'a>(
    word: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    known
        .into_iter()
        .map(|name| {
            (
                strsim::jaro_winkler(&word.to_lowercase(), &name.to_lowercase()),
                name,
            )
        })
        .filter(|(score, _)| *score >= SIMILAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_name_is_offered_only_when_near() {
        let known = ["gearshift", "slider-crank", "seven-r"];
        assert_eq!(nearest_name("gearshfit", known), Some("gearshift"));
        assert_eq!(nearest_name("slidercrank", known), Some("slider-crank"));
        assert_eq!(nearest_name("quux", known), None);
    }

    #[test]
    fn hints_have_one_form() {
        let known = ["gearshift", "seven-r"];
        for (word, names, hint) in [
            ("gearshfit", &known[..], "did you mean `gearshift`?"),
            ("quux", &known, "known: gearshift, seven-r"),
            ("quux", &[], "there are none"),
        ] {
            assert_eq!(name_hint(word, names.iter().copied()), hint);
        }
    }
}
