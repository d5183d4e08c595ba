//! `fathom gc`: removes files that belong to no shard.

use cli::exit::Failure;
use cli::plural::count;

use super::failure::failure;
use super::open::open;

/// Options of `fathom gc`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The sharded dataset: a folder or s3://BUCKET/PREFIX
    set: String,
    /// Keep files that are younger, such as 90m, 12h or 1d: a shard that is being rendered has files and no marker
    #[arg(long, default_value = "1d", value_parser = age_ms)]
    older: i64,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let removed = open(&arguments.set)?.sweep(arguments.older).map_err(failure)?;
    println!("{} removed", count(removed, "file"));
    Ok(())
}

/// Reads a number with a unit, as milliseconds.
fn age_ms(text: &str) -> Result<i64, String> {
    let wrong = || format!("`{text}` is not a number with s, m, h or d");
    let unit_ms = match text.chars().last() {
        Some('s') => 1_000,
        Some('m') => 60_000,
        Some('h') => 3_600_000,
        Some('d') => 86_400_000,
        _ => return Err(wrong()),
    };
    let number: u32 = text[..text.len() - 1].parse().map_err(|_| wrong())?;
    Ok(i64::from(number) * unit_ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_read_with_their_unit() {
        assert_eq!((age_ms("90m"), age_ms("1d")), (Ok(5_400_000), Ok(86_400_000)));
        for text in ["", "5", "d", "-1h", "1y", "é"] {
            assert!(age_ms(text).is_err(), "{text}");
        }
    }
}
