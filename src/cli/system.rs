//! What the operating system knows about this process.

/// The most memory this process has had resident so far, in bytes, where the system tells.
pub(crate) fn peak_memory() -> Option<u64> {
    #[cfg(unix)]
    {
        let mut usage = std::mem::MaybeUninit::<libc::rusage>::zeroed();
        // SAFETY: `usage` is valid for writes of a `rusage`, which is all that getrusage writes;
        // a `rusage` is plain numbers, for which zero is a valid value in any case.
        let usage = unsafe {
            (libc::getrusage(libc::RUSAGE_SELF, usage.as_mut_ptr()) == 0)
                .then(|| usage.assume_init())
        }?;
        // Kilobytes everywhere but on Apple's systems.
        let unit = if cfg!(target_vendor = "apple") {
            1
        } else {
            1024
        };
        u64::try_from(usage.ru_maxrss).ok().map(|n| n * unit)
    }
    #[cfg(not(unix))]
    None
}

/// The processor's name, where the system tells.
pub(crate) fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Memory of this machine in bytes, where the system tells.
pub(crate) fn physical_memory() -> Option<u64> {
    #[cfg(unix)]
    {
        // SAFETY: sysconf takes a number, gives a number, and touches no memory of ours.
        let [pages, size] = unsafe {
            [
                libc::sysconf(libc::_SC_PHYS_PAGES),
                libc::sysconf(libc::_SC_PAGESIZE),
            ]
        };
        let known = |n: libc::c_long| u64::try_from(n).ok().filter(|&n| n > 0);
        Some(known(pages)?.saturating_mul(known(size)?))
    }
    #[cfg(not(unix))]
    None
}

/// The signals to end that this process was started to ignore, as `nohup` and shells without job
/// control do.
#[cfg(unix)]
pub(crate) fn ignored_signals() -> Vec<libc::c_int> {
    let ignored = |&signal: &libc::c_int| {
        let mut action = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
        // SAFETY: with a null new action, sigaction changes nothing and writes the old one to
        // `action`, which is valid for that; it is read only if that was done.
        unsafe {
            libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr()) == 0
                && action.assume_init().sa_sigaction == libc::SIG_IGN
        }
    };
    let all = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];
    all.into_iter().filter(|signal| ignored(signal)).collect()
}

/// Ignores these signals from now on.
#[cfg(unix)]
pub(crate) fn ignore_signals(signals: &[libc::c_int]) {
    for &signal in signals {
        // SAFETY: SIG_IGN runs no code of ours, so there is nothing that a signal could interrupt
        // unsoundly.
        unsafe { libc::signal(signal, libc::SIG_IGN) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn peak_memory_grows_with_what_is_touched() {
        let before = peak_memory().expect("unix tells");
        let block = vec![1u8; 64 << 20];
        assert!(block.iter().map(|&b| u64::from(b)).sum::<u64>() == 64 << 20);
        let after = peak_memory().expect("unix tells");
        assert!(after >= 64 << 20 && after >= before, "{before} to {after}");
    }

    #[cfg(unix)]
    #[test]
    fn physical_memory_is_at_least_what_was_used() {
        assert!(physical_memory().expect("unix tells") >= peak_memory().expect("unix tells"));
    }
}
