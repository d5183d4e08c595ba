//! "Did you mean …?": the closest name by edit distance.

/// Names are cut to this length before the comparison, which bounds its cost.
const MAX_COMPARED: usize = 48;

/// The allowed name closest to `written`, if it is plausible: at most a third of the letters differ, or one is a
/// prefix of the other. Case is ignored.
#[must_use]
pub fn nearest(written: &str, allowed: &[String]) -> Option<String> {
    let written = folded(written);
    if written.is_empty() {
        return None;
    }
    allowed
        .iter()
        .filter_map(|name| {
            let candidate = folded(name);
            let distance = strsim::osa_distance(&written, &candidate);
            let longest = written.chars().count().max(candidate.chars().count());
            let close = distance * 3 <= longest.max(3);
            (close || one_begins_with_other(&written, &candidate)).then_some((distance, name))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name.clone())
}

fn folded(name: &str) -> String {
    name.chars()
        .take(MAX_COMPARED)
        .flat_map(char::to_lowercase)
        .collect()
}

fn one_begins_with_other(a: &str, b: &str) -> bool {
    let least = a.chars().count().min(b.chars().count());
    least >= 3 && (a.starts_with(b) || b.starts_with(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn among(written: &str, allowed: &[&str]) -> Option<String> {
        nearest(
            written,
            &allowed.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>(),
        )
    }

    #[test]
    fn a_swap_of_two_letters_is_one_edit() {
        assert_eq!(among("uv", &["vu"]), Some("vu".to_owned()));
        assert_eq!(among("uv", &["xy"]), None);
    }

    #[test]
    fn the_nearest_of_several_wins_and_case_does_not_count() {
        assert_eq!(
            among("JERLOV-3c", &["jerlov-1C", "jerlov-3C"]),
            Some("jerlov-3C".to_owned())
        );
    }

    #[test]
    fn a_name_without_its_unit_is_completed() {
        assert_eq!(
            among("spread", &["g_per_m", "spread_px_per_m"]),
            Some("spread_px_per_m".to_owned())
        );
    }

    #[test]
    fn dissimilar_words_get_no_suggestion() {
        assert_eq!(among("banana", &["alpha", "water"]), None);
        assert_eq!(among("", &["alpha"]), None);
    }
}
