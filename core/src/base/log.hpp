// The program's log: one sink, warnings and above unless asked for more.
#pragma once
#include <string_view>

namespace pileus {

enum class LogLevel { debug, info, warning, error };

/// Writes one record to standard error as "pileus: warning: text". Callable from any thread.
void log(LogLevel level, std::string_view text);

/// Records below `level` are dropped; the program starts with `warning`.
void set_log_level(LogLevel level);

}  // namespace pileus
