//! [`capture`], the whole way: photographs in, an environment with what is known about it out.

use crate::align::align;
use crate::blend::{self, View};
use crate::explain::Explain;
use crate::outline::{self, Lens, Outline};
use crate::panorama::{Panorama, Unwrap};
use crate::photo::Photo;
use crate::register::{self, Registration};
use crate::response::{Response, ResponseChoice};
use crate::restore::{self, Restored};
use crate::{BallMaterial, CaptureError, Radiance, Rotation, fill};
use gonio_image::Image;
use std::fmt::Display;
use std::path::PathBuf;

/// What clipped light is restored from.
#[derive(Debug, Clone)]
pub enum KnownLight {
    /// Photographs of a grey ball, exposures of one view, and where it stands if that is known.
    GreyBall(Vec<Photo>, Option<[f64; 3]>),
    /// Illuminance \[lx] on level ground, > 0.
    Lux(f64),
}

/// How photographs become an environment.
#[derive(Debug, Clone)]
pub struct Options {
    /// Viewpoints. The photographs are those of the first, then those of the second, …: equally many of each.
    pub views: usize,
    /// Relative exposures: one a photograph, or one a photograph of the first view, which repeat. From EXIF if nothing.
    pub exposures: Option<Vec<f64>>,
    /// The response curve.
    pub response: ResponseChoice,
    /// What is known of the camera. `Unknown` takes EXIF's focal length, if there is one.
    pub lens: Lens,
    /// Circles \[pixels: x, y, radius]: none (then they are found) or one a view.
    pub balls: Vec<[f64; 3]>,
    /// Rotations from the frame of each further view's camera into that of the first's: none (then they are found) or one a view but the
    /// first.
    pub rotations: Vec<Rotation>,
    /// What the ball is made of.
    pub material: BallMaterial,
    /// Rows of the panorama, which is twice as wide: 8 to 16,384.
    pub height: usize,
    /// Width \[pixels] of the outline's edge that is left out.
    pub margin: f64,
    /// Half-angle \[°] of the cone that shows the camera.
    pub camera_deg: f64,
    /// Whether texels that nobody saw are filled; they are in any case if clipped light is restored.
    pub fill: bool,
    /// What clipped light is restored from.
    pub known_light: Option<KnownLight>,
    /// A folder for a picture of every step.
    pub explain: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            views: 1,
            exposures: None,
            response: ResponseChoice::Auto,
            lens: Lens::Unknown,
            balls: Vec::new(),
            rotations: Vec::new(),
            material: BallMaterial::Chrome,
            height: 512,
            margin: 1.5,
            camera_deg: 6.0,
            fill: false,
            known_light: None,
            explain: None,
        }
    }
}

/// A viewpoint, as it was understood.
#[derive(Debug, Clone)]
pub struct ViewFound {
    /// Its first photograph.
    pub name: String,
    /// The ball.
    pub outline: Outline,
    /// How it is turned against the first view; `None` for the first.
    pub registration: Option<Registration>,
    /// Factors that its channels were multiplied by.
    pub gain: [f64; 3],
}

/// An environment, captured.
#[derive(Debug, Clone)]
pub struct Capture {
    /// The panorama, in the frame of the first view's camera: it stands at +z, at the picture's left and right edge.
    pub panorama: Panorama,
    /// The viewpoints.
    pub views: Vec<ViewFound>,
    /// The response curve.
    pub response: Response,
    /// What was put back.
    pub restored: Option<Restored>,
    /// Texels that were filled.
    pub filled: usize,
    /// Choices that were made for the user, to be told.
    pub notes: Vec<String>,
    pub(crate) metadata: Vec<(String, String)>,
}

/// Makes an environment of photographs of a mirrored ball. `progress` is told each step and how far the whole is, 0 to 1.
///
/// The same photographs give the same bits.
///
/// # Errors
/// Every variant of [`CaptureError`].
pub fn capture(
    photos: &[Photo],
    options: &Options,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Capture, CaptureError> {
    check(photos, options)?;
    let mut notes = Vec::new();
    let mut explain = Explain::into_folder(options.explain.as_deref())?;
    let each = photos.len() / options.views;
    let exposures = exposures(photos, options, each)?;
    let lens = lens(&photos[0], options.lens, &mut notes);
    progress("aligning exposures", 0.0);
    let moved = aligned(photos, &exposures, lens, options, &mut notes)?;
    let photos = moved.as_deref().unwrap_or(photos);
    progress("response curve", 0.05);
    let response = response(
        &photos[..each],
        &exposures[..each],
        options.response,
        &mut notes,
    )?;
    explain.response(&response)?;

    let mut found: Vec<(Radiance, Outline, &str)> = Vec::new();
    for v in 0..options.views {
        let step = |part: f64| 0.1 + 0.5 * (v as f64 + part) / options.views as f64;
        let range = v * each..(v + 1) * each;
        let name = &photos[range.start].name;
        progress("merging exposures", step(0.0));
        let radiance = Radiance::merge(&photos[range.clone()], &exposures[range], &response)?;
        explain.radiance(v + 1, &radiance)?;
        progress("finding the ball", step(0.5));
        let size = [radiance.image.width, radiance.image.height];
        let outline = match options.balls.get(v) {
            Some(circle) => outline::given(*circle, lens, size)?,
            None => outline::find(&radiance.image, lens, name)?,
        };
        explain.outline(v + 1, &radiance.image, &outline)?;
        found.push((radiance, outline, name));
    }

    progress("registering the views", 0.6);
    let unwrap = |rotation| Unwrap {
        height: options.height,
        material: options.material,
        margin: options.margin,
        rotation,
        camera_deg: options.camera_deg,
    };
    let small = |view: &(Radiance, Outline, &str)| {
        let how = Unwrap {
            height: options.height.min(256),
            ..unwrap(Rotation::IDENTITY)
        };
        Panorama::unwrap(&view.0, &view.1.ball, &how)
    };
    let mut registrations = vec![None];
    if found.len() > 1 {
        let reference = small(&found[0]);
        for (k, view) in found[1..].iter().enumerate() {
            let registered = match options.rotations.get(k) {
                Some(rotation) => register::given(&reference, &small(view), *rotation),
                None => register::register(&reference, &small(view), [found[0].2, view.2])?,
            };
            if registered.correlation < register::LEAST_CORRELATION {
                notes.push(format!(
                    "{}: turned as given it correlates with {} by {:.2} alone: a right rotation gives {:.2} or more",
                    view.2,
                    found[0].2,
                    registered.correlation,
                    register::LEAST_CORRELATION
                ));
            }
            registrations.push(Some(registered));
        }
    }
    progress("unwrapping", 0.75);
    let views: Vec<View> = found
        .iter()
        .zip(&registrations)
        .map(|((radiance, outline, _), registration)| {
            let rotation = registration.map_or(Rotation::IDENTITY, |r| r.rotation);
            View {
                panorama: Panorama::unwrap(radiance, &outline.ball, &unwrap(rotation)),
                towards_camera: rotation.apply(outline.ball.towards_camera()),
            }
        })
        .collect();
    for (v, view) in views.iter().enumerate() {
        let (name, what) = (format!("view{}", v + 1), format!("viewpoint {}", v + 1));
        let picture = &view.panorama.image;
        explain.panorama(
            &format!("{name}-panorama"),
            &format!("What {what} saw"),
            picture,
        )?;
        explain.confidence(&format!("{name}-confidence"), &what, &view.panorama)?;
    }
    progress("merging the views", 0.85);
    let before: Vec<Panorama> = if options.explain.is_some() && views.len() > 1 {
        views.iter().map(|v| v.panorama.clone()).collect()
    } else {
        Vec::new()
    };
    let merged = blend::blend(views);
    for (v, mut p) in before.iter().cloned().enumerate().skip(1) {
        for pixel in &mut p.image.pixels {
            for (value, gain) in pixel.iter_mut().zip(merged.gains[v]) {
                *value *= gain as f32;
            }
        }
        explain.difference(v + 1, &before[0], &p)?;
    }
    let mut panorama = merged.panorama;
    explain.panorama("merged", "All viewpoints merged", &panorama.image)?;
    explain.confidence("confidence", "the merged panorama", &panorama)?;

    let mut filled = 0;
    // Irradiance misses what a black hole would have given: clipped light is restored with the holes filled.
    if options.fill || options.known_light.is_some() {
        progress("filling what nobody saw", 0.9);
        filled = fill::fill(&mut panorama.image, &panorama.confidence);
    }
    let restored = match &options.known_light {
        None => None,
        Some(light) => {
            let mut image = std::mem::replace(&mut panorama.image, Image::new(1, 1));
            let clipped = &panorama.clipped;
            let found = restore(
                light,
                &mut image,
                clipped,
                &response,
                &found[0].1,
                photos,
                options,
                lens,
            )?;
            panorama.image = image;
            found
        }
    };
    explain.panorama("panorama", "What is written", &panorama.image)?;
    progress("done", 1.0);

    let views = found
        .into_iter()
        .zip(registrations)
        .zip(&merged.gains)
        .map(|(((_, outline, name), registration), gain)| ViewFound {
            name: name.to_owned(),
            outline,
            registration,
            gain: *gain,
        })
        .collect();
    let mut capture = Capture {
        panorama,
        views,
        response,
        restored,
        filled,
        notes,
        metadata: Vec::new(),
    };
    capture.metadata = capture.describe(options);
    Ok(capture)
}

fn check(photos: &[Photo], options: &Options) -> Result<(), CaptureError> {
    let wrong =
        |name, found: &dyn Display, expected| CaptureError::parameter(name, found, expected);
    if options.views == 0 || photos.is_empty() || !photos.len().is_multiple_of(options.views) {
        return Err(wrong(
            "views",
            &format!("{} of {} photograph(s)", options.views, photos.len()),
            "a number that divides the number of photographs: equally many exposures of each view",
        ));
    }
    if !options.balls.is_empty() && options.balls.len() != options.views {
        return Err(wrong(
            "balls",
            &options.balls.len(),
            "one circle for each view",
        ));
    }
    if !options.rotations.is_empty() && options.rotations.len() + 1 != options.views {
        return Err(wrong(
            "rotations",
            &options.rotations.len(),
            "one for each view but the first",
        ));
    }
    if !(8..=16_384).contains(&options.height) {
        return Err(wrong(
            "height of the panorama",
            &options.height,
            "8 to 16384 rows",
        ));
    }
    if !(options.margin >= 0.0 && options.margin < 1e4) {
        return Err(wrong("margin", &options.margin, "0 or more pixels"));
    }
    if !(options.camera_deg >= 0.0 && options.camera_deg < 90.0) {
        return Err(wrong(
            "angle of the camera",
            &options.camera_deg,
            "0° or more and less than 90°",
        ));
    }
    if let Some(KnownLight::Lux(lux)) = options.known_light
        && !(lux > 0.0 && lux.is_finite())
    {
        return Err(wrong("illuminance", &lux, "a positive number of lux"));
    }
    Ok(())
}

/// The photographs with the exposures of each view over each other, if any had to be moved; what was done is noted.
fn aligned(
    photos: &[Photo],
    exposures: &[f64],
    lens: Lens,
    options: &Options,
    notes: &mut Vec<String>,
) -> Result<Option<Vec<Photo>>, CaptureError> {
    let each = photos.len() / options.views;
    if each < 2 {
        return Ok(None);
    }
    let mut all = Vec::with_capacity(photos.len());
    let mut any = false;
    for (v, (view, exposures)) in photos.chunks(each).zip(exposures.chunks(each)).enumerate() {
        let circle = match options.balls.get(v) {
            Some(circle) => Some(*circle),
            None => ball_of_one(view, lens)?,
        };
        let found = align(view, exposures, circle)?;
        for (photo, shift) in view.iter().zip(&found.shifts) {
            let reference = &view[found.reference].name;
            match shift {
                Some([0, 0]) => {}
                Some([x, y]) => notes.push(format!(
                    "{}: the ball is {} pixels to the {} and {} {} of where {reference} has it: moved back",
                    photo.name,
                    x.abs(),
                    if *x < 0 { "left" } else { "right" },
                    y.abs(),
                    if *y < 0 { "above" } else { "below" },
                )),
                None => notes.push(format!(
                    "{}: too dark, too bright or too even to tell whether it is aligned with {reference}",
                    photo.name
                )),
            }
        }
        any |= found.photos.is_some();
        all.extend(found.photos.unwrap_or_else(|| view.to_vec()));
    }
    Ok(any.then_some(all))
}

/// The ball in the best of several exposures, taken as sRGB: a curve that increases leaves edges where they are.
fn ball_of_one(view: &[Photo], lens: Lens) -> Result<Option<[f64; 3]>, CaptureError> {
    let one = &view[crate::align::best_exposed(view)];
    let radiance = Radiance::merge(std::slice::from_ref(one), &[1.0], &Response::srgb())?;
    match outline::find(&radiance.image, lens, &one.name) {
        Ok(found) => {
            let [x, y] = found.ball.centre();
            Ok(Some([x, y, found.ball.radius()]))
        }
        // The merged exposures may show it yet.
        Err(CaptureError::NoBall { .. }) => Ok(None),
        Err(e) => Err(e),
    }
}

/// The exposure of each photograph.
fn exposures(photos: &[Photo], options: &Options, each: usize) -> Result<Vec<f64>, CaptureError> {
    let found: Vec<f64> = match &options.exposures {
        Some(given) if given.len() == photos.len() => given.clone(),
        Some(given) if given.len() == each => {
            given.iter().copied().cycle().take(photos.len()).collect()
        }
        Some(given) => {
            return Err(CaptureError::parameter(
                "exposures",
                format!("{} of them", given.len()),
                "one for each photograph, or one for each photograph of the first view",
            ));
        }
        // A single exposure needs no number, but says how bright the picture is if it has one.
        None if each == 1 && photos.iter().any(|p| p.exif.exposure().is_none()) => {
            vec![1.0; photos.len()]
        }
        None => photos
            .iter()
            .map(|p| {
                p.exif.exposure().ok_or_else(|| CaptureError::NoExposure {
                    file: p.name.clone(),
                    missing: "the exposure time",
                })
            })
            .collect::<Result<_, _>>()?,
    };
    if let Some(bad) = found.iter().find(|e| !(**e > 0.0 && e.is_finite())) {
        return Err(CaptureError::parameter(
            "exposure",
            bad,
            "a positive number of seconds",
        ));
    }
    for v in 0..options.views {
        let range = v * each..(v + 1) * each;
        for i in range.clone() {
            for j in i + 1..range.end {
                if (found[i] / found[j] - 1.0).abs() < 0.05 {
                    return Err(CaptureError::EqualExposures {
                        first: photos[i].name.clone(),
                        second: photos[j].name.clone(),
                        exposure: seconds(found[i]),
                    });
                }
            }
        }
    }
    Ok(found)
}

fn seconds(t: f64) -> String {
    if t < 0.3 {
        format!("1/{:.0} s", 1.0 / t)
    } else {
        format!("{t} s")
    }
}

fn response(
    photos: &[Photo],
    exposures: &[f64],
    choice: ResponseChoice,
    notes: &mut Vec<String>,
) -> Result<Response, CaptureError> {
    if !photos[0].is_coded() {
        return Ok(Response::linear());
    }
    match choice {
        ResponseChoice::Linear => Ok(Response::linear()),
        ResponseChoice::Srgb => Ok(Response::srgb()),
        ResponseChoice::Auto if photos.len() == 1 => {
            notes.push(
                "one exposure doesn't tell the camera's response: sRGB's curve is assumed".into(),
            );
            Ok(Response::srgb())
        }
        ResponseChoice::Recover if photos.len() == 1 => Err(CaptureError::Response {
            reason: "one exposure doesn't tell it".into(),
        }),
        ResponseChoice::Auto | ResponseChoice::Recover => Response::recover(photos, exposures),
    }
}

/// The lens that was given, else that of EXIF, else unknown.
fn lens(photo: &Photo, given: Lens, notes: &mut Vec<String>) -> Lens {
    if given != Lens::Unknown {
        return given;
    }
    if let Some(mm) = photo.exif.focal_35mm {
        // The same diagonal field of view as 36 mm × 24 mm.
        let (w, h) = (photo.picture.width as f64, photo.picture.height as f64);
        let focal = mm / 36.0_f64.hypot(24.0) * w.hypot(h);
        return Lens::FieldOfView(2.0 * (0.5 * w).atan2(focal));
    }
    notes.push(
        "the photograph doesn't tell its field of view: the camera is taken as far away (--fov, --distance)".into(),
    );
    Lens::Unknown
}

#[allow(
    clippy::too_many_arguments,
    reason = "one call; a struct would only rename them"
)]
fn restore(
    light: &KnownLight,
    image: &mut Image,
    clipped: &[f32],
    response: &Response,
    mirrored: &Outline,
    photos: &[Photo],
    options: &Options,
    lens: Lens,
) -> Result<Option<Restored>, CaptureError> {
    match light {
        KnownLight::Lux(lux) => {
            // Exposures count as they stand in EXIF only if they were read from there, and whole.
            let known =
                options.exposures.is_none() && photos[0].exif.saturation_luminance().is_some();
            // L = 120 N²/(S t) = 1.2 / H for the exposure H of `Exif::exposure`.
            restore::by_illuminance(image, clipped, *lux, known.then_some(1.2))
        }
        KnownLight::GreyBall(grey, circle) => {
            let exposures = grey
                .iter()
                .map(|p| p.exif.exposure())
                .collect::<Option<Vec<f64>>>()
                .unwrap_or_else(|| vec![1.0; grey.len()]);
            let radiance = Radiance::merge(grey, &exposures, response)?;
            let size = [radiance.image.width, radiance.image.height];
            let ball = match circle {
                Some(circle) => outline::given(*circle, lens, size)?.ball,
                None => match outline::find(&radiance.image, lens, &grey[0].name) {
                    Ok(found) => found.ball,
                    // The shadow side may melt into the ground: where the mirrored ball stood in a picture of the same size.
                    Err(CaptureError::NoBall { .. })
                        if size == [photos[0].picture.width, photos[0].picture.height] =>
                    {
                        mirrored.ball
                    }
                    Err(e) => return Err(e),
                },
            };
            restore::by_grey_ball(image, clipped, &radiance, &ball).map(Some)
        }
    }
}
