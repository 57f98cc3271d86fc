// The ground: one triangle over the whole picture whose depth is the plane's, so that bodies cut it exactly.

@vertex
fn ground_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(select(-1.0, 3.0, index == 1u), select(-1.0, 3.0, index == 2u));
    let depth = globals.ground_depth.x * corner.x + globals.ground_depth.y * corner.y + globals.ground_depth.z;
    return vec4<f32>(corner, depth, 1.0);
}

@fragment
fn ground_fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    // The centre of the pixel, also where samples are shaded one by one.
    let at = vec3<f32>(floor(pixel.xy) + 0.5, 1.0);
    let w = dot(globals.ground_w.xyz, at);
    if (w <= 0.0) {
        discard;
    }
    let plane = vec2<f32>(dot(globals.ground_u.xyz, at), dot(globals.ground_v.xyz, at)) / w;
    let share = dot(plane, plane);
    if (!(share < 1.0)) {
        discard;
    }
    var lines = 0.0;
    let pitch = globals.ground_depth.w;
    if (pitch > 0.0) {
        let step_u = abs(globals.ground_u.xy - plane.x * globals.ground_w.xy) / w;
        let step_v = abs(globals.ground_v.xy - plane.y * globals.ground_w.xy) / w;
        lines = max(
            grid_line(plane.x / pitch, (step_u.x + step_u.y) / pitch),
            grid_line(plane.y / pitch, (step_v.x + step_v.y) / pitch),
        );
    }
    let shadow = textureSampleLevel(shadow_texels, shadow_sampler, 0.5 + 0.5 * plane, 0.0).r;
    let factor = ground_factor(ground_fade(share), lines, shadow);
    return vec4<f32>(globals.background.rgb * factor, 1.0);
}
