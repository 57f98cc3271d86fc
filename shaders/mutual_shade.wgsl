// How bodies shade each other: the lookups of src/render/mutual_shade, one to one. Constants come in front of this text.

// What reaches a surface of the key light and of the light around.
fn open_at(pixel: vec2<f32>, place: vec3<f32>, normal: vec3<f32>) -> vec2<f32> {
    if (globals.sky.z < 0.5) {
        return ALL_OPEN;
    }
    return vec2<f32>(key_lit(place, normal), sky_open(pixel, -place.z));
}

fn spline_weights(t: f32) -> vec4<f32> {
    let s = 1.0 - t;
    let t2 = t * t;
    let t3 = t2 * t;
    return vec4<f32>(
        s * s * s / 6.0,
        (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0,
        (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0,
        t3 / 6.0,
    );
}

fn key_lit(place: vec3<f32>, normal: vec3<f32>) -> f32 {
    let facing = dot(normal, KEY_DIRECTION);
    if (facing <= KEY_GRAZING) {
        return 1.0;
    }
    let point = vec4<f32>(place, 1.0);
    let at = vec2<f32>(dot(globals.key_x, point), dot(globals.key_y, point));
    let last = f32(KEY_MAP_SIDE - 3);
    if (!(all(at > vec2<f32>(2.0)) && all(at < vec2<f32>(last)))) {
        return 1.0;
    }
    let slope = vec2<f32>(-dot(normal, KEY_RIGHT), -dot(normal, KEY_UP)) / facing;
    let plane = dot(globals.key_height, point) + LIFT / facing;
    let first = vec2<i32>(at - 0.5) - 1;
    let off = at - (vec2<f32>(first) + 0.5);
    let along = spline_weights(off.x - 1.0);
    let down = spline_weights(off.y - 1.0);
    var shaded = 0.0;
    for (var row = 0; row < 4; row++) {
        for (var column = 0; column < 4; column++) {
            let height = textureLoad(key_heights, first + vec2<i32>(column, row), 0).r;
            let above = height - plane - dot(slope, vec2<f32>(f32(column), f32(row)) - off);
            shaded += saturate(above / RAMP) * along[column] * down[row];
        }
    }
    return 1.0 - shaded;
}

fn sky_open(pixel: vec2<f32>, distance: f32) -> f32 {
    let last = vec2<i32>(textureDimensions(sky_cells)) - 1;
    let cell = clamp(pixel / globals.sky.x - 0.5, vec2<f32>(0.0), vec2<f32>(last));
    let first = vec2<i32>(cell);
    let off = cell - vec2<f32>(first);
    var sum = vec2<f32>(UNKNOWN);
    for (var k = 0; k < 4; k++) {
        let step = vec2<i32>(k & 1, k >> 1u);
        let there = textureLoad(sky_cells, min(first + step, last), 0).rg;
        let weight = mix(1.0 - off, off, vec2<f32>(step));
        let likeness = max(1.0 - abs(there.r - distance) * globals.sky.y, 0.0);
        let share = weight.x * weight.y * likeness;
        sum += share * vec2<f32>(there.g, 1.0);
    }
    return sum.x / sum.y;
}
