//! With what a frame was made.

/// Version of the code.
pub const CODE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// The CPU features that choose code paths, joined by commas. Machines with the same list give the same bytes.
#[must_use]
pub fn cpu_features() -> String {
    detected()
        .into_iter()
        .filter(|(_, there)| *there)
        .map(|(name, _)| name)
        .collect::<Vec<_>>()
        .join(",")
}

#[cfg(target_arch = "x86_64")]
fn detected() -> Vec<(&'static str, bool)> {
    vec![
        ("sse4.1", is_x86_feature_detected!("sse4.1")),
        ("avx", is_x86_feature_detected!("avx")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ]
}

#[cfg(not(target_arch = "x86_64"))]
fn detected() -> Vec<(&'static str, bool)> {
    vec![(std::env::consts::ARCH, true)]
}
