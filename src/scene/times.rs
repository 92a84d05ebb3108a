//! Whether a timestep fits a duration: the file's, and what flags put in its place.

use super::limits;

/// Why a timestep and a duration do not go together.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct TimesError {
    /// What was expected and what was found.
    pub message: String,
    /// What to do.
    pub help: &'static str,
}

/// At least one step, and not more than a run can take; both in seconds.
///
/// # Errors
/// [`TimesError`], also for what is not finite or not positive.
pub fn check_times(timestep: f64, duration: f64) -> Result<(), TimesError> {
    let refuse = |message, help| Err(TimesError { message, help });
    for (what, seconds, limit) in [
        ("a timestep", timestep, limits::TIMESTEP),
        ("a duration", duration, limits::DURATION),
    ] {
        if !(limit.low..=limit.high).contains(&seconds) {
            let message = format!("expected {what} of positive seconds, found {seconds:?}");
            return refuse(message, "");
        }
    }
    if timestep > duration {
        let message = format!("expected at most the duration ({duration:?} s), found {timestep:?}");
        return refuse(
            message,
            "the duration is 5 s unless `duration` says otherwise",
        );
    }
    if duration / timestep > limits::STEPS {
        let message = format!(
            "expected at most {:e} steps in {duration:e} s, found {timestep:e} s a step",
            limits::STEPS
        );
        return refuse(message, "take larger steps or a shorter `duration`");
    }
    Ok(())
}
