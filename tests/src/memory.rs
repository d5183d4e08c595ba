//! What a process holds in memory.

use crate::Service;

impl Service {
    /// Of the service's own process.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Resident bytes of the service's own process, without its workers.
    ///
    /// # Panics
    /// When the process is gone or the system does not tell.
    #[must_use]
    pub fn resident_bytes(&self) -> u64 {
        let path = format!("/proc/{}/status", self.child.id());
        let status = std::fs::read_to_string(path).expect("the process is there");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kib = line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
        kib.expect("its resident size") << 10
    }
}
