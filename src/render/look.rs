//! The look of every picture: lights, materials, ground and colour, as constants and f32 formulas.
//!
//! Both renderers draw with exactly these numbers; the shader text repeats the formulas. Only `+ - * /`, comparisons
//! and square roots are used, which IEEE 754 defines to the last bit, so that a picture of the CPU renderer is the same
//! on every machine. Directions are in camera space (x right, y up, z towards the viewer), so that a mechanism is well
//! lit from every direction.

/// A colour in linear light, 1 is the white of the screen; or a direction in camera space.
pub type Rgb = [f32; 3];

/// The light that reaches a surface: fractions of the key light and of the ambient light.
pub type LightShare = [f32; 2];

/// Unobstructed light.
pub const ALL_OPEN: LightShare = [1.0; 2];

/// Unit direction towards the key light: above, left of and behind the viewer. The components are ninths
/// so that the length is 1 without rounding a table of digits.
pub const KEY_DIRECTION: [f32; 3] = [-4.0 / 9.0, 7.0 / 9.0, 4.0 / 9.0];
/// Unit direction perpendicular to the key light's.
pub const KEY_RIGHT: [f32; 3] = [8.0 / 9.0, 4.0 / 9.0, 1.0 / 9.0];
/// Unit direction perpendicular to both: right, up and the light's form a right-handed system.
pub const KEY_UP: [f32; 3] = [-1.0 / 9.0, 4.0 / 9.0, -8.0 / 9.0];
/// Irradiance of the key light, faintly warm.
pub const KEY_COLOUR: Rgb = [0.92, 0.91, 0.885];
/// How far the key light reaches around the terminator: 0 is Lambert, 1 reaches the far pole.
pub const KEY_WRAP: f32 = 0.20;
/// Unit direction towards the fill light: from the right, a little above the horizon.
pub const FILL_DIRECTION: [f32; 3] = [6.0 / 7.0, 2.0 / 7.0, 3.0 / 7.0];
/// Irradiance of the fill light, faintly cool.
pub const FILL_COLOUR: Rgb = [0.16, 0.17, 0.19];
/// Irradiance on a surface that faces up.
pub const SKY_COLOUR: Rgb = [0.34, 0.345, 0.36];
/// Irradiance on a surface that faces down: light reflected by the ground.
pub const GROUND_COLOUR: Rgb = [0.155, 0.15, 0.143];
/// Fraction of the key light's direct part that is lost in another body's shadow. The part around the terminator stays,
/// so that no shadow begins where a surface turns away from the light.
pub const KEY_SHADE: f32 = 0.68;
/// Cosine to the light up to which nothing of this is lost: at grazing angles a shadow map is unreliable.
pub const KEY_GRAZING: f32 = 0.05;
/// Growth of the cosine over which the loss sets in.
pub const KEY_SHADE_FACING: f32 = 0.2;
/// Fraction of the key light that is lost where no ambient light arrives.
pub const SKY_SHADE: f32 = 0.6;
/// Strength of the wide sheen, `(n·h)^8`.
pub const SHEEN: f32 = 0.05;
/// Strength of the small highlight, `(n·h)^64`.
pub const HIGHLIGHT: f32 = 0.22;
/// How much of a highlight takes the colour of its surface. White highlights on flat faces, which flash as a whole
/// while they rotate, would wash out their colour.
pub const GLOSS_TINT: f32 = 0.6;
/// Factor on all light from a lit surface.
pub const EXPOSURE: f32 = 1.02;
/// Fraction of its missing opacity that a translucent surface regains when seen edge-on.
pub const EDGE_OPACITY: f32 = 0.65;

/// Half the width of a grid line in pixels.
pub const GRID_HALF_WIDTH: f32 = 0.6;
/// A grid is gone where a pixel spans more than this share of its pitch, and starts to go at half of it.
pub const GRID_MAX_FOOTPRINT: f32 = 0.25;
/// Square of the share of the ground's radius within which it does not fade.
pub const FADE_START_SQUARED: f32 = 0.20;
/// Fraction of the light that the darkest contact shadow takes away, in linear light.
pub const SHADOW_DARKNESS: f32 = 0.74;

/// Weights of linear red, green and blue in luminance (ITU-R BT.709).
pub const LUMINANCE: Rgb = [0.2126, 0.7152, 0.0722];

/// Scalar product.
#[inline(always)]
pub fn dot_product(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The least divisor: what is divided by it is zero itself and stays so.
pub(super) const LEAST_DIVISOR: f32 = 1e-30;

/// The larger of two numbers, `b` when `a` is not a number; one instruction, unlike `f32::max`.
#[inline(always)]
pub fn larger_of(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, `b` when `a` is not a number.
#[inline(always)]
pub fn smaller_of(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Clamps to 0..=1; not a number becomes 0.
#[inline(always)]
pub fn clamp_unit(x: f32) -> f32 {
    smaller_of(larger_of(x, 0.0), 1.0)
}

/// `a` at t = 0, `b` at t = 1.
#[inline(always)]
pub fn mix_values(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// The surroundings of a lit surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// The ground's normal in camera space, unit length.
    pub up: [f32; 3],
    /// The change of a surface's light where it turns away from the viewer.
    pub rim: Rim,
}

/// Light silhouettes: they must stand out from the background and from a body of the same colour behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Strength of the light added, `(1 - n·v)^4`.
    pub gain: f32,
    /// Share of the light that is taken away, `(1 - n·v)^2`.
    pub loss: f32,
}

impl Rim {
    /// Dark silhouettes for light backgrounds.
    pub const DARK: Self = Self {
        gain: 0.05,
        loss: 0.32,
    };
    /// Light silhouettes for dark backgrounds.
    pub const LIGHT: Self = Self {
        gain: 0.16,
        loss: 0.0,
    };
}

/// The colour that a lit surface sends to the viewer, in linear light, 0..=1.
///
/// All directions are unit vectors in camera space: `normal` on the visible side, `to_viewer` from the surface to the
/// eye (`[0, 0, 1]` for a parallel projection). `albedo` is linear; `flat` 1 gives the albedo itself. `open` contains
/// the fractions of the key light and of the ambient light that reach the surface. The highlight is Blinn's, with
/// `(n·h)² = (n·l + n·v)² / (2 + 2 l·v)` so that the half vector need not be normalised.
#[inline(always)]
pub fn shade_surface(
    normal: [f32; 3],
    to_viewer: [f32; 3],
    around: &Surroundings,
    albedo: Rgb,
    flat: f32,
    open: LightShare,
) -> Rgb {
    let [lit, sky_open] = open;
    // Key light: wrapped around the terminator, less what other bodies' shadows take of its direct part.
    let n_l = dot_product(normal, KEY_DIRECTION);
    let n_v = larger_of(dot_product(normal, to_viewer), 0.0);
    let direct = larger_of(n_l, 0.0);
    let share = clamp_unit((direct - KEY_GRAZING) / KEY_SHADE_FACING);
    let lost = KEY_SHADE * (1.0 - lit) * direct * share;
    let key = larger_of((n_l + KEY_WRAP) / (1.0 + KEY_WRAP), 0.0) - lost;
    let key = key * (1.0 - SKY_SHADE * (1.0 - sky_open));
    // Fill light by Lambert; ambient light from the sky above and the ground below.
    let fill = larger_of(dot_product(normal, FILL_DIRECTION), 0.0);
    let sky = 0.5 + 0.5 * dot_product(normal, around.up);

    // Blinn's highlight: powers of (n·h)² by squaring.
    let half = larger_of(n_l + n_v, 0.0);
    let h2 = smaller_of(
        half * half / larger_of(2.0 + 2.0 * dot_product(KEY_DIRECTION, to_viewer), 1e-6),
        1.0,
    );
    let h4 = h2 * h2;
    let h8 = h4 * h4;
    let h16 = h8 * h8;
    let h32 = h16 * h16;
    let glint = (SHEEN * h8 + HIGHLIGHT * (h32 * h32)) * lit;
    // Silhouettes, where the surface turns away from the viewer.
    let away = (1.0 - n_v) * (1.0 - n_v);
    let kept = 1.0 - around.rim.loss * away;
    let gain = around.rim.gain * (away * away);

    // Channel by channel: diffuse light times the albedo, and gloss on top; flat paint is the albedo itself.
    let channel = |c: usize| {
        let around = mix_values(GROUND_COLOUR[c], SKY_COLOUR[c], sky) + FILL_COLOUR[c] * fill;
        let light = around * sky_open + KEY_COLOUR[c] * key;
        let light = light * kept;
        let tinted = glint * mix_values(1.0, albedo[c], GLOSS_TINT);
        let gloss = KEY_COLOUR[c] * tinted + SKY_COLOUR[c] * gain;
        let lit = clamp_unit(EXPOSURE * (albedo[c] * light + gloss));
        mix_values(lit, albedo[c], flat)
    };
    [channel(0), channel(1), channel(2)]
}

/// Fresnel-like weight `(1 - n·v)^4` of a surface whose normal has cosine `n_v` (0..=1) to the viewer.
#[inline(always)]
pub fn rim_light(n_v: f32) -> f32 {
    let away = 1.0 - n_v;
    let squared = away * away;
    squared * squared
}

/// Opacity of a translucent surface: its own, and more where it is seen edge-on.
#[inline(always)]
pub fn edge_opacity(opacity: f32, n_v: f32) -> f32 {
    opacity + (1.0 - opacity) * (EDGE_OPACITY * rim_light(n_v))
}

/// How much of the ground is there, 1 in the middle to 0 at its radius.
///
/// `radius_share_squared` is the squared distance from the ground's centre over the squared radius.
#[inline(always)]
pub fn ground_fade(radius_share_squared: f32) -> f32 {
    let t = clamp_unit((radius_share_squared - FADE_START_SQUARED) / (1.0 - FADE_START_SQUARED));
    1.0 - t * t * (3.0 - 2.0 * t)
}

/// The greatest whole number that is not above `x`; without the library's function, so that many are computed at once.
#[inline(always)]
fn floor_value(x: f32) -> f32 {
    // From here on the last bit of a number is worth 1 or more: the sum is rounded to a whole number.
    const WHOLE: f32 = 8_388_608.0;
    let size = x.abs();
    let rounded = ((size + WHOLE) - WHOLE).copysign(x);
    let floor = if rounded > x { rounded - 1.0 } else { rounded };
    if size < WHOLE { floor } else { x }
}

/// How much of a pixel a family of parallel grid lines covers, 0..=1.
///
/// `at` is the coordinate across the lines in units of the pitch (lines at the whole numbers) and
/// `footprint` what a pixel spans in it, `|d at/dx| + |d at/dy|`.
#[inline(always)]
pub fn grid_line(at: f32, footprint: f32) -> f32 {
    let off = at - floor_value(at + 0.5);
    let distance = if off < 0.0 { -off } else { off };
    let cover = clamp_unit(GRID_HALF_WIDTH + 0.5 - distance / larger_of(footprint, 1e-12));
    cover * clamp_unit(2.0 - footprint * (2.0 / GRID_MAX_FOOTPRINT))
}

/// Factor on the background's linear colour where the ground is seen.
///
/// `fade` as of [`ground_fade`]; `lines` the larger of the two [`grid_line`]s; `shadow` 0..=1, as of
/// [`ContactShadow::sample`](super::contact_shadow::ContactShadow::sample); `shade` as of
/// [`Ground::shade`](super::Ground::shade).
#[inline(always)]
pub fn ground_factor(fade: f32, lines: f32, shadow: f32, shade: [f32; 2]) -> f32 {
    (1.0 - fade * (shade[0] + shade[1] * lines)) * (1.0 - fade * SHADOW_DARKNESS * shadow)
}
