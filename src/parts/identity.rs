//! The identity of a study: a digest of everything that its numbers depend on.

use sha2::{Digest, Sha256};

/// Raised when the same scene and arguments give other numbers than before.
pub const NUMERICS: u32 = 17;

/// Characters of an identity: 128 bits.
const LENGTH: usize = 32;

/// A digest of named pieces, in hexadecimal. Lengths are included, so that different lists never give the same bytes.
pub fn identity(pieces: &[(&str, &[u8])]) -> String {
    let mut hasher = Sha256::new();
    hasher.update(NUMERICS.to_le_bytes());
    for (name, bytes) in pieces {
        for piece in [name.as_bytes(), bytes] {
            hasher.update((piece.len() as u64).to_le_bytes());
            hasher.update(piece);
        }
    }
    let bytes = hasher.finalize();
    let digits = bytes.iter().take(LENGTH / 2);
    digits.map(|byte| format!("{byte:02x}")).collect()
}

/// Digest that ends a part.
pub(super) fn digest(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_and_every_border_counts() {
        let of = |pieces: &[(&str, &[u8])]| identity(pieces);
        let one = of(&[("a", b"bc"), ("d", b"")]);
        assert_eq!(one.len(), LENGTH);
        assert_ne!(one, of(&[("a", b"bd"), ("d", b"")]));
        assert_ne!(one, of(&[("ab", b"c"), ("d", b"")]));
        assert_ne!(one, of(&[("a", b"bcd"), ("", b"")]));
        assert_eq!(one, of(&[("a", b"bc"), ("d", b"")]));
    }
}
