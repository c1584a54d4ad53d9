//! `gonio explore`: the explorer's page in the browser, from this program alone.

mod request;
mod response;
mod server;
mod site;

use super::failure::Failure;
use super::progress;
use super::terminal::{note, print, warn};
use site::Site;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;
use std::time::Duration;

/// Always the same, so that links and what a browser has stored for offline use stay.
const PORT: u16 = 8464;
/// How often it is looked whether Ctrl-C was pressed.
const LOOK_EVERY: Duration = Duration::from_millis(50);

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio explore                                   in the browser, at http://127.0.0.1:8464/\n  \
    gonio explore --port 0 --no-open                any free port; prints the address\n  \
    gonio explore --site web/dist                   a page that was just built\n\n\
    Serves to this machine alone (127.0.0.1), until Ctrl-C. Nothing is asked of any other server, and files that are dropped on the page\n\
    stay in the browser.")]
pub(super) struct Arguments {
    /// The port; 0 takes any that is free
    #[arg(long, value_name = "N", default_value_t = PORT)]
    port: u16,
    /// Only serve: open no browser
    #[arg(long)]
    no_open: bool,
    /// Serve the page in this folder instead of the one in this program
    #[arg(long, value_name = "FOLDER")]
    site: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let site = match &arguments.site {
        Some(folder) => Site::read(folder)?,
        None => Site::embedded()?,
    };
    let (listener, port) = listen(arguments.port)?;
    let address = format!("http://127.0.0.1:{port}/");
    progress::listen();
    server::start(listener, port, site)
        .map_err(|e| Failure::input(format!("no thread can be started: {e}")))?;
    print(&address)?;
    note("Ctrl-C ends it");
    if !arguments.no_open
        && let Err(e) = open::that_detached(&address)
    {
        warn(&format!("no browser could be opened ({e}): open {address}"));
    }
    while !progress::stop_requested() {
        std::thread::sleep(LOOK_EVERY);
    }
    Ok(())
}

/// A listener on this machine's own address, and its port.
fn listen(port: u16) -> Result<(TcpListener, u16), Failure> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|e| match e.kind() {
        ErrorKind::AddrInUse => Failure::input(format!(
            "port {port} of 127.0.0.1 is taken: a program listens there"
        ))
        .with_help(format!(
            "if that is an explorer, open http://127.0.0.1:{port}/; --port 0 takes any free port"
        )),
        ErrorKind::PermissionDenied => {
            Failure::input(format!("port {port} of 127.0.0.1 needs more rights"))
                .with_help("take a port from 1024 on, or --port 0 for any free one")
        }
        _ => Failure::input(format!("port {port} of 127.0.0.1: cannot listen: {e}"))
            .with_help("--port 0 takes any free port"),
    })?;
    let port = listener
        .local_addr()
        .map_err(|e| Failure::input(format!("the port that was taken can't be told: {e}")))?
        .port();
    Ok((listener, port))
}
