//! Ctrl-C (and a polite request to terminate): the first one stops the render, whose image is
//! still written; the second one ends the process at once. Before the render there is nothing to
//! keep, and the first one ends it.

use crate::cli::failure::Failure;
#[cfg(unix)]
use crate::cli::system;
use huygens::film::output::abandon_writes;
use huygens::wave::Control;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// The watch over the signals of this process.
pub(crate) struct Interrupts {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    control: Control,
    rendering: AtomicBool,
    received: AtomicU32,
}

impl Interrupts {
    /// Starts to watch.
    pub(crate) fn watch() -> Result<Self, Failure> {
        let shared = Arc::new(Shared::default());
        let handler = Arc::clone(&shared);
        // Installing the handler would undo `nohup`.
        #[cfg(unix)]
        let ignored = system::ignored_signals();
        ctrlc::set_handler(move || handler.receive())
            .map_err(|e| Failure::Other(miette::miette!("cannot watch for interrupts: {e}")))?;
        #[cfg(unix)]
        system::ignore_signals(&ignored);
        Ok(Self { shared })
    }

    /// From now on there is something worth keeping. The control to render with, which an interrupt
    /// stops.
    pub(crate) fn rendering(&self) -> &Control {
        self.shared.rendering.store(true, Ordering::SeqCst);
        &self.shared.control
    }

    /// Whether there was an interrupt.
    pub(crate) fn received(&self) -> bool {
        self.shared.received.load(Ordering::SeqCst) > 0
    }
}

impl Shared {
    fn receive(&self) {
        let before = self.received.fetch_add(1, Ordering::SeqCst);
        self.control.stop.store(true, Ordering::SeqCst);
        if before > 0 || !self.rendering.load(Ordering::SeqCst) {
            abandon_writes();
            let failure = Failure::Interrupted("nothing more is written".to_owned());
            failure.print();
            std::process::exit(failure.code().into());
        }
    }
}
