//! One file for each command.

mod airlight;
mod bench;
mod camera;
mod campaign;
mod chart;
mod figure;
mod ibla;
mod ladder;
mod look;
mod scene_sheets;
mod stability;
mod suspended;
mod table1;
mod training_scores;
mod truth;
mod truth_lamps;
mod waters;

use cli::exit::Failure;

/// The subcommands of `fathom-lab`.
#[derive(clap::Subcommand)]
pub(crate) enum Command {
    /// Draw error against time of the variants of each stage
    Chart(chart::Arguments),
    /// Compare random frames with the bounds of their plans
    Campaign(campaign::Arguments),
    /// Show the change by each published effect in a water
    Ladder(ladder::Arguments),
    /// Map where methods fail
    Stability(stability::Arguments),
    /// Compare the enhancement methods over a folder of pictures or a dataset
    Table1(table1::Arguments),
    /// Measure how often the faster variants of IBLA find the light of the exact one, and how far their results differ
    Ibla(ibla::Arguments),
    /// Draw the steps of the chain and the style waters for one scene
    Figure(figure::Arguments),
    /// Draw the waters: transmittance, grey cards, one wall and every scene family in several waters
    Waters(waters::Arguments),
    /// Draw the airlight of lamps, with few to many nodes per ray
    Airlight(airlight::Arguments),
    /// Draw one frame with several cameras
    Camera(camera::Arguments),
    /// Draw frames with snow and turbidity
    Suspended(suspended::Arguments),
    /// Compare the frames of jobs with the look of underwater photographs
    Look(look::Arguments),
    /// Draw many seeds of a scene family, or the labels of every family
    Scenes(scene_sheets::Arguments),
    /// Score a trained style over several sets of new scenes
    TrainingScores(training_scores::Arguments),
    /// Trace a frame of a job by Monte Carlo and compare it with the chain
    Truth(truth::Arguments),
    /// Compare the light of lamps in six waters with Monte Carlo
    TruthLamps(truth_lamps::Arguments),
    /// Measure how fast rendering and the service are on this machine
    Bench(bench::Arguments),
}

impl Command {
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self {
            Self::Chart(arguments) => chart::run(&arguments),
            Self::Campaign(arguments) => campaign::run(&arguments),
            Self::Ladder(arguments) => ladder::run(&arguments),
            Self::Stability(arguments) => stability::run(&arguments),
            Self::Table1(arguments) => table1::run(&arguments),
            Self::Ibla(arguments) => ibla::run(&arguments),
            Self::Figure(arguments) => figure::run(&arguments),
            Self::Waters(arguments) => waters::run(&arguments),
            Self::Airlight(arguments) => airlight::run(&arguments),
            Self::Camera(arguments) => camera::run(&arguments),
            Self::Suspended(arguments) => suspended::run(&arguments),
            Self::Look(arguments) => look::run(&arguments),
            Self::Scenes(arguments) => scene_sheets::run(&arguments),
            Self::TrainingScores(arguments) => training_scores::run(&arguments),
            Self::Truth(arguments) => truth::run(&arguments),
            Self::TruthLamps(arguments) => truth_lamps::run(&arguments),
            Self::Bench(arguments) => bench::run(&arguments),
        }
    }
}
