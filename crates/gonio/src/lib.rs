//! A reflectance laboratory and reference renderer
