//! Prints what an environment is made of: `cargo run --example env_info -- panorama.hdr [layout]`.

use gonio_env::{EnvError, Environment, Layout, LoadOptions};

fn run() -> Result<(), EnvError> {
    let mut arguments = std::env::args().skip(1);
    let text = arguments.next().unwrap_or_else(|| "uniform:1".to_owned());
    let layout = arguments
        .next()
        .map(|name| name.parse::<Layout>())
        .transpose()?;
    let env = Environment::parse(
        &text,
        &LoadOptions {
            layout,
            ..LoadOptions::default()
        },
    )?;
    print!("{}", env.info());
    Ok(())
}

fn main() {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        if let Some(help) = error.help() {
            eprintln!("help: {help}");
        }
        std::process::exit(3);
    }
}
