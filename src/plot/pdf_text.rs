//! Texts in the standard PDF fonts: codes and widths of characters.

/// A run of letters in one font and size.
#[derive(Clone, Debug, PartialEq)]
pub struct TextRun {
    /// Name of the face in the document: `H` Helvetica, `S` Symbol.
    pub face: char,
    /// Codes in the face.
    pub codes: Vec<u8>,
    /// Width in sizes of the text's font.
    pub width: f64,
    /// Size over that of the text.
    pub scale: f64,
    /// Depth below the baseline, in sizes of the text's font.
    pub drop: f64,
}

/// Size and drop of subscripts.
const SUBSCRIPT: [f64; 2] = [0.66, 0.16];

/// Widths of Helvetica from the blank to the tilde, in thousandths (Adobe's font metrics).
const HELVETICA: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

/// Letters of Symbol: character, code, width in thousandths.
const SYMBOL: [(char, u8, u16); 38] = [
    ('α', 0x61, 631),
    ('β', 0x62, 549),
    ('χ', 0x63, 549),
    ('δ', 0x64, 494),
    ('ε', 0x65, 439),
    ('φ', 0x66, 521),
    ('γ', 0x67, 411),
    ('η', 0x68, 603),
    ('ι', 0x69, 329),
    ('κ', 0x6b, 549),
    ('λ', 0x6c, 549),
    ('μ', 0x6d, 576),
    ('ν', 0x6e, 521),
    ('ο', 0x6f, 549),
    ('π', 0x70, 549),
    ('θ', 0x71, 521),
    ('ρ', 0x72, 549),
    ('σ', 0x73, 603),
    ('τ', 0x74, 439),
    ('υ', 0x75, 576),
    ('ω', 0x77, 686),
    ('ξ', 0x78, 493),
    ('ψ', 0x79, 686),
    ('ζ', 0x7a, 494),
    ('Γ', 0x47, 603),
    ('Δ', 0x44, 612),
    ('Θ', 0x51, 741),
    ('Λ', 0x4c, 686),
    ('Ξ', 0x58, 645),
    ('Π', 0x50, 768),
    ('Σ', 0x53, 592),
    ('Υ', 0xa1, 620),
    ('Φ', 0x46, 763),
    ('Ψ', 0x59, 795),
    ('Ω', 0x57, 768),
    ('\u{2212}', 0x2d, 549),
    ('≤', 0xa3, 549),
    ('≥', 0xb3, 549),
];

/// Width of the letters of WinAnsi beyond ASCII: those that labels hold are about as wide as a digit.
const OTHER: u16 = 556;

/// One letter.
struct Letter {
    face: char,
    code: u8,
    width: f64,
    is_below: bool,
}

/// A text in runs.
pub fn text_runs(text: &str) -> Vec<TextRun> {
    let mut runs: Vec<TextRun> = Vec::new();
    for letter in text.chars().map(find_letter) {
        let [scale, drop] = if letter.is_below {
            SUBSCRIPT
        } else {
            [1.0, 0.0]
        };
        match runs.last_mut() {
            Some(run) if run.face == letter.face && run.scale == scale => {
                run.codes.push(letter.code);
                run.width += letter.width * scale;
            }
            _ => runs.push(TextRun {
                face: letter.face,
                codes: vec![letter.code],
                width: letter.width * scale,
                scale,
                drop,
            }),
        }
    }
    runs
}

/// Width of a text in sizes of its font.
pub fn text_width(text: &str) -> f64 {
    text_runs(text).iter().map(|run| run.width).sum()
}

/// The code of a character; a question mark if neither font has it.
fn find_letter(c: char) -> Letter {
    if let Some(digit) = u32::from(c).checked_sub(u32::from('₀')).filter(|d| *d < 10) {
        let code = b'0' + digit as u8;
        return Letter {
            is_below: true,
            ..find_letter(char::from(code))
        };
    }
    if let Some((_, code, width)) = SYMBOL.iter().find(|(known, ..)| *known == c) {
        return Letter {
            face: 'S',
            code: *code,
            width: f64::from(*width) / 1000.0,
            is_below: false,
        };
    }
    let (code, width) = match c {
        ' '..='~' => (c as u8, HELVETICA[c as usize - 32]),
        '°' => (0xb0, 400),
        '·' => (0xb7, 278),
        '\u{a1}'..='ÿ' => (c as u8, OTHER),
        _ => (b'?', OTHER),
    };
    Letter {
        face: 'H',
        code,
        width: f64::from(width) / 1000.0,
        is_below: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greek_and_subscripts_have_faces_of_their_own() {
        let runs = text_runs("β₁ = −2°");
        let codes: Vec<(char, &[u8])> = runs.iter().map(|r| (r.face, r.codes.as_slice())).collect();
        assert_eq!(
            codes,
            [
                ('S', &[0x62][..]),
                ('H', b"1"),
                ('H', b" = "),
                ('S', b"-"),
                ('H', &[b'2', 0xb0])
            ]
        );
        assert!((text_width("ab") - 1.112).abs() < 1e-12);
        assert!(text_width("₁") < text_width("1"));
    }
}
