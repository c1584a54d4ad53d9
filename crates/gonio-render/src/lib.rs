//! The reflection equation solved over a scene: integrators, film, radiometric sensors
