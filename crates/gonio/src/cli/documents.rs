//! The documents' command lines and scenes are what the command takes.

use super::{Arguments, Command, brdf};
use clap::Parser;
use gonio_brdf::ModelSpec;
use gonio_image::Image;
use gonio_scene::{LoadOptions, Scene};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The README, the contributor's guide, and every page of the book.
fn documents() -> Vec<(PathBuf, String)> {
    let mut paths = vec![root().join("README.md"), root().join("CONTRIBUTING.md")];
    let mut folders = vec![root().join("book/src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                paths.push(path);
            }
        }
    }
    paths
        .into_iter()
        .map(|path| {
            let text = std::fs::read_to_string(&path).unwrap();
            (path, text)
        })
        .collect()
}

/// The lines of the fenced blocks in a language.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut block: Option<(bool, String)> = None;
    for line in text.lines() {
        match (&mut block, line.strip_prefix("```")) {
            (None, Some(info)) => {
                block = Some((info.split(',').next() == Some(language), String::new()));
            }
            (Some(_), Some(_)) => {
                if let Some((true, lines)) = block.take() {
                    found.push(lines);
                }
                block = None;
            }
            (Some((_, lines)), None) => *lines += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    found
}

/// A line split as a shell does: single quotes keep what is in them, `#` after a space begins a comment.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    let mut before = ' ';
    for c in line.chars() {
        match c {
            '\'' => quoted = !quoted,
            '#' if !quoted && before == ' ' => break,
            ' ' if !quoted => words.push(String::new()),
            c => words.last_mut().unwrap().push(c),
        }
        before = c;
    }
    words.retain(|w| !w.is_empty());
    words
}

/// What is wrong with a command line, if anything.
fn fault(words: &[String]) -> Option<String> {
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(e) => return Some(e.to_string()),
    };
    if let Command::Brdf(brdf::Command::Plot(plot)) = &arguments.command {
        // The others are measured files.
        let models = plot
            .functions
            .iter()
            .filter(|text| !text.ends_with(".binary"));
        let mut faults = models.filter_map(|text| ModelSpec::parse(text).err());
        return faults.next().map(|e| e.to_string());
    }
    let spec = match &arguments.command {
        Command::Brdf(
            brdf::Command::Show { name: spec, .. }
            | brdf::Command::Eval { spec, .. }
            | brdf::Command::Check(brdf::check::Arguments {
                spec: Some(spec), ..
            })
            | brdf::Command::Export(brdf::export::Arguments { spec, .. }),
        ) if spec != "all" => spec,
        _ => return None,
    };
    // Files in examples are named from the root.
    ModelSpec::parse_in(spec, &root())
        .err()
        .map(|e| e.to_string())
}

#[test]
fn command_lines_of_the_documents_are_understood() {
    let mut count = 0;
    for (path, text) in documents() {
        for block in blocks(&text, "sh") {
            for line in block.lines() {
                let mut line = words(line);
                if line.starts_with(&["cargo".into(), "run".into(), "--release".into()]) {
                    line.drain(..3);
                    line[0] = "gonio".into();
                }
                if line.first().is_none_or(|word| word != "gonio") {
                    continue;
                }
                count += 1;
                let fault = fault(&line);
                assert!(fault.is_none(), "{}: {line:?}: {fault:?}", path.display());
            }
        }
    }
    assert!(count > 40, "{count} command lines are found");
}

#[test]
fn wrong_command_lines_are_noticed() {
    let wrong = [
        "gonio rendr",
        "gonio render --spp none",
        "gonio brdf check gxg",
    ];
    for line in wrong {
        assert!(fault(&words(line)).is_some(), "{line}");
    }
    assert_eq!(words("a 'b c'  d # e"), ["a", "b c", "d"]);
}

#[test]
fn scenes_of_the_documents_load() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["ball.glb", "sunset.hdr"] {
        let from = root().join("assets/preview").join(name);
        std::fs::copy(from, folder.path().join(name)).unwrap();
    }
    Image::filled(4, 4, [0.5; 3])
        .write(&folder.path().join("scratches.png"))
        .unwrap();
    let mut count = 0;
    for (path, text) in documents() {
        for block in blocks(&text, "toml") {
            count += 1;
            let scene = folder.path().join("scene.toml");
            std::fs::write(&scene, block).unwrap();
            if let Err(e) = Scene::load(&scene, &LoadOptions::default()) {
                panic!("{}: {e}", path.display());
            }
        }
    }
    assert!(count > 0, "no scene is found");
}
