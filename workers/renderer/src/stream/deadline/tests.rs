use optics::plan::StageId;

use super::*;

/// A frame with attenuation, and with shadows of lamps if they take some time.
fn planned(water_ms: f64, lamps_ms: f64, total_ms: f64) -> PlannedFrame {
    let cost = |id, ms| StageCost { id, ms };
    let mut costs = vec![cost(StageId::Attenuation, 6.0), cost(StageId::Lamps, 4.0)];
    if lamps_ms > 20.0 {
        costs.push(cost(StageId::LampShadows, 10.0));
    }
    let timings = [
        ("water", water_ms),
        ("lamps", lamps_ms),
        ("encode", 3.0),
        ("total", total_ms),
    ];
    PlannedFrame {
        frame: StreamFrame {
            artifacts: Vec::new(),
            record: FrameRecord {
                timings_ms: timings.map(|(name, ms)| (name.to_owned(), ms)).into(),
                ..FrameRecord::default()
            },
            elapsed_ms: total_ms,
        },
        costs,
    }
}

/// Factors: water 2, lamps 1, their shadows 30. 6 ms are not planned.
fn calibration() -> Calibration {
    Calibration {
        cheap: vec![
            planned(13.0, 4.0, 23.0),
            planned(12.0, 4.5, 22.5),
            planned(12.0, 4.0, 22.0),
        ],
        full: vec![planned(12.0, 304.0, 322.0), planned(14.0, 310.0, 330.0)],
    }
}

#[test]
fn each_timing_has_its_own_factor_and_effects_have_another() {
    let model = CostModel::new(66.0, &calibration());
    let factors = [
        StageId::Attenuation,
        StageId::ForwardScatter(1),
        StageId::Lamps,
        StageId::LampShadows,
        StageId::Haze,
    ]
    .map(|stage| model.scale().factor(stage));
    assert_eq!(factors, [2.0, 2.0, 1.0, 30.0, 1.0]);
}

#[test]
fn a_budget_is_the_rest_of_the_deadline() {
    let model = CostModel::new(66.0, &calibration());
    let (width, height) = SIZE;
    assert!((model.budget_ms((width, height)) - 60.0).abs() < 1e-9);
    assert!((model.budget_ms((width, 2 * height)) - 54.0).abs() < 1e-9);
    assert_eq!(model.budget_ms((width, 100 * height)), LEAST_MS);
}

#[test]
fn a_frame_that_will_be_late_says_so_in_terms_of_the_deadline() {
    let warn = |deadline_ms: f64| {
        let PlannedFrame { frame, costs } = planned(0.0, 0.0, 0.0);
        let mut record = frame.record;
        record.warnings = vec!["`fidelity.budget_ms` is 3, but …".to_owned(), "kept".to_owned()];
        CostModel::new(deadline_ms, &calibration()).correct_warnings(&mut record, &costs, SIZE);
        record.warnings
    };
    assert_eq!(warn(22.1), ["kept"]);
    let late = "`deadline_ms` is 21, but the cheapest plan is expected to take 22.0 ms; raise it or make the picture smaller";
    assert_eq!(warn(21.0), ["kept", late]);
}

#[test]
fn without_calibration_costs_are_unchanged() {
    let none = Calibration {
        cheap: Vec::new(),
        full: Vec::new(),
    };
    let model = CostModel::new(40.0, &none);
    assert_eq!(*model.scale(), CostScale::default());
    assert_eq!(model.budget_ms(SIZE), 40.0);
}
