//! The picture while it is taken: a PNG that is replaced again and again, and the viewer tev.

use super::product::PictureArguments;
use crate::cli::destination;
use crate::cli::failure::{Failure, chain};
use crate::cli::terminal::warn;
use gonio_image::Image;
use gonio_render::Film;
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// Where the picture is shown while it is taken.
#[derive(clap::Args)]
pub(super) struct LiveArguments {
    /// Show the picture while it is taken in this PNG, which is replaced about once a second
    #[arg(long, value_name = "FILE.png")]
    preview: Option<PathBuf>,
    /// Show the picture while it is taken in the viewer tev, which listens on port 14158
    #[arg(long, value_name = "HOST:PORT")]
    tev: Option<String>,
}

/// The shortest time between two pictures.
const LEAST_PAUSE: Duration = Duration::from_secs(1);
/// Showing may take this share of the time: a pause is as many times longer than the picture before it took.
const PAUSES: u32 = 20;
/// A viewer that doesn't take data for this long is given up.
const PATIENCE: Duration = Duration::from_secs(5);
/// Pixels that are sent at a time.
const BLOCK: usize = 1 << 18;

/// Shows the picture.
pub(super) struct Live<'a> {
    preview: Option<&'a PathBuf>,
    tev: Option<Viewer>,
    how: &'a PictureArguments,
    next: Instant,
}

impl<'a> Live<'a> {
    /// Finds the viewer and looks at the file's place.
    pub fn new(
        arguments: &'a LiveArguments,
        how: &'a PictureArguments,
        title: &str,
        size: [u32; 2],
    ) -> Result<Self, Failure> {
        if let Some(path) = &arguments.preview {
            destination::check_extension(path, &["png"], "previews")?;
            destination::writable(path)?;
        }
        let tev = match &arguments.tev {
            None => None,
            Some(address) => Some(Viewer::find(address, title, size).map_err(|e| {
                let cause = chain(&e);
                Failure::input(format!("--tev {address}: no viewer answers: {cause}"))
                    .with_help("start tev first; it listens on 127.0.0.1:14158")
            })?),
        };
        Ok(Self {
            preview: arguments.preview.as_ref(),
            tev,
            how,
            next: Instant::now(),
        })
    }

    /// Shows the picture so far, if it is time. What can't be shown any more is told once: the rendering is worth more.
    pub fn update(&mut self, film: &Film) {
        let begun = Instant::now();
        if begun < self.next {
            return;
        }
        self.show(film);
        self.next = Instant::now() + LEAST_PAUSE.max(PAUSES * begun.elapsed());
    }

    /// Shows the picture.
    pub fn show(&mut self, film: &Film) {
        if self.preview.is_none() && self.tev.is_none() {
            return;
        }
        let image = self.how.shown(film);
        if let Some(path) = self.preview
            && let Err(e) = image.write_png(path, self.how.tone.tonemap, self.how.tone.exposure)
        {
            warn(&format!("the preview ends: {}", Failure::from(e).message()));
            self.preview = None;
        }
        if let Some(viewer) = &mut self.tev
            && let Err(e) = viewer.send(&image)
        {
            warn(&format!("the viewer is gone: {e}"));
            self.tev = None;
        }
    }
}

/// A picture in tev.
struct Viewer {
    client: TevClient,
    title: String,
}

impl Viewer {
    fn find(address: &str, title: &str, [width, height]: [u32; 2]) -> io::Result<Self> {
        let mut failed = io::Error::new(io::ErrorKind::InvalidInput, "expected HOST:PORT");
        for socket in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&socket, PATIENCE) {
                Err(e) => failed = e,
                Ok(stream) => {
                    stream.set_write_timeout(Some(PATIENCE))?;
                    let mut client = TevClient::wrap(stream);
                    client.send(PacketCreateImage {
                        image_name: title,
                        grab_focus: true,
                        width,
                        height,
                        channel_names: &["R", "G", "B"],
                    })?;
                    return Ok(Self {
                        client,
                        title: title.to_owned(),
                    });
                }
            }
        }
        Err(failed)
    }

    fn send(&mut self, image: &Image) -> io::Result<()> {
        let rows = (BLOCK / image.width).max(1);
        for (index, block) in image.pixels.chunks(rows * image.width).enumerate() {
            self.client.send(PacketUpdateImage {
                image_name: &self.title,
                grab_focus: false,
                channel_names: &["R", "G", "B"],
                channel_offsets: &[0, 1, 2],
                channel_strides: &[3, 3, 3],
                x: 0,
                y: (index * rows) as u32,
                width: image.width as u32,
                height: (block.len() / image.width) as u32,
                data: block.as_flattened(),
            })?;
        }
        Ok(())
    }
}
