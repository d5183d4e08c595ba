//! The machine of the measurements.

/// Processor, cores and version in one line, for the footer of measured figures.
pub(crate) fn describe() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or("unknown processor", |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let s = if cores == 1 { "" } else { "s" };
    format!(
        "{model}, {cores} core{s}, {}, fathom {}",
        renderer::cpu_features(),
        env!("CARGO_PKG_VERSION")
    )
}
