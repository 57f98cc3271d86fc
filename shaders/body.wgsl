// Meshes: posed instances, lit by the common look, opaque or translucent.

struct BodyVertex {
    @builtin(position) @invariant clip: vec4<f32>,
    @location(0) place: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat) colour: vec4<f32>,
    @location(3) @interpolate(flat) flatness: f32,
    @location(4) @interpolate(flat) surface: u32,
}

// What a sample shows: its colour and, for lines, its surface and, if it is translucent, its depth.
struct Painted {
    @location(0) colour: vec4<f32>,
    @location(1) surface: vec4<u32>,
}

@vertex
fn body_vertex(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) pose_x: vec4<f32>,
    @location(3) pose_y: vec4<f32>,
    @location(4) pose_z: vec4<f32>,
    @location(5) colour: vec4<f32>,
    @location(6) flatness: f32,
    @location(7) patch_number: u32,
    // The surface of the first patch, and the step from patch to patch.
    @location(8) surface: vec2<u32>,
) -> BodyVertex {
    let point = vec4<f32>(position, 1.0);
    let place = vec3<f32>(dot(pose_x, point), dot(pose_y, point), dot(pose_z, point));
    let d = -place.z;
    var out: BodyVertex;
    out.clip = vec4<f32>(
        place.xy * globals.scale.xy,
        globals.depth.x * d + globals.depth.y,
        globals.depth.z * d + globals.depth.w,
    );
    out.place = place;
    out.normal = vec3<f32>(dot(pose_x.xyz, normal), dot(pose_y.xyz, normal), dot(pose_z.xyz, normal));
    out.colour = colour;
    out.flatness = flatness;
    out.surface = surface.x + surface.y * patch_number;
    return out;
}

// The unit direction from a point of a surface to the eye.
fn viewer_direction(place: vec3<f32>) -> vec3<f32> {
    if (globals.up.w > 0.5) {
        return -normalize(place);
    }
    return vec3<f32>(0.0, 0.0, 1.0);
}

// The unit normal on the side that is seen.
fn seen_normal(normal: vec3<f32>, front: bool) -> vec3<f32> {
    let unit = normal / max(length(normal), 1e-20);
    return select(-unit, unit, front);
}

@fragment
fn body_opaque(in: BodyVertex, @builtin(front_facing) front: bool) -> Painted {
    let normal = seen_normal(in.normal, front);
    let open = open_at(in.clip.xy, in.place, normal);
    let colour = shade(
        normal,
        viewer_direction(in.place),
        globals.up.xyz,
        globals.scale.zw,
        in.colour.rgb,
        in.flatness,
        open,
    );
    return Painted(vec4<f32>(colour, 1.0), surface_store(in.surface, 0.0));
}

// Run for every sample, which makes the depth that of the sample.
@fragment
fn body_translucent(
    in: BodyVertex,
    @builtin(front_facing) front: bool,
    @builtin(sample_index) sample: u32,
) -> Painted {
    let normal = seen_normal(in.normal, front);
    let to_viewer = viewer_direction(in.place);
    let open = open_at(in.clip.xy, in.place, normal);
    let colour = shade(normal, to_viewer, globals.up.xyz, globals.scale.zw, in.colour.rgb, in.flatness, open);
    let edge = edge_opacity(in.colour.a, max(dot(normal, to_viewer), 0.0));
    let opacity = mix(edge, in.colour.a, in.flatness);
    return Painted(vec4<f32>(colour, opacity), surface_store(in.surface, in.clip.z));
}
