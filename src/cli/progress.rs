//! Progress on the standard error: hidden if that is no terminal, or on `--quiet`.

use crate::cli::text::si;
use huygens::wave::Control;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const TICK: Duration = Duration::from_millis(100);

/// Whether and where progress is shown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Progress {
    visible: bool,
}

impl Progress {
    pub(crate) fn new(quiet: bool) -> Self {
        Self {
            visible: !quiet && std::io::stderr().is_terminal(),
        }
    }

    /// Runs `work` under a spinner, and returns its result and its wall-clock seconds.
    pub(crate) fn phase<T>(self, label: &str, work: impl FnOnce() -> T) -> (T, f64) {
        let bar = self.bar(None, "{spinner} {msg} {elapsed}");
        bar.set_message(label.to_owned());
        if self.visible {
            bar.enable_steady_tick(TICK);
        }
        let start = Instant::now();
        let result = work();
        let seconds = start.elapsed().as_secs_f64();
        bar.finish_and_clear();
        (result, seconds)
    }

    /// Runs `work`, which goes through `all` bytes, under a bar that follows `done`, and returns its
    /// result and its wall-clock seconds.
    pub(crate) fn bytes<T>(
        self,
        label: &str,
        all: u64,
        done: impl Fn() -> u64 + Sync,
        work: impl FnOnce() -> T,
    ) -> (T, f64) {
        let start = Instant::now();
        let bar = self.bar(
            Some(all),
            "{msg} [{wide_bar}] {decimal_bytes} of {decimal_total_bytes} \
             {decimal_bytes_per_sec} ETA {eta}",
        );
        bar.set_message(label.to_owned());
        let result = self.watched(work, |finished| {
            while !finished.load(Ordering::Relaxed) {
                bar.set_position(done());
                std::thread::park_timeout(TICK);
            }
            bar.finish_and_clear();
        });
        (result, start.elapsed().as_secs_f64())
    }

    /// A bar for work that says itself how far it is: what is being done, and the share of all that
    /// is done. It goes when it is dropped.
    pub(crate) fn share(self) -> Share {
        let bar = self.bar(Some(1000), "[{wide_bar}] {percent:>3}% {msg} {elapsed}");
        if self.visible {
            bar.enable_steady_tick(TICK);
        }
        Share(bar)
    }

    /// Runs `render` while a thread shows how far `control` says it is.
    pub(crate) fn render<T>(self, asked: u64, control: &Control, render: impl FnOnce() -> T) -> T {
        if !self.visible {
            return render();
        }
        let bar = self.bar(
            Some(asked),
            "render [{wide_bar}] {percent:>3}% {msg} ETA {eta}",
        );
        self.watched(render, |finished| watch(&bar, control, finished))
    }

    /// Runs `work` while a thread runs `watch`, until its flag says that the work is finished. Only
    /// the work where nothing is shown.
    fn watched<T>(self, work: impl FnOnce() -> T, watch: impl FnOnce(&AtomicBool) + Send) -> T {
        if !self.visible {
            return work();
        }
        let finished = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let watcher = scope.spawn(|| watch(&finished));
            // On a panic too, or the scope would wait for the watcher for ever.
            let _finish = OnDrop(|| {
                finished.store(true, Ordering::Relaxed);
                watcher.thread().unpark();
            });
            work()
        })
    }

    fn bar(self, length: Option<u64>, template: &str) -> ProgressBar {
        let target = if self.visible {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let style = ProgressStyle::with_template(template).expect("a valid template");
        ProgressBar::with_draw_target(length, target).with_style(style.progress_chars("=> "))
    }
}

/// A bar that is told how far the work is.
pub(crate) struct Share(ProgressBar);

impl Share {
    /// Shows `what` is being done, and the share of all that is done.
    pub(crate) fn show(&self, what: &str, share: f64) {
        self.0.set_position((1000.0 * share.clamp(0.0, 1.0)) as u64);
        self.0.set_message(what.to_owned());
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

fn watch(bar: &ProgressBar, control: &Control, done: &AtomicBool) {
    let start = Instant::now();
    while !done.load(Ordering::Relaxed) {
        let samples = control.samples.load(Ordering::Relaxed);
        let rays = control.rays.load(Ordering::Relaxed);
        let seconds = start.elapsed().as_secs_f64();
        let rate = |n: u64| si(n as f64 / seconds.max(1e-9));
        bar.set_position(samples);
        let stopping = if control.stop.load(Ordering::Relaxed) {
            "stopping; "
        } else {
            ""
        };
        let message = format!("{stopping}{}samples/s {}rays/s", rate(samples), rate(rays));
        bar.set_message(message);
        std::thread::park_timeout(TICK);
    }
    bar.finish_and_clear();
}

struct OnDrop<F: FnMut()>(F);

impl<F: FnMut()> Drop for OnDrop<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_render_that_panics_under_a_bar_does_not_hang() {
        let progress = Progress { visible: true };
        let control = Control::default();
        let render = || progress.render(1, &control, || panic!("as asked"));
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(render));
        assert!(result.is_err());
    }
}
