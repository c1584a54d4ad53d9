//! Environment maps: light from infinitely far away
