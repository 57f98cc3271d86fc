// The next layer of what is translucent: of each sample the farthest fragment before the layer behind it, whose depths
// are bound.

@fragment
fn peel(in: BodyVertex, @builtin(sample_index) sample: u32) {
    if (in.clip.z <= depth_at(vec2<i32>(in.clip.xy), i32(sample))) {
        discard;
    }
}
