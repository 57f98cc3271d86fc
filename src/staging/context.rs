//! Indications of scale and direction: a scale bar or the pitch of the grid, and a triad in the corner.

use super::axes::COLOURS;
use super::fitting;
use super::round_steps::nearest_round_length;
use super::value_text::VALUE_SIZE;
use crate::model::theme::Theme;
use crate::numbers::decimal::significant;
use crate::render::{Camera, Frame, Ground, Label, LabelAnchor, OverlayStroke};
use crate::sorting::sort_by_number;
use glam::DVec3;

/// Approximate length of a scale bar relative to the picture's shorter side; it is rounded.
const BAR: f64 = 0.2;

/// Length of an axis and distance of its letter from the middle, over the picture's height.
const AXIS: f64 = 0.045;
const LETTER: f64 = 0.062;

/// Half the width of the lines, and half the height of the ends of a bar, over the picture's height.
const HALF_LINE: f64 = 0.0016;
const HALF_END: f64 = 0.008;

/// Room between bar, text and triad, over the picture's height.
const GAP: f64 = 0.014;

/// An axis whose projection is shorter than this fraction of its length points towards or away from the viewer and is
/// omitted.
const SHORTEST: f64 = 0.12;

/// Which of them are drawn, and how.
#[derive(Clone, Debug)]
pub struct ContextSigns {
    /// Scale bar or pitch of the grid.
    pub scale: bool,
    /// Triad.
    pub triad: bool,
    /// Name of the unit of lengths.
    pub unit: String,
    /// Of the lines and texts.
    pub theme: Theme,
}

/// The lower right corner of the room for them, and how large they are drawn, over their usual size.
#[derive(Clone, Copy, Debug)]
pub struct ContextRoom {
    /// In pixels.
    pub corner: [f64; 2],
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    /// Over the usual size.
    pub enlarged: f64,
}

impl ContextSigns {
    /// Largest width of both, relative to the picture's height.
    pub const WIDEST: f64 = 0.35;

    /// Colours that appear as they are.
    pub fn flat_colours(&self) -> impl Iterator<Item = [u8; 3]> {
        let shown = self.triad;
        COLOURS.into_iter().filter(move |_| shown)
    }

    /// Adds the signs to `frame`.
    pub fn add(
        &self,
        camera: &Camera,
        ground: Option<&Ground>,
        room: ContextRoom,
        frame: &mut Frame,
    ) {
        let mut room = room;
        if self.scale {
            room.corner[1] -= self.add_scale(camera, ground, room, frame);
        }
        if self.triad {
            self.add_triad(camera, room, frame);
        }
    }

    /// Adds the scale; returns the height that it takes.
    fn add_scale(
        &self,
        camera: &Camera,
        ground: Option<&Ground>,
        room: ContextRoom,
        frame: &mut Frame,
    ) -> f64 {
        let [width, height] = room.size.map(f64::from);
        let [right, bottom] = room.corner;
        let tall = height * room.enlarged;
        let size = VALUE_SIZE * tall;
        let (text, foot) = if camera.is_perspective() {
            // In a perspective no bar is true to scale: the pitch of the grid is named.
            let pitch = ground.map_or(0.0, |ground| ground.grid);
            if pitch <= 0.0 {
                return 0.0;
            }
            (format!("grid {}", self.length_text(pitch)), 0.0)
        } else {
            // A bar of a round length, with a line across each end.
            let pixels = camera.pixels_per_unit(room.size);
            let length = nearest_round_length(BAR * width.min(height) * room.enlarged / pixels);
            let left = right - length * pixels;
            let middle = bottom - HALF_END * tall;
            let mut line = |ends| {
                frame.strokes.push(OverlayStroke {
                    ends,
                    half_widths: [(HALF_LINE * tall).max(0.5); 2],
                    colour: self.theme.ink(),
                });
            };
            line([[left, middle], [right, middle]]);
            for x in [left, right] {
                line([[x, bottom - 2.0 * HALF_END * tall], [x, bottom]]);
            }
            (
                self.length_text(length),
                2.0 * HALF_END * tall + 0.5 * GAP * tall,
            )
        };
        // The text ends at the right, above the bar.
        let [wide, high] = fitting::text_extent(&text, size);
        let place = [right - wide, bottom - foot - high];
        frame.labels.push(Label {
            text,
            anchor: LabelAnchor::Screen([place[0] / width, place[1] / height]),
            size,
            colour: self.theme.ink(),
            plate: false,
            yields: false,
        });
        foot + high + GAP * tall
    }

    fn length_text(&self, length: f64) -> String {
        let text = format!("{} {}", significant(length, 1), self.unit);
        text.trim_end().to_owned()
    }

    fn add_triad(&self, camera: &Camera, room: ContextRoom, frame: &mut Frame) {
        let [width, height] = room.size.map(f64::from);
        let tall = height * room.enlarged;
        let size = VALUE_SIZE * tall;
        let reach = LETTER * tall + 0.5 * fitting::text_extent("x", size)[1];
        let middle = room.corner.map(|c| c - reach);
        let from_world = camera.world_from_camera.inverse();
        let mut axes: Vec<(usize, DVec3)> = (0..3)
            .map(|k| (k, from_world.transform_vector(DVec3::AXES[k])))
            .collect();
        // Axes that point away are drawn first.
        sort_by_number(&mut axes, |a| a.1.z);
        for (k, axis) in axes {
            let on_screen = [axis.x, -axis.y];
            let length = axis.truncate().length();
            if length < SHORTEST {
                continue;
            }
            let at = |far: f64| [0, 1].map(|c| middle[c] + far * tall * on_screen[c]);
            frame.strokes.push(OverlayStroke {
                ends: [middle, at(AXIS)],
                half_widths: [(1.4 * HALF_LINE * tall).max(0.8); 2],
                colour: COLOURS[k],
            });
            // Beyond the end of the line, however short the line is.
            let text = ["x", "y", "z"][k];
            let letter = at(AXIS + (LETTER - AXIS) / length);
            let extent = fitting::text_extent(text, size);
            let corner = [0, 1].map(|c| letter[c] - 0.5 * extent[c]);
            frame.labels.push(Label {
                text: text.to_owned(),
                anchor: LabelAnchor::Screen([corner[0] / width, corner[1] / height]),
                size,
                colour: COLOURS[k],
                plate: false,
                yields: false,
            });
        }
    }
}
