// The next layer of what is translucent: of each sample the farthest fragment before the layer behind it. The texture
// BEHIND and the function `behind_at` come in front of this text.

@fragment
fn peel(in: BodyVertex SAMPLE) {
    if (in.clip.z <= behind_at(vec2<i32>(in.clip.xy), INDEX)) {
        discard;
    }
}
