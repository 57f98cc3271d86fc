//! Colours of charts, light and dark. The curves' colours can be told apart without colour vision.

/// sRGB with opacity.
pub type Colour = [u8; 4];

/// The colours of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartTheme {
    /// Behind everything.
    pub background: Colour,
    /// Titles, labels, numbers.
    pub text: Colour,
    /// Notes and words of events.
    pub faint_text: Colour,
    /// Frame and tick marks.
    pub axis: Colour,
    /// Grid lines.
    pub grid: Colour,
    /// Lines of events.
    pub event: Colour,
    /// Ranges without values.
    pub shade: Colour,
    /// Hatching of these.
    pub hatch: Colour,
    /// Reference points and lines.
    pub mark: Colour,
    /// Curves, in order.
    pub series: [Colour; 8],
}

/// Opaque.
const fn rgb_colour(code: u32) -> Colour {
    [(code >> 16) as u8, (code >> 8) as u8, code as u8, 255]
}

impl ChartTheme {
    /// Dark on white. The curves are those of Okabe and Ito (Color Universal Design, 2008), whose yellow is
    /// replaced: it cannot be seen on white.
    pub const LIGHT: Self = Self {
        background: rgb_colour(0xffffff),
        text: rgb_colour(0x1f2328),
        faint_text: rgb_colour(0x59636e),
        axis: rgb_colour(0x59636e),
        grid: rgb_colour(0xe4e8ec),
        event: rgb_colour(0x8a939c),
        shade: rgb_colour(0xf1ecea),
        hatch: rgb_colour(0xd8cfcb),
        mark: rgb_colour(0x59636e),
        series: [
            rgb_colour(0x0072b2),
            rgb_colour(0xd55e00),
            rgb_colour(0x009e73),
            rgb_colour(0xcc79a7),
            rgb_colour(0xe69f00),
            rgb_colour(0x56b4e9),
            rgb_colour(0x4d4d4d),
            rgb_colour(0x882255),
        ],
    };

    /// Light on nearly black.
    pub const DARK: Self = Self {
        background: rgb_colour(0x15181c),
        text: rgb_colour(0xe6e9ec),
        faint_text: rgb_colour(0xa3abb3),
        axis: rgb_colour(0x8a939c),
        grid: rgb_colour(0x2a2f35),
        event: rgb_colour(0x77808a),
        shade: rgb_colour(0x241f1e),
        hatch: rgb_colour(0x453b38),
        mark: rgb_colour(0xa3abb3),
        series: [
            rgb_colour(0x56b4e9),
            rgb_colour(0xe69f00),
            rgb_colour(0x2fc08f),
            rgb_colour(0xe58fc0),
            rgb_colour(0xf0e442),
            rgb_colour(0xff7b4a),
            rgb_colour(0xc8ccd0),
            rgb_colour(0xb39ddb),
        ],
    };

    /// Colour of curve `index`.
    pub fn colour(&self, index: usize) -> Colour {
        self.series[index % self.series.len()]
    }

    /// Dashes of curve `index` in units of its width: those after the last colour begin anew, dashed.
    pub fn dashes(&self, index: usize) -> Dashes {
        match index / self.series.len() {
            0 => Dashes::None,
            1 => Dashes::Long,
            _ => Dashes::Short,
        }
    }
}

/// Interruptions of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dashes {
    /// None.
    None,
    /// Four widths long.
    Long,
    /// Two widths long.
    Short,
}

impl Dashes {
    /// Lengths of dash and gap in pixels for a line `width` wide.
    pub fn lengths(self, width: f64) -> Option<[f64; 2]> {
        match self {
            Self::None => None,
            Self::Long => Some([4.0 * width, 2.5 * width]),
            Self::Short => Some([2.0 * width, 2.0 * width]),
        }
    }
}
