//! Memory of a process.

use crate::Service;

impl Service {
    /// Process id of the service.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Resident bytes of the service's process, without its workers.
    ///
    /// # Panics
    /// If the process has ended or the system does not report it.
    #[must_use]
    pub fn resident_bytes(&self) -> u64 {
        let path = format!("/proc/{}/status", self.child.id());
        let status = std::fs::read_to_string(path).expect("the process is there");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kib = line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
        kib.expect("its resident size") << 10
    }
}
