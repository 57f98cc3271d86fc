//! The list of verbs in the program's help: by what they are for, one line each.

use clap::Command;

/// What verbs are for, with the verbs.
const GROUPS: [(&str, &str); 5] = [
    ("Move and draw", "solve render plot draw show modes"),
    (
        "Judge and report",
        "check report compare site snapshot diff",
    ),
    (
        "Dimensions and tolerances",
        "sensitivity tolerance enclose optimise synthesise sweep study accuracy",
    ),
    ("Planar linkages", "intervals dyads"),
    (
        "Scenes, files, help",
        "new scenes encode schema manual completions info",
    ),
];

/// What to begin with.
const EXAMPLES: &str = "Examples:
  mechanim scenes                                    scenes to begin with
  mechanim render gearshift --out anim.gif           a motion as an animation
  mechanim check \"designs/*.toml\"                    closure and clearances, with proof
  mechanim report gearshift --out gearshift.html     all results on one page
  mechanim VERB --help                               every option of a verb";

/// Most characters of a verb's line.
const MOST: usize = 72;

/// The command with its verbs in groups.
pub fn grouped_command(command: Command) -> Command {
    let mut list = String::new();
    for (head, verbs) in GROUPS {
        list.push_str(&format!("{head}:\n"));
        for verb in verbs.split(' ') {
            let about = command.find_subcommand(verb).and_then(Command::get_about);
            let about = about.map_or_else(String::new, |text| first_words(&text.to_string()));
            list.push_str(&format!("  {verb:<13}{about}\n"));
        }
        list.push('\n');
    }
    command.help_template(format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{list}{EXAMPLES}\n\nOptions:\n{{options}}\n\n{{after-help}}\n"
    ))
}

/// The beginning of a sentence, up to where its details begin.
fn first_words(sentence: &str) -> String {
    let first = sentence.split([':', ';', '(']).next().unwrap_or_default();
    let text = first.trim_end().trim_end_matches('.');
    if text.chars().count() <= MOST {
        return text.to_owned();
    }
    // A list is told by its first part; what has none is cut at a word.
    match text.split_once(", ") {
        Some((part, _)) if part.chars().count() <= MOST => part.to_owned(),
        _ => {
            let start: String = text.chars().take(MOST).collect();
            let words = start.rsplit_once(' ').map_or("", |(words, _)| words);
            format!("{words} …")
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::cli::args::Cli;
    use clap::CommandFactory;

    #[test]
    fn every_verb_is_in_one_group() {
        let command = Cli::command();
        let mut known: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        let mut listed: Vec<&str> = GROUPS
            .iter()
            .flat_map(|(_, verbs)| verbs.split(' '))
            .collect();
        known.sort_unstable();
        listed.sort_unstable();
        assert_eq!(known, listed);
        let help = grouped_command(command).render_help().to_string();
        let verbs = help.split("Options:").next().unwrap_or_default();
        for line in verbs
            .lines()
            .filter(|line| line.starts_with("  ") && !line.contains("--"))
        {
            assert!(line.chars().count() <= 100, "{line}");
        }
        assert!(
            help.contains("Judge and report:\n  check        Check closure"),
            "{help}"
        );
    }
}
