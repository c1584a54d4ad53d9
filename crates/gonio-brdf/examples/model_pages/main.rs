//! Writes the book's pages about models, with their pictures: `cargo run -p gonio-brdf --example model_pages`.

// Found as the test of the book finds it, so that its own modules lie beside it.
#[path = "page.rs"]
mod page;

fn main() -> Result<(), String> {
    let folder = page::folder();
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, text) in page::pages()? {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("wrote {}", path.display());
    }
    Ok(())
}
