// What is the same in all draws of one picture. Mirrors `Globals` of src/render/gpu/layout.rs.

struct Globals {
    // Clip space of a point in camera space at distance d: (x * scale.x, y * scale.y, depth.x * d + depth.y,
    // depth.z * d + depth.w).
    scale: vec4<f32>,
    depth: vec4<f32>,
    // Up in camera space; w is 1 for a perspective, 0 for a parallel projection.
    up: vec4<f32>,
    // Background in linear light.
    background: vec4<f32>,
    // The ground's forms in the pixel coordinates (x right, y down): u, v, w. See src/render/ground.rs.
    // The last entries of u and v are the ground's and the grid's shade.
    ground_u: vec4<f32>,
    ground_v: vec4<f32>,
    ground_w: vec4<f32>,
    // Depth buffer value of the ground as a form in clip coordinates; w is the pitch of the grid, 0 for none.
    ground_depth: vec4<f32>,
    // Colour of lines.
    ink: vec4<f32>,
    // Square of half their width in pixels, whole pixels that they reach, and the depth that is a step.
    lines: vec4<f32>,
    // From camera space to the texels of what the key light sees, and to the height in it.
    key_x: vec4<f32>,
    key_y: vec4<f32>,
    key_height: vec4<f32>,
    // Side of a cell of the sky's map in pixels, one over the distance at which cells have nothing in common, and 1 if
    // bodies shade each other.
    sky: vec4<f32>,
}

@group(0) @binding(0) var<uniform> globals: Globals;
@group(0) @binding(1) var shadow_texels: texture_2d<f32>;
@group(0) @binding(2) var shadow_sampler: sampler;
@group(0) @binding(3) var key_heights: texture_2d<f32>;
@group(0) @binding(4) var sky_cells: texture_2d<f32>;
