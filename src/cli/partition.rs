//! `--partition`: one of several parts of the selected cases, for several machines.

use super::failure::{Exit, Failure};
use crate::suite::name_hash;
use std::fmt;
use std::str::FromStr;

/// Part of the cases that a command runs.
#[derive(clap::Args, Debug)]
pub struct PartitionArgument {
    /// Run one part of the cases, after all filters: slice:M/N (every Nth case from the Mth),
    /// hash:M/N (by name, whatever other cases there are), or auto (by the variables of a Slurm
    /// array, a Kubernetes Indexed Job, GitLab CI or Bazel). M is 1 to N
    #[arg(long, value_name = "PART")]
    partition: Option<Partition>,
}

impl PartitionArgument {
    /// Keeps the items of this part; `name` gives the name of one.
    ///
    /// # Errors
    ///
    /// If there were items, and none is of this part.
    pub fn retain<T>(
        &self,
        items: &mut Vec<T>,
        name: impl Fn(&T) -> String,
    ) -> Result<(), Failure> {
        let Some(partition) = &self.partition else {
            return Ok(());
        };
        let (mut at, before) = (0, items.len());
        items.retain(|item| {
            let is_in = partition.has(at, &name(item));
            at += 1;
            is_in
        });
        if before > 0 && items.is_empty() {
            let message = format!("none of the {before} cases is in the part {partition}");
            let help = "take fewer parts: slice:M/N has an empty part only if N is above the number of cases";
            return Err(Failure::new(Exit::Undecided, message, Some(help)));
        }
        Ok(())
    }

    /// True if this run has all that the filters select.
    pub fn is_whole(&self) -> bool {
        self.partition.is_none()
    }

    /// True for the first part, which does the work that belongs to no case.
    pub fn is_first(&self) -> bool {
        self.partition.as_ref().is_none_or(|it| it.part == 1)
    }
}

/// One of several parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Partition {
    /// By the hashes of names, not by places.
    is_hash: bool,
    /// Number of the part, from 1.
    part: u64,
    parts: u64,
}

impl Partition {
    fn new(is_hash: bool, part: u64, parts: u64) -> Result<Partition, String> {
        if part == 0 || part > parts {
            return Err(format!(
                "there is no part {part} of {parts}: parts are 1 to N"
            ));
        }
        Ok(Partition {
            is_hash,
            part,
            parts,
        })
    }

    /// Membership of the item at this place, from 0, of this name.
    fn has(&self, at: u64, name: &str) -> bool {
        let number = match self.is_hash {
            true => name_hash(name),
            false => at,
        };
        number % self.parts == self.part - 1
    }
}

impl fmt::Display for Partition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let by = ["slice", "hash"][usize::from(self.is_hash)];
        write!(f, "{by}:{}/{}", self.part, self.parts)
    }
}

impl FromStr for Partition {
    type Err = String;

    fn from_str(text: &str) -> Result<Partition, String> {
        if text == "auto" {
            return automatic(|name| std::env::var(name).ok());
        }
        let expected = || "expected slice:M/N, hash:M/N or auto".to_owned();
        let (by, numbers) = text.split_once(':').ok_or_else(expected)?;
        let (part, parts) = numbers.split_once('/').ok_or_else(expected)?;
        let number = |text: &str| text.parse().map_err(|_| expected());
        match by {
            "slice" | "hash" => Partition::new(by == "hash", number(part)?, number(parts)?),
            _ => Err(expected()),
        }
    }
}

/// Schedulers that run several parts: their names, the environment variables for the number of a part and for how many
/// there are, and the number of the first part, which Slurm states.
const ENGINES: [(&str, [&str; 2], Option<u64>); 4] = [
    (
        "a Slurm array",
        ["SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT"],
        None,
    ),
    (
        "a Kubernetes Indexed Job",
        ["JOB_COMPLETION_INDEX", "VOLREF_PARTITIONS"],
        Some(0),
    ),
    ("GitLab CI", ["CI_NODE_INDEX", "CI_NODE_TOTAL"], Some(1)),
    ("Bazel", ["TEST_SHARD_INDEX", "TEST_TOTAL_SHARDS"], Some(0)),
];

/// Slurm's variable for the number of the first part.
const SLURM_FIRST: &str = "SLURM_ARRAY_TASK_MIN";

/// The slice that the variables of a scheduler ask for. Missing or incomplete
/// variables are errors, never the whole.
fn automatic(variable: impl Fn(&str) -> Option<String>) -> Result<Partition, String> {
    let number = |name: &str| {
        let value = variable(name).filter(|value| !value.is_empty());
        let parsed = value.map(|value| {
            let number = value.trim().parse::<u64>();
            number.map_err(|_| format!("{name}={value} is not a whole number"))
        });
        parsed.transpose()
    };
    for (engine, [of_part, of_parts], first) in ENGINES {
        let (part, parts) = match (number(of_part)?, number(of_parts)?) {
            (Some(part), Some(parts)) => (part, parts),
            (None, None) => continue,
            // Kubernetes does not say how many parts there are; other programs use its name.
            (Some(_), None) => return Err(format!("{of_part} is set and {of_parts} is not")),
            (None, Some(_)) => return Err(format!("{of_parts} is set and {of_part} is not")),
        };
        let unknown = || format!("{of_part} is set and {SLURM_FIRST} is not");
        let first = match first {
            Some(first) => first,
            None => number(SLURM_FIRST)?.ok_or_else(unknown)?,
        };
        let part = part.saturating_add(1).saturating_sub(first);
        return Partition::new(false, part, parts)
            .map_err(|error| format!("{engine}: {error} ({of_part} begins with {first})"));
    }
    let names = ENGINES.map(|(_, variables, _)| variables.join(" and "));
    Err(format!(
        "no engine says which part this is: auto reads {}",
        names.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(variables: &[(&str, &str)]) -> Result<Partition, String> {
        let value = |name: &str| {
            let found = variables.iter().find(|(of, _)| *of == name);
            found.map(|(_, value)| (*value).to_owned())
        };
        automatic(value)
    }

    fn slice(part: u64, parts: u64) -> Result<Partition, String> {
        Partition::new(false, part, parts)
    }

    #[test]
    fn parts_are_disjoint_and_together_everything() {
        let names: Vec<String> = (0..100).map(|i| format!("family/case-{i}")).collect();
        for by in ["slice", "hash"] {
            for parts in [1, 2, 7, 150] {
                let mut all = Vec::new();
                for part in 1..=parts {
                    let partition = format!("{by}:{part}/{parts}").parse().unwrap();
                    let argument = PartitionArgument {
                        partition: Some(partition),
                    };
                    let mut of_part = names.clone();
                    let found = argument.retain(&mut of_part, String::clone);
                    assert_eq!(found.is_err(), of_part.is_empty());
                    if by == "slice" {
                        let even = names.len() / parts..=names.len().div_ceil(parts);
                        assert!(
                            even.contains(&of_part.len()),
                            "{} of {parts}",
                            of_part.len()
                        );
                    }
                    all.extend(of_part);
                }
                all.sort_by_key(|name| names.iter().position(|other| other == name));
                assert_eq!(all, names, "{by} {parts}");
            }
        }
    }

    #[test]
    fn a_hash_does_not_depend_on_other_cases() {
        let partition: Partition = "hash:2/3".parse().unwrap();
        assert_eq!(
            partition.has(0, "fog/forward"),
            partition.has(17, "fog/forward")
        );
    }

    #[test]
    fn what_is_no_part_is_refused() {
        for text in [
            "slice:0/3",
            "slice:4/3",
            "hash:1/0",
            "slice:1",
            "1/2",
            "slice:a/b",
            "all",
            "",
        ] {
            assert!(text.parse::<Partition>().is_err(), "{text}");
        }
    }

    #[test]
    fn engines_say_which_part_it_is() {
        let slurm = |id, min, count| {
            of(&[
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", min),
                ("SLURM_ARRAY_TASK_COUNT", count),
            ])
        };
        assert_eq!(slurm("0", "0", "8"), slice(1, 8));
        assert_eq!(slurm("8", "1", "8"), slice(8, 8));
        assert_eq!(slurm("12", "10", "4"), slice(3, 4));
        assert!(slurm("3", "10", "4").is_err());
        assert!(slurm("9", "1", "8").is_err());
        let kubernetes = [("JOB_COMPLETION_INDEX", "2"), ("VOLREF_PARTITIONS", "5")];
        assert_eq!(of(&kubernetes), slice(3, 5));
        assert_eq!(
            of(&[("CI_NODE_INDEX", "1"), ("CI_NODE_TOTAL", "2")]),
            slice(1, 2)
        );
        let bazel = [("TEST_SHARD_INDEX", "1"), ("TEST_TOTAL_SHARDS", "2")];
        assert_eq!(of(&bazel), slice(2, 2));
    }

    #[test]
    fn nothing_and_contradictions_are_errors() {
        let error = |variables: &[(&str, &str)]| of(variables).unwrap_err();
        assert!(error(&[]).contains("SLURM_ARRAY_TASK_ID"));
        assert!(error(&[("JOB_COMPLETION_INDEX", "2")]).contains("VOLREF_PARTITIONS is not"));
        assert!(
            error(&[
                ("SLURM_ARRAY_TASK_ID", "1"),
                ("SLURM_ARRAY_TASK_COUNT", "2")
            ])
            .contains("MIN")
        );
        assert!(
            error(&[("CI_NODE_INDEX", "x"), ("CI_NODE_TOTAL", "2")]).contains("not a whole number")
        );
        assert!(error(&[("CI_NODE_INDEX", "0"), ("CI_NODE_TOTAL", "2")]).contains("CI_NODE_INDEX"));
    }
}
