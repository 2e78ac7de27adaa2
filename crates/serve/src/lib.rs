//! The pages of a folder over HTTP on the loopback address, live while the folder grows.
//!
//! [`Server::bind`] takes a folder and an address, [`Server::run`] a flag that ends it. Pages are made in memory by
//! [`report`] from the files of the folder, and kept until these change. Nothing is written.
//!
//! | address | what |
//! |---|---|
//! | `/`, `/index.json` | what is in the folder |
//! | `/PATH/report.html`, `chaos.html`, `features.html`, `figures/NAME.svg` | the pages of a result and their figures |
//! | `/PATH/progress.html`, `progress.json` | a sweep under way |
//! | `/PATH/cases/CASE.html` | a case of a dataset, simulated again: a fragment for its page |
//!
//! `PATH` is that of the folder of a result; the folder that is served has none.

mod answer;
mod connections;
mod guard;
mod index;
mod kept;
mod pages;
mod place;
mod policy;
mod site;

pub use connections::Server;

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Why a folder is not served.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is no folder at the place.
    #[error("{}: {error}; expected a folder", folder.display())]
    NoFolder {
        /// The place.
        folder: PathBuf,
        /// Why not.
        error: io::Error,
    },
    /// An address that other machines reach.
    #[error("{0}: expected an address of this machine alone, as 127.0.0.1:8723")]
    NotLoopback(SocketAddr),
    /// Another program listens there.
    #[error("{0} is in use by another program: choose another port, or 0 for any that is free")]
    InUse(SocketAddr),
    /// The address cannot be listened at, or no connection be taken.
    #[error("{address}: {error}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// Why not.
        error: io::Error,
    },
}

impl Error {
    /// Whether the input is wrong; else the work failed.
    pub fn is_input(&self) -> bool {
        matches!(self, Self::NoFolder { .. } | Self::NotLoopback(_))
    }
}
