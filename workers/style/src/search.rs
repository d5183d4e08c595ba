//! Search path of ONNX Runtime.

use std::path::{Path, PathBuf};

/// File name of the library.
const LIBRARY: &str = "libonnxruntime.so";
/// Folder that scripts/get-onnxruntime.sh fills.
const FOLDER: &str = ".onnxruntime";
/// Folders searched upwards, including the first: `target/release/deps` of a checkout is three levels below its root.
const LEVELS: usize = 4;

/// The inputs of the search.
pub(crate) struct SearchPaths {
    /// `ORT_DYLIB_PATH`.
    pub(crate) variable: Option<PathBuf>,
    /// The executable.
    pub(crate) executable: Option<PathBuf>,
    /// The working directory.
    pub(crate) directory: Option<PathBuf>,
}

impl SearchPaths {
    pub(crate) fn of_this_process() -> Self {
        let variable = std::env::var_os("ORT_DYLIB_PATH").filter(|value| !value.is_empty());
        Self {
            variable: variable.map(PathBuf::from),
            executable: std::env::current_exe().ok(),
            directory: std::env::current_dir().ok(),
        }
    }
}

/// A possible location of the library.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct RuntimeCandidate {
    pub(crate) path: PathBuf,
    /// Named by the user; the search ends here.
    pub(crate) named: bool,
}

/// The candidates in search order.
pub(crate) fn candidates(surroundings: &SearchPaths) -> impl Iterator<Item = RuntimeCandidate> {
    let named = surroundings
        .variable
        .clone()
        .map(|path| RuntimeCandidate { path, named: true });
    let beside = surroundings.executable.as_deref().and_then(Path::parent);
    let starts = [beside, surroundings.directory.as_deref()];
    let above = starts
        .into_iter()
        .flatten()
        .flat_map(|start| start.ancestors().take(LEVELS));
    let above = above.map(|folder| folder.join(FOLDER).join(LIBRARY));
    let usual: Vec<PathBuf> = beside
        .map(|folder| folder.join(LIBRARY))
        .into_iter()
        .chain(above)
        .collect();
    let usual = usual
        .into_iter()
        .map(|path| RuntimeCandidate { path, named: false });
    named.into_iter().chain(usual)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surroundings(variable: Option<&str>) -> SearchPaths {
        SearchPaths {
            variable: variable.map(PathBuf::from),
            executable: Some("/app/target/release/fathom".into()),
            directory: Some("/src/workers/style".into()),
        }
    }

    #[test]
    fn a_checkout_is_searched_from_its_executable_and_then_from_the_working_directory() {
        let paths: Vec<PathBuf> = candidates(&surroundings(None))
            .map(|candidate| candidate.path)
            .collect();
        let expected = [
            "/app/target/release/libonnxruntime.so",
            "/app/target/release/.onnxruntime/libonnxruntime.so",
            "/app/target/.onnxruntime/libonnxruntime.so",
            "/app/.onnxruntime/libonnxruntime.so",
            "/.onnxruntime/libonnxruntime.so",
            "/src/workers/style/.onnxruntime/libonnxruntime.so",
            "/src/workers/.onnxruntime/libonnxruntime.so",
            "/src/.onnxruntime/libonnxruntime.so",
            "/.onnxruntime/libonnxruntime.so",
        ];
        assert_eq!(paths, expected.map(PathBuf::from));
    }

    #[test]
    fn the_variable_comes_first_and_is_final() {
        let first = candidates(&surroundings(Some("/opt/ort.so"))).next().unwrap();
        assert_eq!(
            first,
            RuntimeCandidate {
                path: "/opt/ort.so".into(),
                named: true
            }
        );
    }
}
