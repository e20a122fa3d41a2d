//! `volref --help`: an example, and the commands under the questions that they answer.

use clap::builder::Styles;
use clap::{Command, Subcommand};

/// Commands by what a user has; the rarely used last.
const GROUPS: [(&str, &[&str]); 4] = [
    (
        "My renderer: are its images right?",
        &["list", "validate", "compare", "export", "gallery"],
    ),
    (
        "My data: how does it look, and what does that cost?",
        &["render", "info", "plan", "cost", "sensitivity"],
    ),
    ("My goldens: do they still hold?", &["verify", "accept"]),
    (
        "Also",
        &[
            "merge",
            "selftest",
            "suite",
            "schema",
            "completions",
            "help",
        ],
    ),
];

/// The first command of each group.
pub const EXAMPLE: &str = "\
For example, in any folder:
  volref list
  volref validate core --run 'my-renderer {scene} {output}' --report report
  volref render figures/figure-3 -o figure-3.png";

/// Help of a command that shows its example before its usage.
pub const EXAMPLE_FIRST: &str =
    "{about-with-newline}\n{before-help}{usage-heading} {usage}\n\n{all-args}{after-help}";

/// Help of the command as a whole; clap itself knows no groups of commands.
pub fn template<C: Subcommand>() -> String {
    let mut all = C::augment_subcommands(Command::new("volref"));
    all.build();
    let styles = Styles::styled();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let mut groups = String::new();
    for (question, names) in GROUPS {
        groups.push_str(&format!("{header}{question}{header:#}\n"));
        for command in names.iter().filter_map(|name| all.find_subcommand(name)) {
            let (name, about) = (command.get_name(), command.get_about());
            let about = about.map(ToString::to_string).unwrap_or_default();
            groups.push_str(&format!("  {literal}{name:<11}{literal:#}  {about}\n"));
        }
        groups.push('\n');
    }
    let options = format!("{header}Options:{header:#}\n{{options}}");
    EXAMPLE_FIRST.replace("{all-args}", &(groups + &options))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The name of the longest command, and what stands around it.
    const BEFORE_ABOUT: usize = 15;

    #[test]
    fn each_command_is_in_one_group_and_one_line() {
        let mut all = super::super::Command::augment_subcommands(Command::new("volref"));
        all.build();
        let names = GROUPS.iter().flat_map(|(_, names)| *names).copied();
        let grouped: BTreeSet<&str> = names.clone().collect();
        assert_eq!(grouped.len(), names.count(), "a command is in two groups");
        let shown = || {
            all.get_subcommands()
                .filter(|command| !command.is_hide_set())
        };
        let known: BTreeSet<&str> = shown().map(Command::get_name).collect();
        assert_eq!(grouped, known, "GROUPS and the commands");
        for command in shown() {
            let about = command
                .get_about()
                .map(ToString::to_string)
                .unwrap_or_default();
            let is_short = BEFORE_ABOUT + about.chars().count() <= 80;
            assert!(
                is_short && !about.is_empty(),
                "{}: {about}",
                command.get_name()
            );
        }
    }
}
