//! The commands by topic, with an example of each, as the help and the man pages show them.

use std::fmt::Write;

use clap::Command;

pub(super) struct Topic {
    pub(super) title: &'static str,
    /// Each command with an example.
    pub(super) commands: &'static [(&'static str, &'static str)],
}

/// Declares topics: title, and each command with an example.
macro_rules! topics {
    ($($title:literal { $($command:literal $example:literal;)* })*) => {
        &[$(Topic { title: $title, commands: &[$(($command, $example)),*] }),*]
    };
}

pub(super) const TOPICS: &[Topic] = topics! {
    "Rendering commands" {
        "new" "fathom new shaft --out job.json";
        "render" "fathom render job.json --out frames --slots 4";
        "plan" "fathom plan job.json --frame 3";
        "tradeoff" "fathom tradeoff shaft --out tradeoff";
        "bag" "fathom bag dive.mcap wet.mcap --job job.json --image /camera/image_raw --depth /camera/depth";
        "demo" "fathom demo --out data/demo";
        "reproduce" "fathom reproduce --out paper";
    }
    "Service commands" {
        "serve" "fathom serve --data data --workers 2";
        "worker" "fathom worker --server http://10.0.0.5:7311 --slots 8";
        "backup" "fathom backup";
        "scrub" "fathom scrub --data data --repair";
    }
    "Job commands" {
        "submit" "fathom submit job.json --wait";
        "jobs" "fathom jobs --state running";
        "wait" "fathom wait job_0198c0ffee00";
        "errors" "fathom errors job_0198c0ffee00";
        "retry" "fathom retry job_0198c0ffee00";
        "finish-elsewhere" "fathom finish-elsewhere job_0198c0ffee00";
        "start-again" "fathom start-again job_0198c0ffee00";
        "pause" "fathom pause job_0198c0ffee00";
        "resume" "fathom resume job_0198c0ffee00";
        "cancel" "fathom cancel job_0198c0ffee00";
        "list" "fathom list enhancements";
    }
    "Dataset commands" {
        "datasets" "fathom datasets";
        "query" "fathom query 'uiqm > 0.8' --dataset tour --order-by=-uiqm";
        "stats" "fathom stats tour --metrics uiqm,uciqe --by water.optics,alpha:0.1";
        "sheet" "fathom sheet tour --kind semantics --out tour.png";
        "export" "fathom export tour --kinds rgb,range --out tour";
        "scenes" "fathom scenes";
        "upload" "fathom upload quay.png --range quay.range.png --unit-m 0.001 --invalid-code 0";
        "rm" "fathom rm tour --yes";
        "seal" "fathom seal tour";
        "verify" "fathom verify tour@1";
    }
    "Sharded dataset commands" {
        "status" "fathom status s3://bucket/set";
        "import" "fathom import s3://bucket/set --server --wait";
        "gc" "fathom gc s3://bucket/set";
    }
    "Water and style commands" {
        "waters" "fathom waters --server";
        "styles" "fathom styles add bay.onnx";
        "train" "fathom train bay.jpg --name bay";
    }
    "Picture commands" {
        "enhance" "fathom enhance hscm:cutoff=16 dive --out clear";
        "measure" "fathom measure dim.png clear.png --json";
    }
    "Shell commands" {
        "completions" "fathom completions bash > ~/.local/share/bash-completion/completions/fathom";
        "man" "fathom man ~/.local/share/man/man1";
    }
};

/// Replaces the list of commands by topics, and adds an example to the help of each command.
pub(crate) fn arrange(command: Command) -> Command {
    let header = *command.get_styles().get_header();
    let literal = *command.get_styles().get_literal();
    let examples = TOPICS.iter().flat_map(|topic| topic.commands);
    let width = examples.clone().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut template = "{about-with-newline}\n{usage-heading} {usage}\n".to_owned();
    for Topic { title, commands } in TOPICS {
        template.push_str(&format!("\n{header}{title}:{header:#}\n"));
        for (name, _) in *commands {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map_or_else(String::new, ToString::to_string);
            // Writing to a string cannot fail.
            let _ = writeln!(template, "  {literal}{name:width$}{literal:#}  {about}");
        }
    }
    template.push_str(&format!("\n{header}Options:{header:#}\n{{options}}"));
    examples.fold(command.help_template(template), |command, (name, example)| {
        command.mut_subcommand(name, |command| {
            command.after_help(format!("{header}Example:{header:#}\n  {example}"))
        })
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::CommandFactory;

    use super::*;

    /// The words of a command as a shell splits them, up to where its output goes.
    fn words(line: &str) -> Vec<String> {
        let line = line.split(" > ~").next().unwrap_or_default();
        let parts = line.split('\'').enumerate();
        let words = parts.flat_map(|(index, part)| match index % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect(),
            _ => vec![part.to_owned()],
        });
        words.collect()
    }

    #[test]
    fn every_command_stands_under_one_topic_and_its_example_is_valid() {
        let all = crate::commands::Arguments::command();
        let shown = all.get_subcommands().filter(|command| !command.is_hide_set());
        let shown: BTreeSet<String> = shown.map(|command| command.get_name().to_owned()).collect();
        let listed: Vec<String> = TOPICS
            .iter()
            .flat_map(|topic| topic.commands)
            .map(|(name, _)| (*name).to_owned())
            .collect();
        assert_eq!(
            listed.len(),
            shown.len(),
            "a command is listed twice or not at all"
        );
        assert_eq!(listed.into_iter().collect::<BTreeSet<_>>(), shown);
        for (name, example) in TOPICS.iter().flat_map(|topic| topic.commands) {
            let words = words(example);
            assert_eq!(words[..2], ["fathom", name], "{example}");
            let parsed = all.clone().try_get_matches_from(&words);
            assert!(parsed.is_ok(), "{example}: {}", parsed.unwrap_err());
        }
    }

    #[test]
    fn the_help_shows_topics_and_a_command_its_example() {
        let mut command = crate::commands::command();
        let help = command.render_help().to_string();
        for part in ["Job commands:\n  submit", "Pause a job", "Options:\n      --wide"] {
            assert!(help.contains(part), "{part} is missing in:\n{help}");
        }
        let submit = command
            .find_subcommand_mut("submit")
            .unwrap()
            .render_help()
            .to_string();
        assert!(
            submit.contains("Example:\n  fathom submit job.json --wait"),
            "{submit}"
        );
    }
}
