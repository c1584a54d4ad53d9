//! Pictures while they are taken.

use crate::support::{BALL, Place};
use std::io::Read;
use std::net::TcpListener;

#[test]
fn a_preview_ends_as_the_picture() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    let small = ["--size", "16x12", "--spp", "9"];
    let all = [
        &[
            "render",
            "ball.toml",
            "-o",
            "a.png",
            "--preview",
            "live.png",
        ],
        &small[..],
    ]
    .concat();
    place.good(&all);
    assert!(place.read("live.png") == place.read("a.png"));
    place.bad(
        &["render", "ball.toml", "--preview", "live.exr"],
        2,
        &["previews", ".png"],
    );
    place.bad(
        &["render", "ball.toml", "--preview", "none/live.png"],
        3,
        &["none"],
    );
}

/// Bytes of a packet of tev, taken from the front.
struct Packet<'a>(&'a [u8]);

impl Packet<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.0.split_first_chunk().unwrap();
        self.0 = rest;
        *first
    }
    fn number(&mut self) -> u32 {
        u32::from_le_bytes(self.bytes())
    }
    fn text(&mut self) -> String {
        let end = self.0.iter().position(|b| *b == 0).unwrap();
        let text = String::from_utf8(self.0[..end].to_vec()).unwrap();
        self.0 = &self.0[end + 1..];
        text
    }
    fn channels(&mut self) {
        assert_eq!(self.number(), 3);
        assert_eq!([self.text(), self.text(), self.text()], ["R", "G", "B"]);
    }
}

/// A viewer that takes what tev takes (operations 4, create, and 6, update): its last picture is the one that is written.
#[test]
fn tev_is_sent_the_picture() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let viewer = std::thread::spawn(move || {
        let mut all = Vec::new();
        listener.accept().unwrap().0.read_to_end(&mut all).unwrap();
        all
    });
    place.good(&[
        "render",
        "ball.toml",
        "--size",
        "16x12",
        "--spp",
        "9",
        "-o",
        "a.exr",
        "--tev",
        &address,
    ]);
    let all = viewer.join().unwrap();
    let mut picture = vec![f32::NAN; 16 * 12 * 3];
    let (mut rest, mut created) = (&all[..], false);
    while !rest.is_empty() {
        let length = u32::from_le_bytes(rest[..4].try_into().unwrap()) as usize;
        let mut packet = Packet(&rest[4..length]);
        rest = &rest[length..];
        let [operation, _focus] = packet.bytes();
        assert_eq!(packet.text(), "ball.toml");
        if operation == 4 {
            assert_eq!([packet.number(), packet.number()], [16, 12]);
            packet.channels();
            created = true;
            continue;
        }
        assert!(created && operation == 6);
        packet.channels();
        let [x, y, width, height] = [(); 4].map(|()| packet.number());
        assert_eq!((x, width), (0, 16));
        let layout = [(); 6].map(|()| u64::from_le_bytes(packet.bytes()));
        assert_eq!(layout, [0, 1, 2, 3, 3, 3]);
        let first = (y * 16 * 3) as usize;
        for value in &mut picture[first..first + (height * 16 * 3) as usize] {
            *value = f32::from_le_bytes(packet.bytes());
        }
        assert!(packet.0.is_empty());
    }
    assert_eq!(picture, place.image("a.exr").pixels.as_flattened());
}

#[test]
fn a_viewer_that_is_not_there_is_an_error() {
    let place = Place::new();
    place.write("ball.toml", BALL);
    // A port that was free a moment ago.
    let address = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .to_string();
    place.bad(
        &["render", "ball.toml", "-q", "--tev", &address],
        3,
        &["no viewer answers"],
    );
    place.bad(
        &["render", "ball.toml", "-q", "--tev", "nowhere"],
        3,
        &["--tev nowhere"],
    );
}
