//! Image comparison: how far two pictures are apart, and where.
