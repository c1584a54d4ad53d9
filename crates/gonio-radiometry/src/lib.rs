//! Radiometry: quantities and units, spectra and colour, directions, solid angles, quadrature, sampling
