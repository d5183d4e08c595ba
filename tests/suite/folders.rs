//! Folders as simulators and cameras write them become scenes, and no file is passed over in silence.

#![allow(clippy::unwrap_used)]

use imaging::codec::{encode_jpeg, encode_png};
use imaging::{Plane, Raster, Rgb8};
use serde_json::{Value, json};

use crate::uploader::{SIZE, Uploader, distances, millimeters, picture, png};

fn mask() -> Vec<u8> {
    let mask = Plane::from_fn(
        SIZE.0,
        SIZE.1,
        |x, _| if x < 4 { 0u8 } else { 1 + (x > 12) as u8 },
    );
    encode_png(&Raster::from(mask)).unwrap()
}

/// Objects in colors, as renderers paint them.
fn color_mask() -> Vec<u8> {
    let colors = [[0, 0, 0], [140, 25, 255], [25, 255, 140]];
    let mask = Rgb8::from_fn(SIZE.0, SIZE.1, |x, _| colors[x % 3]);
    encode_png(&mask.into()).unwrap()
}

/// An uncompressed BMP of 24 bits.
fn bmp(pixel: impl Fn(usize, usize) -> [u8; 3]) -> Vec<u8> {
    const HEADER: usize = 54;
    let row = (3 * SIZE.0).next_multiple_of(4);
    let mut file = b"BM".to_vec();
    file.extend(((HEADER + row * SIZE.1) as u32).to_le_bytes());
    file.extend([0; 4]);
    file.extend((HEADER as u32).to_le_bytes());
    file.extend(40u32.to_le_bytes());
    file.extend((SIZE.0 as i32).to_le_bytes());
    file.extend((SIZE.1 as i32).to_le_bytes());
    file.extend([1, 0, 24, 0]);
    file.extend([0; 24]);
    for y in (0..SIZE.1).rev() {
        let start = file.len();
        for x in 0..SIZE.0 {
            let [r, g, b] = pixel(x, y);
            file.extend([b, g, r]);
        }
        file.resize(start + row, 0);
    }
    file
}

#[test]
fn a_folder_of_isaac_sim_has_range_masks_and_classes() {
    let uploader = Uploader::new();
    for number in 0..3u8 {
        uploader.write(&format!("isaac/rgb_{number:04}.png"), &png(number));
        uploader.write(
            &format!("isaac/distance_to_camera_{number:04}.npy"),
            &distances(2.0),
        );
        uploader.write(
            &format!("isaac/distance_to_image_plane_{number:04}.npy"),
            &distances(1.5),
        );
        uploader.write(
            &format!("isaac/instance_segmentation_{number:04}.png"),
            &color_mask(),
        );
        let mapping =
            json!({"(140, 25, 255, 255)": {"class": "pile"}, "(0, 0, 0, 0)": {"class": "BACKGROUND"}});
        let name = format!("isaac/instance_segmentation_semantics_mapping_{number:04}.json");
        uploader.write(&name, mapping.to_string().as_bytes());
        uploader.write(&format!("isaac/normals_{number:04}.png"), &png(9));
    }
    uploader.write("isaac/metadata.txt", b"");
    let uploaded = uploader.upload("isaac", &["--collection", "isaac", "--hfov-deg", "60"]);
    let scenes = uploader.scenes(&uploaded);
    assert_eq!(scenes.len(), 3);
    for scene in &scenes {
        assert_eq!(
            (&scene["range_kind"], &scene["hfov_deg"]),
            (&json!("range"), &json!(60.0))
        );
        assert!(scene["instances_digest"].is_string());
        assert_eq!(scene["classes"]["categories"][0]["name"], "pile");
    }
    for text in [
        "layout isaac: 3 scenes",
        "range of 100.0 % of the pixels, 2.000 to",
        "2 objects: ",
        "normals_",
        "metadata.txt",
        "distance_to_image_plane_",
        "3 scenes: 3 with range, 0 without, 3 with mask",
    ] {
        assert!(uploaded.err.contains(text), "{text}: {}", uploaded.err);
    }
}

#[test]
fn folders_of_other_programs_are_recognized() {
    let uploader = Uploader::new();
    uploader.write("kubric/rgba_00000.png", &png(1));
    uploader.write("kubric/depth_00000.npy", &distances(3.0));
    uploader.write("kubric/segmentation_00000.png", &mask());
    let metadata = json!({"camera": {"field_of_view": std::f64::consts::FRAC_PI_2, "positions": [[1, 2, 3]],
        "quaternions": [[1, 0, 0, 0]]}});
    uploader.write("kubric/metadata.json", metadata.to_string().as_bytes());
    let kubric = uploader.upload("kubric", &[]);
    let scenes = uploader.scenes(&kubric);
    assert_eq!(
        (&scenes[0]["range_kind"], &scenes[0]["hfov_deg"]),
        (&json!("range"), &json!(90.0))
    );
    assert_eq!(scenes[0]["world_from_camera"][2][3], 3.0);

    uploader.write("gazebo/images/image_0000001.png", &png(2));
    uploader.write("gazebo/labels_maps/labels_0000001.png", &color_mask());
    uploader.write("gazebo/colored_maps/colored_0000001.png", &color_mask());
    let gazebo = uploader.upload("gazebo", &[]);
    assert!(uploader.scenes(&gazebo)[0]["instances_digest"].is_string());
    assert!(
        gazebo.err.contains("layout gazebo") && gazebo.err.contains("colored_0000001.png"),
        "{}",
        gazebo.err
    );

    uploader.write("tum/rgb/1305031102.175304.png", &png(3));
    uploader.write("tum/depth/1305031102.160407.png", &millimeters(5000));
    uploader.write(
        "tum/rgb.txt",
        b"# color images\n1305031102.175304 rgb/1305031102.175304.png\n",
    );
    uploader.write(
        "tum/depth.txt",
        b"# depth maps\n1305031102.160407 depth/1305031102.160407.png\n",
    );
    uploader.write("tum/groundtruth.txt", b"1305031102.1758 1.0 2.0 3.0 0 0 0 1\n");
    let tum = uploader.upload("tum", &["--focal-px", "20"]);
    let scene = &uploader.scenes(&tum)[0];
    assert_eq!(
        (&scene["range_kind"], &scene["unit_m"]),
        (&json!("z_depth"), &json!(0.0002))
    );
    assert_eq!(scene["world_from_camera"][1][3], 2.0);
    assert!(tum.err.contains("1.001 to"), "{}", tum.err);

    let jpeg = encode_jpeg(&picture(4), 90).unwrap();
    uploader.write("suim/images/d_r_1.jpg", &jpeg);
    uploader.write(
        "suim/masks/d_r_1.bmp",
        &bmp(|x, _| if x < 8 { [0, 0, 0] } else { [255, 255, 0] }),
    );
    let suim = uploader.upload("suim", &[]);
    assert!(
        suim.err.contains("layout suim") && suim.err.contains("fish 256 px"),
        "{}",
        suim.err
    );

    uploader.write("parallel/rgb/a.png", &png(5));
    uploader.write("parallel/depth/a.png", &millimeters(2500));
    uploader.write("parallel/masks/a.png", &mask());
    let parallel = uploader.upload(
        "parallel",
        &["--unit-m", "0.001", "--invalid-code", "0", "--hfov-deg", "70"],
    );
    let scene = &uploader.scenes(&parallel)[0];
    assert_eq!(scene["range_kind"], "z_depth");
    assert!(
        parallel.err.contains("all files of the folder are used"),
        "{}",
        parallel.err
    );
}

#[test]
fn lookalikes_duplicates_and_depth_without_a_camera_stop_the_upload() {
    let uploader = Uploader::new();
    uploader.write("flat/0001.png", &png(1));
    uploader.write("flat/0001_mask.png", &mask());
    uploader.write("flat/0002.png", &png(2));
    uploader.write("flat/0002.Range.npy", &distances(2.0));
    uploader.write("flat/0003.jpg", &encode_jpeg(&picture(3), 90).unwrap());
    uploader.write("flat/0003.png", &png(3));
    uploader.write("flat/._0001.png", b"\0\0");
    let refused = uploader.upload("flat", &["--collection", "dock"]);
    assert!(!refused.is_complete && refused.out.is_empty());
    for name in ["0001_mask.png", "0003.jpg and 0003.png", "--ignore", "._0001.png"] {
        assert!(refused.err.contains(name), "{name}: {}", refused.err);
    }
    assert_eq!(uploader.service.get("/v1/scenes").1["items"], json!([]));
    let options = [
        "--ignore",
        "*_mask.png",
        "--ignore",
        "0003.jpg",
        "--collection",
        "dock",
    ];
    let uploaded = uploader.upload("flat", &options);
    let ranges: Vec<bool> = uploader
        .scenes(&uploaded)
        .iter()
        .map(|scene| scene["range_kind"].is_string())
        .collect();
    assert_eq!(ranges, [false, true, false]);
    assert!(uploaded.err.contains("--ignore *_mask.png"), "{}", uploaded.err);
    uploader.write("deep/1.png", &png(4));
    uploader.write("deep/1.z_depth.npy", &distances(2.0));
    let refused = uploader.upload("deep", &[]);
    assert!(
        refused.err.contains("give --hfov-deg or --focal-px"),
        "{}",
        refused.err
    );
}

fn transform(path: &str, x: f64) -> Value {
    json!({"file_path": path, "transform_matrix": [[1, 0, 0, x], [0, 0, -1, 0], [0, 1, 0, 2], [0, 0, 0, 1]]})
}

#[test]
fn poses_match_by_path_and_bring_their_camera() {
    let uploader = Uploader::new();
    uploader.write("rig/cam0/0001.png", &png(1));
    uploader.write("rig/cam1/0001.png", &png(2));
    uploader.write("alone/0001.png", &png(3));
    let frames = [
        transform(r"C:\shots\cam0\0001.png", 1.0),
        transform("./cam1/0001", 100.0),
    ];
    let camera = json!({"fl_x": 30.0, "fl_y": 30.0, "cx": 12.0, "cy": 8.0, "w": 24, "h": 16, "k1": -0.1, "frames": frames});
    uploader.write("transforms.json", camera.to_string().as_bytes());
    let poses = uploader.folder.path().join("transforms.json");
    let poses = ["--pose", poses.to_str().unwrap()];
    let uploaded = uploader.upload("rig", &poses);
    let scenes = uploader.scenes(&uploaded);
    let place = |scene: &Value| scene["world_from_camera"][0][3].clone();
    assert_eq!((place(&scenes[0]), place(&scenes[1])), (json!(1.0), json!(100.0)));
    assert_eq!(
        (&scenes[0]["focal_px"], &scenes[0]["cx"]),
        (&json!(30.0), &json!(11.5))
    );
    assert!(uploaded.err.contains("k1"), "{}", uploaded.err);
    let ambiguous = uploader.upload("alone", &poses);
    for name in [r"C:\shots\cam0\0001.png", "./cam1/0001"] {
        assert!(
            !ambiguous.is_complete && ambiguous.err.contains(name),
            "{}",
            ambiguous.err
        );
    }
    uploader.write("other/9.png", &png(4));
    let none = uploader.upload("other", &poses);
    assert!(none.err.contains("no picture fits a frame"), "{}", none.err);
}

#[test]
fn lists_of_parts_and_matrices_of_three_rows_are_read() {
    let uploader = Uploader::new();
    for (part, number) in [("train", 1), ("val", 2)] {
        uploader.write(&format!("lego/{part}/r_0.png"), &png(number));
        let mut frame = transform(&format!("./{part}/r_0"), f64::from(number));
        frame["transform_matrix"].as_array_mut().unwrap().pop();
        let list = json!({"camera_angle_x": 1.0, "applied_scale": 0.5, "frames": [frame]});
        uploader.write(
            &format!("lego/transforms_{part}.json"),
            list.to_string().as_bytes(),
        );
    }
    let uploaded = uploader.upload("lego", &["--hfov-deg", "70"]);
    let places: Vec<Value> = uploader
        .scenes(&uploaded)
        .iter()
        .map(|scene| scene["world_from_camera"][0][3].clone())
        .collect();
    assert_eq!(places, [json!(1.0), json!(2.0)]);
    for note in [
        "layout nerfstudio",
        "applied_scale is not undone",
        "replaces those of the files",
    ] {
        assert!(uploaded.err.contains(note), "{note}: {}", uploaded.err);
    }
}
