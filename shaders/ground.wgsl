// The ground: one triangle over the whole picture whose depth is the plane's, so that bodies cut it exactly.
//
// The part of the ground in front of the near plane would be clipped. A second instance of the triangle, in the near
// plane itself, shows it: nothing else is drawn there.

struct GroundVertex {
    @builtin(position) clip: vec4<f32>,
    // The plane's depth, above 1 in front of the near plane.
    @location(0) depth: f32,
    @location(1) @interpolate(flat) in_near_plane: u32,
}

@vertex
fn ground_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> GroundVertex {
    let corner = vec2<f32>(select(-1.0, 3.0, index == 1u), select(-1.0, 3.0, index == 2u));
    var out: GroundVertex;
    out.depth = globals.ground_depth.x * corner.x + globals.ground_depth.y * corner.y + globals.ground_depth.z;
    out.clip = vec4<f32>(corner, select(out.depth, 1.0, instance == 1u), 1.0);
    out.in_near_plane = instance;
    return out;
}

@fragment
fn ground_fragment(in: GroundVertex) -> Painted {
    // A pixel more than the part in front, since the other instance ends within pixels.
    let nearest = in.depth + fwidth(in.depth);
    if (in.in_near_plane == 1u && nearest <= 1.0) {
        discard;
    }
    // The centre of the pixel, also where samples are shaded one by one.
    let at = vec3<f32>(floor(in.clip.xy) + 0.5, 1.0);
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
    let shade = vec2<f32>(globals.ground_u.w, globals.ground_v.w);
    let factor = ground_factor(ground_fade(share), lines, shadow, shade);
    return Painted(vec4<f32>(globals.background.rgb * factor, 1.0), surface_store(BACKDROP, 0.0));
}
