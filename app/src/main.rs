//! The lumenscope program.

use std::process::ExitCode;

fn main() -> ExitCode {
    match lumenscope::cli::run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lumenscope: {error:#}");
            ExitCode::FAILURE
        }
    }
}
