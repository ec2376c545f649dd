//! The lumenscope program.

use std::process::ExitCode;

fn main() -> ExitCode {
    match lumenscope::run_window(std::env::args_os().nth(1).map(Into::into)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lumenscope: {error:#}");
            ExitCode::FAILURE
        }
    }
}
