//! The poses of a folder's pictures, from the `transforms.json` of nerfstudio and its kin.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::Path;

use cli::exit::Failure;
use cli::files;
use serde::Deserialize;
use serde_json::json;

/// The fields of the file that are used.
#[derive(Deserialize)]
struct Transforms {
    frames: Vec<Transform>,
}

#[derive(Deserialize)]
struct Transform {
    /// Path of the picture; some programs leave the extension out.
    file_path: String,
    /// Rows of the matrix from camera axes right, up, back to the world.
    transform_matrix: [[f64; 4]; 4],
}

/// The pose of each picture in the format of the service, by the name of its file without extension.
pub(super) fn read(path: &Path) -> Result<HashMap<OsString, Vec<u8>>, Failure> {
    let transforms: Transforms = serde_json::from_slice(&files::read(path)?).map_err(|error| {
        Failure::BadInput(format!(
            "{} is not a transforms.json with `frames` of `file_path` and `transform_matrix`: {error}",
            path.display()
        ))
    })?;
    Ok(transforms.frames.into_iter().map(named).collect())
}

fn named(frame: Transform) -> (OsString, Vec<u8>) {
    let name = Path::new(&frame.file_path).file_stem().unwrap_or_default();
    // From right, up, back: the second and the third axis turn around.
    let [x, y, z, last] = frame.transform_matrix;
    let rows = [x, y, z].map(|[right, up, back, place]| [right, 0.0 - up, 0.0 - back, place]);
    let matrix = [rows[0], rows[1], rows[2], last];
    (
        name.to_owned(),
        json!({"world_from_camera": matrix}).to_string().into_bytes(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_nerfstudio_become_those_of_pictures() {
        let frame = Transform {
            file_path: "./images/a.0001.png".to_owned(),
            transform_matrix: [
                [1.0, 0.0, 0.0, 7.0],
                [0.0, 0.0, -1.0, 8.0],
                [0.0, 1.0, 0.0, 9.0],
                [0.0, 0.0, 0.0, 1.0],
            ],
        };
        let (name, pose) = named(frame);
        assert_eq!(name, "a.0001");
        let expected = [
            [1.0, 0.0, 0.0, 7.0],
            [0.0, 0.0, 1.0, 8.0],
            [0.0, -1.0, 0.0, 9.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        assert_eq!(scenes::pose::read(&pose).unwrap(), expected);
    }
}
