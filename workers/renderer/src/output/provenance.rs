//! Code version and CPU features recorded with a frame.

/// Version of the code.
pub const CODE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// The CPU features that choose code paths, joined by commas. Machines with the same list give the same bytes.
#[must_use]
pub fn cpu_features() -> String {
    #[cfg(target_arch = "x86_64")]
    let features = [
        ("sse4.1", is_x86_feature_detected!("sse4.1")),
        ("avx", is_x86_feature_detected!("avx")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let features = [(std::env::consts::ARCH, true)];
    let detected = features.iter().filter(|(_, is_there)| *is_there);
    let names: Vec<&str> = detected.map(|(name, _)| *name).collect();
    names.join(",")
}
