//! The still picture of a page: used without scripts, without WebGL, and on paper.

use crate::export::png_indexed::encode_indexed;
use crate::kinematics::results::trajectory::Trajectory;
use crate::pictures::frames::{DrawnBy, Pictures};
use crate::pictures::playback::PlayOrder;
use crate::render::adapter::AdapterChoice;
use crate::render::open::RendererChoice;
use crate::render::{Camera, RenderError};
use crate::scene::Scene;
use crate::staging::{PictureOptions, Staging};
use image::RgbaImage;

/// Size and smoothness: sharp enough on paper at 12 cm, and some 40 kB.
const OPTIONS: PictureOptions = PictureOptions {
    size: [640, 480],
    samples: 4,
};

/// A picture with the camera that it was taken with.
pub struct StillPicture {
    /// The file.
    pub png: Vec<u8>,
    /// The camera.
    pub camera: Camera,
    /// Width over height.
    pub aspect: f64,
}

/// Draws the first frame by the program's own renderer, whose pictures are the same on every machine.
pub fn first_picture(scene: &Scene, shown: &Trajectory) -> Result<StillPicture, RenderError> {
    let by = DrawnBy {
        renderer: RendererChoice::Cpu,
        adapter: AdapterChoice::Software,
        threads: 1,
    };
    let mut image = RgbaImage::new(OPTIONS.size[0], OPTIONS.size[1]);
    let staging = Staging::new(scene, shown, OPTIONS);
    let pictures = Pictures {
        scene,
        staging: &staging,
        panes: &[],
        order: PlayOrder::plain(0, 1),
        panel: None,
    };
    for draw in pictures.workers(&by)?.list.iter_mut().take(1) {
        draw(0, &mut image)?;
    }
    image
        .as_mut()
        .iter_mut()
        .for_each(|level| *level = coarser_level(*level));
    let mut png = Vec::new();
    encode_indexed(&image, &mut png).map_err(|error| RenderError::Device(error.to_string()))?;
    let (camera, aspect) = camera_of(&staging);
    Ok(StillPicture {
        png,
        camera,
        aspect,
    })
}

/// The camera of the first frame and its picture's width over its height, without a picture.
pub fn view_of(scene: &Scene, shown: &Trajectory) -> (Camera, f64) {
    camera_of(&Staging::new(scene, shown, OPTIONS))
}

fn camera_of(staging: &Staging) -> (Camera, f64) {
    let [width, height] = OPTIONS.size.map(f64::from);
    (staging.frame(0).camera(&staging.stage), width / height)
}

/// Reduced to 64 levels per channel, black and white among them: two thirds of the file size, without a visible difference.
fn coarser_level(level: u8) -> u8 {
    let step = u32::from(level) >> 2;
    ((step * 255 + 31) / 63) as u8
}
