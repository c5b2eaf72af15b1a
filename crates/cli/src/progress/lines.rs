//! Lines: progress in a log, one line in ten seconds at most.

use std::time::Duration;

/// Least time between two lines, and before the first.
const INTERVAL: Duration = Duration::from_secs(10);

/// A stage of a run.
#[derive(Debug, Default)]
struct Stage {
    name: String,
    done: u64,
    total: u64,
    /// Text to show with the progress.
    note: String,
    /// Time of its beginning; `None` until a time is known.
    begun: Option<Duration>,
}

/// The progress of a run. Times count from its beginning.
#[derive(Debug, Default)]
pub(super) struct Lines {
    stage: Option<Stage>,
    /// Time when the last line was due; zero before the first.
    last: Duration,
}

impl Lines {
    pub(super) fn begin(&mut self, stage: &str, total: u64) {
        self.stage = Some(Stage {
            name: stage.to_owned(),
            total,
            ..Stage::default()
        });
    }

    pub(super) fn advance(&mut self, steps: u64) {
        if let Some(stage) = &mut self.stage {
            stage.done += steps;
        }
    }

    pub(super) fn end(&mut self) {
        self.stage = None;
    }

    pub(super) fn note(&mut self, text: &str) {
        if let Some(stage) = &mut self.stage {
            text.clone_into(&mut stage.note);
        }
    }

    pub(super) fn expect(&mut self, total: u64) {
        if let Some(stage) = &mut self.stage {
            stage.total = total;
        }
    }

    /// The line to print at the time `now`, if one is due.
    pub(super) fn due(&mut self, now: Duration) -> Option<String> {
        let stage = self.stage.as_mut()?;
        let begun = *stage.begun.get_or_insert(now);
        if now.saturating_sub(self.last) < INTERVAL {
            return None;
        }
        self.last = now;
        Some(stage.line(now, now.saturating_sub(begun)))
    }
}

impl Stage {
    /// Line such as `progress: trace 25 %, 0:01:40 elapsed, 0:05:00 left`; `elapsed` is the time of the run, `of_stage` that of the stage.
    fn line(&self, elapsed: Duration, of_stage: Duration) -> String {
        let mut line = format!("progress: {}", self.name);
        let done = self.done.min(self.total) as f64 / self.total as f64;
        if done.is_finite() {
            line.push_str(&format!(" {:.0} %", (100.0 * done).floor()));
        }
        line.push_str(&format!(", {} elapsed", clock(elapsed)));
        if done > 0.0 && done < 1.0 {
            let left = of_stage.as_secs_f64() * (1.0 / done - 1.0);
            if let Ok(left) = Duration::try_from_secs_f64(left) {
                line.push_str(&format!(", {} left", clock(left)));
            }
        }
        if !self.note.is_empty() {
            line.push_str(&format!(" ({})", self.note));
        }
        line
    }
}

/// A time as hours, minutes and seconds.
fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    format!(
        "{}:{:02}:{:02}",
        seconds / 3600,
        seconds / 60 % 60,
        seconds % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of a run of `seconds` with a step per tenth of a second.
    fn lines_of(seconds: u64) -> Vec<(Duration, String)> {
        let mut lines = Lines::default();
        lines.begin("trace", 10 * seconds);
        let mut said = Vec::new();
        for step in 1..=10 * seconds {
            lines.advance(1);
            let now = Duration::from_millis(100 * step);
            said.extend(lines.due(now).map(|line| (now, line)));
        }
        said
    }

    #[test]
    fn a_run_below_ten_seconds_says_nothing() {
        assert_eq!(lines_of(9), []);
    }

    #[test]
    fn longer_runs_say_a_line_in_ten_seconds() {
        let said = lines_of(60);
        let times: Vec<u64> = said.iter().map(|(now, _)| now.as_secs()).collect();
        assert_eq!(times, [10, 20, 30, 40, 50, 60]);
        let (_, line) = &said[2];
        assert_eq!(line, "progress: trace 50 %, 0:00:30 elapsed, 0:00:29 left");
    }

    #[test]
    fn stages_share_the_interval_and_steps_may_be_rare() {
        let mut lines = Lines::default();
        let at = Duration::from_secs;
        assert_eq!(lines.due(at(50)), None, "no stage has begun");
        lines.begin("draw", 0);
        let first = lines.due(at(11)).unwrap();
        assert_eq!(first, "progress: draw, 0:00:11 elapsed");
        lines.end();
        lines.begin("trace", 4);
        assert_eq!(lines.due(at(15)), None);
        lines.expect(8);
        lines.advance(2);
        lines.note("s = 3");
        let second = lines.due(at(3615)).unwrap();
        assert_eq!(
            second,
            "progress: trace 25 %, 1:00:15 elapsed, 3:00:00 left (s = 3)"
        );
        lines.advance(20);
        let last = lines.due(at(3630)).unwrap();
        assert_eq!(last, "progress: trace 100 %, 1:00:30 elapsed (s = 3)");
    }
}
