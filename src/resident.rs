//! Memory that this process has resident, where the system tells (Linux, by `/proc/self`), to some
//! hundred kilobytes.

/// Bytes resident now.
#[must_use]
pub fn now() -> Option<u64> {
    field("VmRSS:")
}

/// The most bytes resident since the process began, or since [`forget_peak`].
#[must_use]
pub fn peak() -> Option<u64> {
    field("VmHWM:")
}

/// Lets [`peak`] begin anew. Returns whether the system does that.
#[must_use]
pub fn forget_peak() -> bool {
    // proc(5): 5 sets the high water mark to what is resident.
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// Gives memory that was freed, and is kept for reuse, back to the system where it can be: what is made
/// next then shows all of what it takes.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: malloc_trim may be called at any time and from any thread; it touches no memory in use.
    unsafe {
        libc::malloc_trim(0);
    }
}

fn field(name: &str) -> Option<u64> {
    parse(&std::fs::read_to_string("/proc/self/status").ok()?, name)
}

/// The bytes of a line such as `VmRSS:     1234 kB`.
fn parse(status: &str, name: &str) -> Option<u64> {
    let mut lines = status.lines();
    let value = lines.find_map(|l| l.strip_prefix(name))?;
    let kilobytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_the_status_is_read() {
        let status = "Name:\thuygens\nVmHWM:\t    2048 kB\nVmRSS:\t    1024 kB\n";
        assert_eq!(parse(status, "VmRSS:"), Some(1 << 20));
        assert_eq!(parse(status, "VmSwap:"), None);
        assert_eq!(parse("VmRSS: many kB\n", "VmRSS:"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_was_touched_and_given_back_is_the_peak() {
        if !forget_peak() {
            eprintln!("SKIPPED: the system does not let the peak begin anew");
            return;
        }
        let before = now().expect("Linux tells");
        let block = vec![1u8; 64 << 20];
        assert_eq!(block.iter().map(|&b| u64::from(b)).sum::<u64>(), 64 << 20);
        drop(block);
        give_back();
        // Other tests of this process may give memory back meanwhile, but not so much.
        assert!(peak().expect("Linux tells") >= before + (32 << 20));
    }
}
