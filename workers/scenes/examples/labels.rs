//! Writes a sheet of labels, a row for each family: picture, normals, categories, instances and findings:
//! `cargo run --release --example labels -- FILE.png [SEED] [TILE_WIDTH]`.

use imaging::geometry::Intrinsics;
use imaging::{Raster, Rgb8, codec, transfer};
use scenes::{FAMILIES, World};

const SIZE: (usize, usize) = (768, 492);
/// Crack, corrosion, spalling, joint, growth, coating damage.
const COLOURS: [[u8; 3]; 6] = [
    [255, 40, 40],
    [255, 140, 0],
    [250, 240, 60],
    [70, 150, 255],
    [60, 210, 90],
    [230, 90, 230],
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("name the file to write")?;
    let seed = arguments.next().map_or(Ok(2), |seed| seed.parse())?;
    let tile_width = arguments.next().map_or(Ok(300), |width| width.parse())?;
    let lens = Intrinsics::centred(458.0, SIZE.0, SIZE.1);
    let mut tiles = Vec::new();
    for family in FAMILIES {
        let world = World::of(family, seed)?;
        let (scene, labels) = world.render_labelled(&world.pose(), SIZE, &lens);
        let picture = transfer::encode_rgb8(&scene.radiance).0;
        let instances = scene.instances.ok_or("procedural scenes have instances")?;
        let part = |v: f32| ((0.5 + 0.5 * v) * 255.0) as u8;
        let views = [
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| {
                [0, 1, 2].map(|axis| part(labels.normals[axis].at(x, y)))
            }),
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| {
                hue(u32::from(labels.semantics.at(x, y)) + 40)
            }),
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| hue(u32::from(instances.at(x, y)))),
            Rgb8::from_fn(SIZE.0, SIZE.1, |x, y| {
                let bits = labels.findings.at(x, y);
                let first = (0..COLOURS.len()).find(|bit| bits >> bit & 1 == 1);
                first.map_or(picture.at(x, y).map(|v| v / 2), |bit| COLOURS[bit])
            }),
        ];
        tiles.push(codec::downscale(&picture, tile_width));
        tiles.extend(views.iter().map(|view| codec::downscale(view, tile_width)));
    }
    let (width, height) = (tiles[0].width(), tiles[0].height());
    let sheet = Rgb8::from_fn(5 * width, FAMILIES.len() * height, |x, y| {
        tiles[y / height * 5 + x / width].at(x % width, y % height)
    });
    std::fs::write(path, codec::encode_png(&Raster::from(sheet))?)?;
    Ok(())
}

/// Distinct colours for small numbers; 0 is black.
fn hue(number: u32) -> [u8; 3] {
    if number == 0 {
        return [0; 3];
    }
    [0x9e37_79b1u32, 0x85eb_ca77, 0xc2b2_ae3d]
        .map(|prime| 55 + (number.wrapping_mul(prime) >> 24) as u8 % 200)
}
