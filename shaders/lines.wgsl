// Lines between surfaces: src/render/edges.rs and src/render/cpu/outlines.rs, one to one. Every pixel reads the surfaces
// and nearnesses of its own samples and of those within half a line's width. SAMPLES, PLACES, the texture SURFACES and
// the function `surface_words` come in front of this text.

struct Shown {
    surface: u32,
    nearness: f32,
}

fn shown(pixel: vec2<i32>, index: i32) -> Shown {
    let words = surface_words(pixel, index);
    return Shown(words.x | (words.y << 16u), bitcast<f32>(words.z | (words.w << 16u)));
}

// The four words in which a surface and its nearness are stored.
fn surface_store(surface: u32, nearness: f32) -> vec4<u32> {
    let bits = bitcast<u32>(nearness);
    return vec4<u32>(surface & 0xffffu, surface >> 16u, bits & 0xffffu, bits >> 16u);
}

@vertex
fn lines_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(select(-1.0, 3.0, index == 1u), select(-1.0, 3.0, index == 2u), 0.0, 1.0);
}

// Whether the surface falls back before a sample, a line's reach to both sides along `step`.
fn falls(pixel: vec2<i32>, step: vec2<i32>, size: vec2<i32>, index: i32, own: Shown, limit: f32) -> bool {
    let before = pixel - step;
    let after = pixel + step;
    if (any(before < vec2<i32>(0)) || any(after >= size)) {
        return false;
    }
    let a = shown(before, index);
    let b = shown(after, index);
    return a.surface == own.surface && b.surface == own.surface
        && a.nearness + b.nearness - 2.0 * own.nearness < -limit;
}

// The ink in a pixel; with `over` only that of lines with a translucent side.
fn inked(at: vec4<f32>, over: bool) -> vec4<f32> {
    let least = select(FIRST, TRANSLUCENT, over);
    let pixel = vec2<i32>(at.xy);
    let size = vec2<i32>(textureDimensions(surfaces));
    let reach = i32(globals.lines.y);
    var count = 0;
    for (var s = 0; s < SAMPLES; s++) {
        let own = shown(pixel, s);
        if (own.surface == NO_LINES) {
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
                        let other = shown(there, t).surface;
                        let is_over = max(other, own.surface) >= TRANSLUCENT;
                        marked = marked || (other != own.surface && other != NO_LINES && (!over || is_over));
                    }
                }
            }
        }
        if (!marked && own.surface >= least) {
            let limit = select(globals.lines.z, globals.lines.z * own.nearness, globals.up.w > 0.5);
            marked = falls(pixel, vec2<i32>(reach, 0), size, s, own, limit)
                || falls(pixel, vec2<i32>(0, reach), size, s, own, limit);
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
