// Lines between surfaces: src/render/edges.rs and src/render/cpu/outlines.rs, one to one. Every pixel reads the surfaces
// of its own samples and of those within half a line's width. SAMPLES, PLACES and the functions `surface_words` and
// `depth_at` come in front of this text.

fn surface_at(pixel: vec2<i32>, index: i32) -> u32 {
    let words = surface_words(pixel, index);
    return words.x | (words.y << 16u);
}

// Nearness of what a sample shows, affine over the screen: inverse distance in a perspective, else minus the distance.
// Of what is translucent the depth is stored beside the surface: the depth buffer has that of what is opaque.
fn nearness_at(pixel: vec2<i32>, index: i32, over: bool) -> f32 {
    var depth = depth_at(pixel, index);
    if (over) {
        let words = surface_words(pixel, index);
        depth = bitcast<f32>(words.z | (words.w << 16u));
    }
    // See `scene.wgsl` for the depth of a distance.
    if (globals.up.w > 0.5) {
        return (depth - globals.depth.x) / globals.depth.y;
    }
    return (globals.depth.y - depth) / globals.depth.x;
}

// The four words in which a surface and its depth are stored.
fn surface_store(surface: u32, depth: f32) -> vec4<u32> {
    let bits = bitcast<u32>(depth);
    return vec4<u32>(surface & 0xffffu, surface >> 16u, bits & 0xffffu, bits >> 16u);
}

@vertex
fn lines_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(select(-1.0, 3.0, index == 1u), select(-1.0, 3.0, index == 2u), 0.0, 1.0);
}

// Whether the surface falls back before a sample, a line's reach to both sides along `step`.
fn falls(pixel: vec2<i32>, step: vec2<i32>, size: vec2<i32>, index: i32, over: bool) -> bool {
    let before = pixel - step;
    let after = pixel + step;
    if (any(before < vec2<i32>(0)) || any(after >= size)) {
        return false;
    }
    let surface = surface_at(pixel, index);
    if (surface_at(before, index) != surface || surface_at(after, index) != surface) {
        return false;
    }
    let own = nearness_at(pixel, index, over);
    let limit = select(globals.lines.z, globals.lines.z * own, globals.up.w > 0.5);
    return nearness_at(before, index, over) + nearness_at(after, index, over) - 2.0 * own < -limit;
}

// The ink in a pixel; with `over` only that of lines with a translucent side.
fn inked(at: vec4<f32>, over: bool) -> vec4<f32> {
    let least = select(FIRST, TRANSLUCENT, over);
    let pixel = vec2<i32>(at.xy);
    let size = vec2<i32>(textureDimensions(surfaces));
    let reach = i32(globals.lines.y);
    var count = 0;
    for (var s = 0; s < SAMPLES; s++) {
        let own = surface_at(pixel, s);
        if (own == NO_LINES) {
            continue;
        }
        var marked = false;
        for (var dy = -reach; dy <= reach; dy++) {
            for (var dx = -reach; dx <= reach; dx++) {
                let there = pixel + vec2<i32>(dx, dy);
                if (marked || any(there < vec2<i32>(0)) || any(there >= size)) {
                    continue;
                }
                for (var t = 0; t < SAMPLES; t++) {
                    let off = vec2<f32>(f32(dx), f32(dy)) + PLACES[t] - PLACES[s];
                    if (dot(off, off) <= globals.lines.x) {
                        let other = surface_at(there, t);
                        let is_over = max(other, own) >= TRANSLUCENT;
                        marked = marked || (other != own && other != NO_LINES && (!over || is_over));
                    }
                }
            }
        }
        if (!marked && own >= least) {
            marked = falls(pixel, vec2<i32>(reach, 0), size, s, over)
                || falls(pixel, vec2<i32>(0, reach), size, s, over);
        }
        count += select(0, 1, marked);
    }
    return vec4<f32>(globals.ink.rgb, STRENGTH * f32(count) / f32(SAMPLES));
}

@fragment
fn lines_fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return inked(at, false);
}

@fragment
fn lines_over_fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return inked(at, true);
}
