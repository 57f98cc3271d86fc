// The formulas of src/render/look.rs, one to one. The constants come in front of this text from there.

fn rim(n_v: f32) -> f32 {
    let away = 1.0 - n_v;
    let squared = away * away;
    return squared * squared;
}

fn edge_opacity(opacity: f32, n_v: f32) -> f32 {
    return opacity + (1.0 - opacity) * (EDGE_OPACITY * rim(n_v));
}

// Directions are unit vectors in camera space; the answer is in linear light.
// `gain_loss` are those of the rim; `open` is what reaches the surface of the key light and of the light around.
fn shade(
    normal: vec3<f32>,
    to_viewer: vec3<f32>,
    up: vec3<f32>,
    gain_loss: vec2<f32>,
    albedo: vec3<f32>,
    flatness: f32,
    open: vec2<f32>,
) -> vec3<f32> {
    let n_l = dot(normal, KEY_DIRECTION);
    let n_v = max(dot(normal, to_viewer), 0.0);
    let direct = max(n_l, 0.0);
    let share = saturate((direct - KEY_GRAZING) / KEY_SHADE_FACING);
    let lost = KEY_SHADE * (1.0 - open.x) * direct * share;
    let key = (max((n_l + KEY_WRAP) / (1.0 + KEY_WRAP), 0.0) - lost) * (1.0 - SKY_SHADE * (1.0 - open.y));
    let fill = max(dot(normal, FILL_DIRECTION), 0.0);
    let sky = 0.5 + 0.5 * dot(normal, up);

    let half_sum = max(n_l + n_v, 0.0);
    let h2 = min(half_sum * half_sum / max(2.0 + 2.0 * dot(KEY_DIRECTION, to_viewer), 1e-6), 1.0);
    let h4 = h2 * h2;
    let h8 = h4 * h4;
    let h16 = h8 * h8;
    let h32 = h16 * h16;
    let glint = (SHEEN * h8 + HIGHLIGHT * (h32 * h32)) * open.x;

    let away = (1.0 - n_v) * (1.0 - n_v);
    let kept = 1.0 - gain_loss.y * away;
    let gain = gain_loss.x * (away * away);

    let around = mix(GROUND_COLOUR, SKY_COLOUR, sky) + FILL_COLOUR * fill;
    let light = (around * open.y + KEY_COLOUR * key) * kept;
    let tinted = glint * mix(vec3<f32>(1.0), albedo, GLOSS_TINT);
    let gloss = KEY_COLOUR * tinted + SKY_COLOUR * gain;
    let lit = saturate(EXPOSURE * (albedo * light + gloss));
    return mix(lit, albedo, flatness);
}

fn ground_fade(radius_share_squared: f32) -> f32 {
    let t = saturate((radius_share_squared - FADE_START_SQUARED) / (1.0 - FADE_START_SQUARED));
    return 1.0 - t * t * (3.0 - 2.0 * t);
}

fn grid_line(at: f32, footprint: f32) -> f32 {
    let off = abs(at - floor(at + 0.5));
    let cover = saturate(GRID_HALF_WIDTH + 0.5 - off / max(footprint, 1e-12));
    return cover * saturate(2.0 - footprint * (2.0 / GRID_MAX_FOOTPRINT));
}

fn ground_factor(fade: f32, lines: f32, shadow: f32, shade: vec2<f32>) -> f32 {
    return (1.0 - fade * (shade.x + shade.y * lines)) * (1.0 - fade * SHADOW_DARKNESS * shadow);
}
