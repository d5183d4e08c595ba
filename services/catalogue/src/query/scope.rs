//! The meaning of a dataset's name in queries: the growing dataset, or a sealed version of it.

/// A dataset, or a version of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Scope<'a> {
    pub(crate) dataset: &'a str,
    pub(crate) version: Option<u64>,
}

impl<'a> Scope<'a> {
    /// Reads `tour` or `tour@1`. Names of datasets have no `@`.
    pub(crate) fn parse(name: &'a str) -> Self {
        let version = name.rsplit_once('@').and_then(|(dataset, version)| {
            let number: u32 = version.parse().ok()?;
            // One name for one version: neither `tour@01` nor `tour@+1`.
            (number.to_string() == version).then_some((dataset, u64::from(number)))
        });
        version.map_or(
            Self {
                dataset: name,
                version: None,
            },
            |(dataset, version)| Self {
                dataset,
                version: Some(version),
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_a_number_behind_an_at_sign_is_a_version() {
        let scope = |name| {
            let Scope { dataset, version } = Scope::parse(name);
            (dataset, version)
        };
        assert_eq!(scope("tour"), ("tour", None));
        assert_eq!(scope("tour@12"), ("tour", Some(12)));
        for odd in [
            "tour@",
            "tour@01",
            "tour@+1",
            "tour@-1",
            "tour@x",
            "tour@1@",
            "tour@99999999999",
        ] {
            assert_eq!(scope(odd), (odd, None), "{odd}");
        }
    }
}
