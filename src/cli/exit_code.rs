//! The exit codes of the program.

use std::io::Write;
use std::process::ExitCode;

/// Exit codes, for the help; 2 is that of the parser of the command line.
pub const HELP: &str = "\
Exit codes:
  0  success: the output is complete
  1  a file, a scene or an argument is invalid, or a sample failed
  2  the command line cannot be parsed
  3  a state is not at rest: everything is measured, but there is no phase and no fit";

/// Exit code if states are not at rest.
const NOT_AT_REST: u8 = 3;

/// Ends a command with results; the samples named in `not_at_rest` have no phase and no fit.
pub fn of_states(not_at_rest: &[String]) -> ExitCode {
    if not_at_rest.is_empty() {
        return ExitCode::SUCCESS;
    }
    // The standard error stream may be closed: the exit code contains the same information.
    let _ = writeln!(
        std::io::stderr(),
        "jamscope: no phase and no fit, because these are not at rest: {}; --not-at-rest overrides this",
        not_at_rest.join(", ")
    );
    ExitCode::from(NOT_AT_REST)
}

/// Ends a command that relaxed one packing, which may not be at rest.
pub fn of_relaxation(not_at_rest: Option<String>) -> ExitCode {
    let Some(name) = not_at_rest else { return ExitCode::SUCCESS };
    let _ = writeln!(std::io::stderr(), "jamscope: not at rest: {name}; the state is written as it is");
    ExitCode::from(NOT_AT_REST)
}
