//! The shader text: constants generated from `look`, then the formulas and entry points of `shaders/`.

use crate::render::look;
use std::fmt::Write;

/// The text of one module with every entry point.
pub fn source() -> String {
    let mut text = constants();
    for part in [
        include_str!("../../../shaders/look.wgsl"),
        include_str!("../../../shaders/scene.wgsl"),
        include_str!("../../../shaders/body.wgsl"),
        include_str!("../../../shaders/ground.wgsl"),
    ] {
        text.push('\n');
        text.push_str(part);
    }
    text
}

/// WGSL constants with the names and values of `look`; digits are the shortest that read back the same f32.
fn constants() -> String {
    let mut text = String::new();
    macro_rules! scalars {
        ($($name:ident),*) => {
            $(let _ = writeln!(text, "const {}: f32 = {:?};", stringify!($name), look::$name);)*
        };
    }
    macro_rules! vectors {
        ($($name:ident),*) => {
            $(let [x, y, z] = look::$name;
            let _ = writeln!(text, "const {} = vec3<f32>({x:?}, {y:?}, {z:?});", stringify!($name));)*
        };
    }
    vectors!(
        KEY_DIRECTION,
        KEY_COLOUR,
        FILL_DIRECTION,
        FILL_COLOUR,
        SKY_COLOUR,
        GROUND_COLOUR
    );
    scalars!(KEY_WRAP, SHEEN, HIGHLIGHT, RIM, EXPOSURE, EDGE_OPACITY);
    scalars!(
        GROUND_TINT,
        GRID_DARKNESS,
        GRID_HALF_WIDTH,
        GRID_MAX_FOOTPRINT
    );
    scalars!(FADE_START_SQUARED, SHADOW_DARKNESS);
    text
}
