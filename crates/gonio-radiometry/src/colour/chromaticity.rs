//! Chromaticity coordinates.

/// (x, y) of XYZ: x = X/(X+Y+Z), y = Y/(X+Y+Z). NaN for black.
pub fn xy_of_xyz(xyz: [f64; 3]) -> [f64; 2] {
    let sum = xyz[0] + xyz[1] + xyz[2];
    [xyz[0] / sum, xyz[1] / sum]
}

/// XYZ of the chromaticity (x, y) with Y = `luminance`. `y` isn't 0.
pub fn xyz_of_xyy(xy: [f64; 2], luminance: f64) -> [f64; 3] {
    let [x, y] = xy;
    let s = luminance / y;
    [x * s, luminance, (1.0 - x - y) * s]
}

/// XYZ of the chromaticity (x, y) with Y = 1, as of a white point.
pub fn xyz_of_xy(xy: [f64; 2]) -> [f64; 3] {
    xyz_of_xyy(xy, 1.0)
}

/// (u, v) of the CIE 1960 uniform chromaticity scale: u = 4X/(X + 15Y + 3Z), v = 6Y/(X + 15Y + 3Z). NaN for black.
pub fn uv_of_xyz(xyz: [f64; 3]) -> [f64; 2] {
    let d = xyz[0] + 15.0 * xyz[1] + 3.0 * xyz[2];
    [4.0 * xyz[0] / d, 6.0 * xyz[1] / d]
}
