//! Colours of background and text: the defaults for everything except bodies and traces.

/// Light paper for documents, dark paper for slides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Theme {
    #[default]
    Light,
    Dark,
}

impl Theme {
    /// Names in files and options.
    pub const NAMES: [(&'static str, Self); 2] = [("light", Self::Light), ("dark", Self::Dark)];

    /// sRGB colour behind everything.
    pub const fn background(self) -> [u8; 3] {
        match self {
            Self::Light => [0xf5, 0xf6, 0xf8],
            Self::Dark => [0x16, 0x1a, 0x20],
        }
    }

    /// sRGB colour of titles and labels.
    pub const fn ink(self) -> [u8; 3] {
        match self {
            Self::Light => [0x2b, 0x2f, 0x36],
            Self::Dark => [0xe8, 0xea, 0xee],
        }
    }

    /// sRGB colour of values and scales, which are less prominent.
    pub const fn faint_ink(self) -> [u8; 3] {
        match self {
            Self::Light => [0x5a, 0x62, 0x6e],
            Self::Dark => [0xa3, 0xab, 0xb8],
        }
    }

    /// sRGB colour of the lines between surfaces.
    pub const fn line(self) -> [u8; 3] {
        match self {
            Self::Light => [0x1b, 0x1f, 0x26],
            Self::Dark => [0x05, 0x07, 0x0a],
        }
    }

    /// sRGB colour of warnings.
    pub const fn warning(self) -> [u8; 3] {
        match self {
            Self::Light => [0xb4, 0x53, 0x09],
            Self::Dark => [0xf5, 0xa6, 0x4a],
        }
    }
}
