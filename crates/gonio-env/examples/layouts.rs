//! Writes the labelled six-axis image in every layout and convention into a folder: LAYOUT.png, LAYOUT-CONVENTION.exr.

use gonio_env::{Convention, Layout, View, test_image};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or("usage: layouts FOLDER")?;
    std::fs::create_dir_all(&folder)?;
    for layout in Layout::ALL {
        // About as many texels in each.
        let rows = if layout.arrangement().is_some() {
            96
        } else {
            192
        };
        test_image::six_axes(layout, rows).write(&folder.join(format!("{layout}.png")))?;
        for convention in Convention::ALL {
            let image = test_image::six_axes_of(&View::new(layout, convention), rows);
            image.write(&folder.join(format!("{layout}-{convention}.exr")))?;
        }
    }
    Ok(())
}
