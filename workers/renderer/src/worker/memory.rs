//! Memory used by this process, and memory available to it: that of the machine, or of its container if smaller.

use std::fs;
use std::path::{Path, PathBuf};

/// Mount point of control groups.
const CGROUPS: &str = "/sys/fs/cgroup";

/// Resident memory of this process, if the system reports it.
pub(crate) fn resident_bytes() -> Option<u64> {
    kib_of(&fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// Total memory of the machine or, in a container with a limit, that limit. Other processes share it.
#[must_use]
pub fn available_bytes() -> Option<u64> {
    let machine = fs::read_to_string("/proc/meminfo")
        .ok()
        .and_then(|text| kib_of(&text, "MemTotal:"));
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    machine
        .into_iter()
        .chain(group_limit(Path::new(CGROUPS), &groups))
        .min()
}

/// The lowest limit of the control groups named in `groups` (the text of /proc/self/cgroup) and of the groups above
/// them. Version 2 has one tree and `max` for no limit; version 1 has a tree per resource and a number near 2^63.
fn group_limit(root: &Path, groups: &str) -> Option<u64> {
    let mut limits = Vec::new();
    for line in groups.lines() {
        let mut parts = line.splitn(3, ':');
        let (Some(_), Some(controllers), Some(path)) = (parts.next(), parts.next(), parts.next()) else {
            continue;
        };
        let (tree, file) = match controllers {
            "" => (root.to_owned(), "memory.max"),
            list if list.split(',').any(|name| name == "memory") => {
                (root.join("memory"), "memory.limit_in_bytes")
            }
            _ => continue,
        };
        // Inside a container the path may be the host's; then only the root of the tree exists.
        let inside: PathBuf = tree.join(path.trim_start_matches('/'));
        let folders = inside.ancestors().take_while(|folder| folder.starts_with(&tree));
        limits.extend(
            folders
                .filter_map(|folder| fs::read_to_string(folder.join(file)).ok())
                .filter_map(|text| text.trim().parse::<u64>().ok()),
        );
    }
    limits.into_iter().min()
}

/// The value of a line such as `VmRSS:   1234 kB`, in bytes.
fn kib_of(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace()
        .next()?
        .parse::<u64>()
        .ok()
        .map(|kib| kib << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(root: &Path, file: &str, text: &str) {
        let path = root.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    #[test]
    fn memory_is_read_as_the_system_writes_it() {
        assert_eq!(
            kib_of("VmPeak:\t 9 kB\nVmRSS:\t    2048 kB\n", "VmRSS:"),
            Some(2 << 20)
        );
        assert_eq!(kib_of("VmPeak:\t 9 kB\n", "VmRSS:"), None);
        assert!(
            resident_bytes().unwrap() > 1 << 20 && available_bytes().unwrap() > resident_bytes().unwrap()
        );
    }

    #[test]
    fn the_lowest_limit_of_a_group_and_those_above_it_counts() {
        let root = tempfile::tempdir().unwrap();
        write(root.path(), "a/memory.max", "4096\n");
        write(root.path(), "a/b/memory.max", "max\n");
        write(root.path(), "a/b/c/memory.max", "8192\n");
        assert_eq!(group_limit(root.path(), "0::/a/b/c\n"), Some(4096));
        assert_eq!(group_limit(root.path(), "0::/x\n"), None);
        assert_eq!(group_limit(root.path(), "nonsense\n"), None);
    }

    #[test]
    fn the_older_trees_are_read_too_and_a_path_of_the_host_falls_back_to_the_root() {
        let root = tempfile::tempdir().unwrap();
        write(root.path(), "memory/memory.limit_in_bytes", "1048576\n");
        write(
            root.path(),
            "memory/here/memory.limit_in_bytes",
            "9223372036854771712\n",
        );
        let groups = "9:name=systemd:/\n4:memory:/docker/44f1\n0::/\n";
        assert_eq!(group_limit(root.path(), groups), Some(1 << 20));
        assert_eq!(group_limit(root.path(), "4:cpu,memory:/here\n"), Some(1 << 20));
    }
}
