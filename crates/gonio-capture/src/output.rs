//! What of a [`Capture`] goes into a file: the panorama with its layers, and what was found out as metadata.

use crate::CaptureError;
use crate::ball::Projection;
use crate::capture::{Capture, KnownLight, Options};
use gonio_image::{ChannelData, ImageError, Layers};
use std::path::Path;

impl Capture {
    /// What was found out, as names and values.
    pub fn metadata(&self) -> &[(String, String)] {
        &self.metadata
    }

    pub(crate) fn describe(&self, options: &Options) -> Vec<(String, String)> {
        let mut all: Vec<(String, String)> = Vec::new();
        let mut put = |name: String, value: String| all.push((name, value));
        put("layout".into(), "lat-long".into());
        put(
            "capture.response".into(),
            self.response.origin().to_string(),
        );
        put("capture.ball-material".into(), options.material.to_string());
        for (v, view) in self.views.iter().enumerate() {
            let name = |what: &str| format!("capture.view{}.{what}", v + 1);
            let ball = &view.outline.ball;
            let [x, y] = ball.centre();
            put(name("photo"), view.name.clone());
            put(name("ball"), format!("{x:.3},{y:.3},{:.3}", ball.radius()));
            put(name("outline-rms-px"), format!("{:.3}", view.outline.rms));
            put(
                name("outline-coverage"),
                format!("{:.3}", view.outline.coverage),
            );
            match ball.projection() {
                Projection::Orthographic => put(name("projection"), "orthographic".into()),
                Projection::Perspective { focal, .. } => {
                    put(name("focal-length-px"), format!("{focal:.2}"));
                    put(name("distance-radii"), format!("{:.4}", ball.distance()));
                }
            }
            if let Some(r) = view.registration {
                let [yaw, pitch, roll] = r.rotation.angles().map(f64::to_degrees);
                put(
                    name("yaw-pitch-roll-deg"),
                    format!("{yaw:.4},{pitch:.4},{roll:.4}"),
                );
                put(name("correlation"), format!("{:.4}", r.correlation));
                let [r, g, b] = view.gain;
                put(name("gain"), format!("{r:.5},{g:.5},{b:.5}"));
            }
        }
        if let Some(r) = &self.restored {
            let d = r.direction;
            put(
                "capture.restored.radiance".into(),
                format!("{:?}", r.radiance),
            );
            put(
                "capture.restored.direction".into(),
                format!("{:.5},{:.5},{:.5}", d.x, d.y, d.z),
            );
            put(
                "capture.restored.solid-angle-sr".into(),
                format!("{:.6}", r.solid_angle),
            );
        }
        if matches!(options.known_light, Some(KnownLight::Lux(_))) {
            put("luminance-unit".into(), "cd m-2".into());
        }
        put("capture.filled-texels".into(), self.filled.to_string());
        all
    }

    /// The layers of an EXR: R, G, B; `confidence.Y`; `uncertainty.Y`, the luminance's standard deviation; `clipped.Y`.
    ///
    /// # Errors
    /// None in practice: the layers are of one size and have different names.
    pub fn layers(&self) -> Result<Layers, ImageError> {
        let p = &self.panorama;
        let mut layers = Layers::from_image(&p.image);
        let uncertainty = p
            .image
            .pixels
            .iter()
            .zip(&p.sigma)
            .map(|(p, s)| s * (0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]))
            .collect();
        for (name, samples) in [
            ("confidence.Y", p.confidence.clone()),
            ("uncertainty.Y", uncertainty),
            ("clipped.Y", p.clipped.clone()),
        ] {
            layers.push(name, ChannelData::Float(samples))?;
        }
        for (name, value) in &self.metadata {
            layers.set_metadata(name, value);
        }
        Ok(layers)
    }

    /// Writes [`Capture::layers`].
    ///
    /// # Errors
    /// [`CaptureError::Image`] with nothing half-written.
    pub fn write(&self, path: &Path) -> Result<(), CaptureError> {
        Ok(self.layers()?.write_exr(path)?)
    }
}
