//! Paths of all channels against paths of each.

use imaging::vector::vec3;
use truth::{Address, Lambertian, Phase, SphereLamp, TurbidityField, WaterLayers};

use crate::support::{Mean, Solids, TestSolid, along, lamp, scene, water};

#[test]
fn a_path_of_all_channels_has_the_means_of_three() {
    compare_channels(TurbidityField::Even, lamp([0.4, 0.0, 0.0], 1.0));
}

#[test]
fn a_path_of_all_channels_has_the_means_of_three_in_layers_under_a_spot() {
    let layers = TurbidityField::Layers(WaterLayers {
        up: vec3(0.0, -1.0, 0.0),
        depth_m: 3.0,
        edges_m: vec![2.9, 3.2],
        factors: vec![0.5, 1.5, 1.0],
    });
    let spot = SphereLamp {
        beam: Some((vec3(-0.1f64, 0.0, 1.0).normalized(), 35f64.to_radians().cos())),
        disc_m: 0.02,
        ..lamp([0.4, 0.0, 0.0], 1.0)
    };
    compare_channels(layers, spot);
}

/// Checks that paths of all channels have the means of paths of each.
fn compare_channels(turbidity: TurbidityField, lamp: SphereLamp) {
    let solids = Solids(vec![TestSolid::Wall(2.0)]);
    let mut scene = scene(
        &solids,
        vec![Lambertian::gray(0.6)],
        water(0.2, 0.4),
        Phase::henyey_greenstein(0.8),
    );
    scene.water = [water(0.5, 0.35), water(0.2, 0.4), water(0.25, 0.45)];
    scene.lamps = vec![lamp];
    scene.turbidity = turbidity;
    let ray = along([0.1, 0.0, 1.0]);
    let paths = 30_000u64;
    for channel in 0..3u64 {
        let measure = |shared: bool| {
            let mut batches = [0.0; 30];
            for sample in 0..paths {
                let address = Address {
                    frame: 0,
                    pixel: 0,
                    sample,
                    channel,
                };
                let stream = truth::stream(4);
                let light: f64 = if shared {
                    let tally = scene.trace_shared(ray, stream, address);
                    tally.orders.iter().map(|order| order[channel as usize]).sum()
                } else {
                    scene.trace(ray, stream, address).orders.iter().flatten().sum()
                };
                batches[(sample % 30) as usize] += light * 30.0 / paths as f64;
            }
            Mean::from_batches(&batches)
        };
        let (shared, single) = (measure(true), measure(false));
        shared.agrees(single.mean, single.error, &format!("channel {channel}"));
        assert!(single.error < 0.05 * single.mean, "{single:?}");
    }
}
