//! The shader text: constants generated from `look`, then the formulas and entry points of `shaders/`.

use crate::render::cpu::sample_places;
use crate::render::{edges, look, mutual_shade};
use std::fmt::Write;

/// The text of one module with every entry point, for `samples` a pixel.
pub fn shader_source(samples: u32) -> String {
    let mut text = shader_constants();
    text.push_str(&surface_bindings(samples));
    for part in [
        include_str!("../../../shaders/look.wgsl"),
        include_str!("../../../shaders/scene.wgsl"),
        include_str!("../../../shaders/mutual_shade.wgsl"),
        include_str!("../../../shaders/lines.wgsl"),
        include_str!("../../../shaders/body.wgsl"),
        include_str!("../../../shaders/peel.wgsl"),
        include_str!("../../../shaders/ground.wgsl"),
    ] {
        text.push('\n');
        text.push_str(part);
    }
    text
}

/// The textures of surfaces and depths, which are other types with one sample, and where the samples of a pixel are.
fn surface_bindings(samples: u32) -> String {
    let mut text = String::new();
    let places: Vec<String> = sample_places(samples)
        .iter()
        .map(|[x, y]| format!("vec2<f32>({x:?}, {y:?})"))
        .collect();
    // The places of the samples, as in the CPU renderer.
    let count = places.len();
    let _ = writeln!(text, "const SAMPLES: i32 = {count};");
    let _ = writeln!(
        text,
        "var<private> PLACES: array<vec2<f32>, {count}> = array<vec2<f32>, {count}>({});",
        places.join(", ")
    );
    // A texture with one sample has another type, and is read at mip level 0 in place of a sample.
    let [surfaces, depths, index] = match count {
        1 => ["texture_2d", "texture_depth_2d", "0"],
        _ => [
            "texture_multisampled_2d",
            "texture_depth_multisampled_2d",
            "index",
        ],
    };
    let _ = writeln!(text, "@group(1) @binding(0) var surfaces: {surfaces}<u32>;");
    let _ = writeln!(text, "@group(1) @binding(1) var depths: {depths};");
    let _ = writeln!(
        text,
        "fn depth_at(pixel: vec2<i32>, index: i32) -> f32 {{ return textureLoad(depths, pixel, {index}); }}"
    );
    let _ = writeln!(
        text,
        "fn surface_words(pixel: vec2<i32>, index: i32) -> vec4<u32> {{ return textureLoad(surfaces, pixel, {index}); }}"
    );
    let _ = writeln!(text, "const NO_LINES: u32 = {}u;", edges::NO_LINES);
    let _ = writeln!(text, "const BACKDROP: u32 = {}u;", edges::BACKDROP);
    let _ = writeln!(text, "const FIRST: u32 = {}u;", edges::FIRST);
    let _ = writeln!(text, "const TRANSLUCENT: u32 = {}u;", edges::TRANSLUCENT);
    let _ = writeln!(text, "const STRENGTH: f32 = {:?};", edges::STRENGTH);
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
        KEY_RIGHT,
        KEY_UP,
        KEY_COLOUR,
        FILL_DIRECTION,
        FILL_COLOUR,
        SKY_COLOUR,
        GROUND_COLOUR
    );
    scalars!(
        KEY_WRAP,
        KEY_SHADE,
        KEY_GRAZING,
        KEY_SHADE_FACING,
        SKY_SHADE,
        SHEEN,
        HIGHLIGHT,
        GLOSS_TINT,
        EXPOSURE,
        EDGE_OPACITY
    );
    scalars!(GRID_HALF_WIDTH, GRID_MAX_FOOTPRINT);
    scalars!(FADE_START_SQUARED, SHADOW_DARKNESS);
    let [key, sky] = look::ALL_OPEN;
    let _ = writeln!(text, "const ALL_OPEN = vec2<f32>({key:?}, {sky:?});");
    let _ = writeln!(
        text,
        "const KEY_MAP_SIDE: i32 = {};",
        mutual_shade::KEY_MAP_SIDE
    );
    for (name, value) in [
        ("LIFT", mutual_shade::LIFT),
        ("RAMP", mutual_shade::RAMP),
        ("UNKNOWN", mutual_shade::UNKNOWN),
    ] {
        let _ = writeln!(text, "const {name}: f32 = {value:?};");
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use wgpu::naga;

    fn module(samples: u32) -> naga::Module {
        let text = shader_source(samples);
        naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)))
    }

    #[test]
    fn the_shaders_need_no_more_than_shading_by_samples() {
        let flags = naga::valid::ValidationFlags::all();
        let capabilities = naga::valid::Capabilities::MULTISAMPLED_SHADING;
        for samples in [1, 4, 16] {
            naga::valid::Validator::new(flags, capabilities)
                .validate(&module(samples))
                .unwrap();
        }
    }

    #[test]
    fn all_entry_points_are_there() {
        let module = module(4);
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
            "lines_vertex",
            "lines_fragment",
            "lines_over_fragment",
            "peel",
        ] {
            assert!(names.contains(&name), "{name} of {names:?}");
        }
    }

    /// Every constant of the look is defined in the shaders and used by them.
    #[test]
    fn no_constant_of_the_look_is_missing() {
        let constants = shader_constants();
        let shaders = shader_source(4).split_off(constants.len());
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
