// Stopping on request: signals become a flag the time loop looks at.
#pragma once

namespace pileus {

/// Makes SIGINT, SIGTERM and SIGUSR1 (what batch systems send before the time is up) request a
/// stop. A second SIGINT, or a second SIGTERM more than half a second after the first, makes the
/// cursor visible again and ends the process at once, as the default action would: the way out of a
/// run that no longer looks at the flag. To be called once, from the main thread, before other
/// threads start.
void install_stop_signals();

/// Whether a stop was requested; callable from any thread.
bool stop_requested();

/// The signal that asked for the stop, or 0.
int stop_signal();

/// Requests a stop without a signal (0 clears the request).
void request_stop(int signal);

}  // namespace pileus
