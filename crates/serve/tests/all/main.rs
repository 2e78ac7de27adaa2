//! Folders that are served, asked over a socket as a browser does.

mod client;
mod results;

mod live;
mod pages;
mod refused;
mod robust;
