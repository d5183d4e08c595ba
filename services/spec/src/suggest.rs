//! "Did you mean …?": the nearest name by edit distance.

/// Names longer than this are cut before they are compared, so that the cost stays small.
const MAX_COMPARED: usize = 48;

/// The allowed name nearest to what was written, if any is near enough to be what was meant: at most a third of
/// the letters differ, or one begins with the other. Upper and lower case count as the same.
pub(crate) fn nearest(written: &str, allowed: &[String]) -> Option<String> {
    let written = folded(written);
    if written.is_empty() {
        return None;
    }
    allowed
        .iter()
        .filter_map(|name| {
            let candidate = folded(name);
            let distance = distance(&written, &candidate);
            let close = distance * 3 <= written.len().max(candidate.len()).max(3);
            (close || one_begins_with_other(&written, &candidate)).then_some((distance, name))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name.clone())
}

fn folded(name: &str) -> Vec<char> {
    name.chars()
        .take(MAX_COMPARED)
        .flat_map(char::to_lowercase)
        .collect()
}

fn one_begins_with_other(a: &[char], b: &[char]) -> bool {
    a.len().min(b.len()) >= 3 && (a.starts_with(b) || b.starts_with(a))
}

/// Optimal string alignment: insertions, deletions, replacements and swaps of neighbours, one each.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replace = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replace.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
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
        let letters = |text: &str| text.chars().collect::<Vec<_>>();
        assert_eq!(distance(&letters("unifrom"), &letters("uniform")), 1);
        assert_eq!(distance(&letters(""), &letters("abc")), 3);
        assert_eq!(distance(&letters("kitten"), &letters("sitting")), 3);
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
    fn nothing_is_suggested_for_a_word_unlike_all() {
        assert_eq!(among("banana", &["alpha", "water"]), None);
        assert_eq!(among("", &["alpha"]), None);
    }
}
