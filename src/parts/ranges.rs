//! Lists of unit numbers as job schedulers write them: `3,17-21`.

/// Ascending numbers, runs of them written with a dash.
pub fn shown_ranges(numbers: &[u64]) -> String {
    let mut runs: Vec<[u64; 2]> = Vec::new();
    for number in numbers {
        match runs.last_mut() {
            Some(run) if run[1] + 1 == *number => run[1] = *number,
            _ => runs.push([*number; 2]),
        }
    }
    let shown = runs.iter().map(|[first, last]| match first == last {
        true => first.to_string(),
        false => format!("{first}-{last}"),
    });
    shown.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_written_with_a_dash() {
        assert_eq!(shown_ranges(&[3, 17, 18, 19, 20, 21]), "3,17-21");
        assert_eq!(shown_ranges(&[0, 1]), "0-1");
        assert_eq!(shown_ranges(&[]), "");
    }
}
