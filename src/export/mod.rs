//! Files out of frames. Knows nothing of mechanisms; the only room with image encoders.
