//! Numbers in tables and pictures.

/// `x` with at most `digits` significant digits; with a power of ten where it is tiny or huge.
pub fn significant(x: f64, digits: usize) -> String {
    let rounded = format!("{x:.*e}", digits.saturating_sub(1));
    match rounded.parse::<f64>() {
        // Displayed with the fewest digits that give the same number.
        Ok(value) if value == 0.0 || (1e-4..1e6).contains(&value.abs()) => format!("{value}"),
        Ok(value) => format!("{value:e}"),
        Err(_) => rounded,
    }
}
