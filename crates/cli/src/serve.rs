//! `crosshead serve`: the pages of a folder in a browser, live while the folder grows.

use crate::output::hint;
use crate::{Failure, interrupt};
use ::serve::Server;
use clap::Args;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  crosshead serve datasets
  crosshead serve datasets/bearing-faults --port 0

The address that is printed leads to a list of what is in the folder, up to four folders deep:
datasets, calibrations, wear, explanations, and sweeps under way. Each has its pages, as crosshead
report writes them. A sweep under way shows its progress and its failed cases, and cases of a
dataset are simulated again when they are looked at. List and progress follow the files.

Only programs on this machine reach the address, and nothing is written. Ctrl-C ends it.

Exit status: 130 ended by Ctrl-C, SIGTERM or SIGHUP; 1 the port is in use; 2 no such folder.")]
pub struct Arguments {
    /// Folder of results, or one that holds such folders
    dir: PathBuf,
    /// Port of the address; 0 is any that is free
    #[arg(long, value_name = "N", default_value_t = 8723)]
    port: u16,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stop = interrupt::flag()?;
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, arguments.port));
    let server = Server::bind(&arguments.dir, address)?;
    println!("http://{}/", server.address());
    hint(format_args!(
        "open the address in a browser; Ctrl-C ends the server"
    ));
    server.run(Arc::clone(&stop))?;
    let dir = arguments.dir.display();
    Err(Failure::interrupted(format!(
        "interrupted: {dir} is no longer served"
    )))
}
