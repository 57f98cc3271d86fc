//! The shader text: constants generated from `look`, then the formulas and entry points of `shaders/`.

use crate::render::look;
use std::fmt::Write;

/// The text of one module with every entry point.
pub fn shader_source() -> String {
    let mut text = shader_constants();
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
fn shader_constants() -> String {
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
    scalars!(KEY_WRAP, SHEEN, HIGHLIGHT, EXPOSURE, EDGE_OPACITY);
    scalars!(GRID_HALF_WIDTH, GRID_MAX_FOOTPRINT);
    scalars!(FADE_START_SQUARED, SHADOW_DARKNESS);
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use wgpu::naga;

    fn module() -> naga::Module {
        let text = shader_source();
        naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)))
    }

    #[test]
    fn the_shaders_are_valid_without_any_extension() {
        let flags = naga::valid::ValidationFlags::all();
        let capabilities = naga::valid::Capabilities::empty();
        naga::valid::Validator::new(flags, capabilities)
            .validate(&module())
            .unwrap();
    }

    #[test]
    fn all_entry_points_are_there() {
        let module = module();
        let names: Vec<&str> = module
            .entry_points
            .iter()
            .map(|e| e.name.as_str())
            .collect();
        for name in [
            "body_vertex",
            "body_opaque",
            "body_translucent",
            "ground_vertex",
            "ground_fragment",
        ] {
            assert!(names.contains(&name), "{name} of {names:?}");
        }
    }

    /// Every constant of the look is known to the shaders, and read by them: none is forgotten.
    #[test]
    fn no_constant_of_the_look_is_missing() {
        let constants = shader_constants();
        let shaders = shader_source().split_off(constants.len());
        let names = include_str!("../look.rs")
            .lines()
            .filter_map(|line| line.strip_prefix("pub const ")?.split(':').next());
        // Luminance is for the greying of finished pictures, which is done on the processor for both.
        for name in names.filter(|name| *name != "LUMINANCE") {
            assert!(
                constants.contains(&format!("const {name}")),
                "{name} is not passed on"
            );
            assert!(shaders.contains(name), "{name} is not used");
        }
    }

    #[test]
    fn digits_read_back_as_the_same_number() {
        let text = shader_constants();
        let line = text.lines().find(|line| line.contains("EXPOSURE")).unwrap();
        let digits = line.split("= ").nth(1).unwrap().trim_end_matches(';');
        assert_eq!(digits.parse::<f32>().unwrap(), look::EXPOSURE);
    }
}
