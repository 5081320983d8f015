//! Tests on the simulated sessions that are shared beside the repository, not in it: run with `--ignored`, and the
//! environment variable
//! `CENTRICAL_SHARED` naming the folder that holds `data/`.

mod reduction;
mod session;
