//! The file format that a path selects. Creates nothing.

use super::error::ExportError;
use super::place::names_folder;
use std::path::{Path, PathBuf};

/// File name pattern used inside a folder of frames.
const FOLDER_PATTERN: &str = "frame-%04d.png";

/// Maximum zero padding of a pattern; more is a typing error.
const WIDEST_PADDING: usize = 12;

/// A kind of picture file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Format {
    /// One animated GIF.
    Gif,
    /// One animated PNG.
    Apng,
    /// One PNG picture.
    Png,
    /// One PNG file a frame.
    PngSequence(FramePattern),
    /// Uncompressed video with a header, 4:4:4.
    Y4m,
    /// Compressed video, by an external encoder.
    Video(VideoKind),
    /// Uncompressed pixels one after the other, four bytes each, no header.
    Rgba,
    /// Binary glTF: meshes, and the motion as an animation of nodes.
    Glb,
    /// Triangles of one pose, binary STL.
    Stl,
    /// Triangles of one pose by body, Wavefront OBJ.
    Obj,
}

/// Container and codec.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VideoKind {
    /// H.264 in MP4: plays everywhere.
    Mp4,
    /// VP9 in WebM: plays in browsers, free of patents.
    Webm,
    /// Animated WebP without losses: shown like a GIF, with all colours.
    Webp,
}

impl Format {
    /// Reads the format off a path: its extension, a pattern with `%d` or `%04d`, a folder (an existing one, or
    /// any path that ends with a separator).
    ///
    /// Errors: no or an unknown extension, a faulty pattern.
    pub fn from_path(path: &Path) -> Result<Self, ExportError> {
        let text = path.to_string_lossy();
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if path.is_dir()
            && extension.is_some_and(|e| Self::of_extension(&e).is_some())
            && !text.ends_with(std::path::is_separator)
        {
            return Err(ExportError::IsFolder(path.to_owned()));
        }
        if names_folder(path) {
            return FramePattern::parse(&path.join(FOLDER_PATTERN)).map(Self::PngSequence);
        }
        let name = path.file_name().map(|n| n.to_string_lossy());
        let is_pattern = name.is_some_and(|n| n.contains(['%', '#']));
        let Some(extension) = path.extension() else {
            return Err(unknown_format(path, "the file name has no extension"));
        };
        let extension = extension.to_string_lossy().to_lowercase();
        if extension == "png" && is_pattern {
            return FramePattern::parse(path).map(Self::PngSequence);
        }
        let Some(format) = Self::of_extension(&extension) else {
            return Err(unknown_format(
                path,
                &format!("unknown extension .{extension}"),
            ));
        };
        if is_pattern {
            // A faulty pattern says what is wrong with it.
            FramePattern::parse(path)?;
            let what = format.name();
            let reason = format!("{what} is one file, its name takes no frame number");
            return Err(unknown_format(path, &reason));
        }
        Ok(format)
    }

    /// The format of a file with this extension, in lower case and without the dot.
    fn of_extension(extension: &str) -> Option<Self> {
        Some(match extension {
            "gif" => Self::Gif,
            "apng" => Self::Apng,
            "png" => Self::Png,
            "y4m" => Self::Y4m,
            "mp4" => Self::Video(VideoKind::Mp4),
            "webm" => Self::Video(VideoKind::Webm),
            "webp" => Self::Video(VideoKind::Webp),
            "rgba" => Self::Rgba,
            "glb" => Self::Glb,
            "stl" => Self::Stl,
            "obj" => Self::Obj,
            _ => return None,
        })
    }

    /// Its name in messages, with an article.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Gif => "a GIF",
            Self::Apng => "an APNG",
            Self::Png => "a PNG",
            Self::PngSequence(_) => "a sequence of PNGs",
            Self::Y4m => "a y4m video",
            Self::Video(VideoKind::Mp4) => "an MP4 video",
            Self::Video(VideoKind::Webm) => "a WebM video",
            Self::Video(VideoKind::Webp) => "an animated WebP",
            Self::Rgba => "a raw video",
            Self::Glb => "a GLB",
            Self::Stl => "an STL",
            Self::Obj => "an OBJ",
        }
    }

    /// Whether the file holds a single instant of the motion.
    pub fn is_still(&self) -> bool {
        matches!(self, Self::Png | Self::Stl | Self::Obj)
    }

    /// Whether the file holds shapes in space rather than pixels.
    pub fn is_model(&self) -> bool {
        matches!(self, Self::Glb | Self::Stl | Self::Obj)
    }

    /// Whether pixels are deflated as in a PNG.
    pub fn is_png(&self) -> bool {
        matches!(self, Self::Apng | Self::Png | Self::PngSequence(_))
    }
}

/// The names of a sequence of files: `shots/frame-%04d.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl FramePattern {
    /// Parses a path whose file name holds exactly one `%d` or `%0Nd`; `%%` stands for a percent sign.
    ///
    /// Errors: another directive, none or several numbers, `#`, a number in a folder's name.
    pub fn parse(path: &Path) -> Result<Self, ExportError> {
        let refuse = |reason: &str| unknown_format(path, reason);
        let name = path.file_name().ok_or_else(|| refuse("no file name"))?;
        let name = name
            .to_str()
            .ok_or_else(|| refuse("the file name is not Unicode"))?;
        if name.contains('#') {
            return Err(refuse("write the frame number as %04d instead of #"));
        }
        // Text before, between and behind the directives; `%%` stands for itself.
        let mut parts = vec![String::new()];
        let mut digits = 0;
        let mut rest = name;
        while let Some((before, after)) = rest.split_once('%') {
            let part = parts.last_mut().ok_or_else(|| refuse("no file name"))?;
            part.push_str(before);
            if let Some(after) = after.strip_prefix('%') {
                part.push('%');
                rest = after;
                continue;
            }
            let (padding, after) = after
                .split_once('d')
                .ok_or_else(|| refuse("% must be followed by d, 04d or %"))?;
            digits = parse_padding(padding)
                .ok_or_else(|| refuse("the frame number is written %d or, zero-padded, %04d"))?;
            parts.push(String::new());
            rest = after;
        }
        if let Some(part) = parts.last_mut() {
            part.push_str(rest);
        }
        let folder = super::place::folder_of(path).to_owned();
        // Exactly two parts: one number.
        match <[String; 2]>::try_from(parts) {
            Ok([before, after]) => Ok(Self {
                folder,
                before,
                digits,
                after,
            }),
            Err(parts) if parts.len() < 2 => {
                Err(refuse("the pattern has no frame number such as %04d"))
            }
            Err(_) => Err(refuse("the pattern has more than one frame number")),
        }
    }

    /// The folder of the sequence.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Path of frame `index`.
    pub fn path(&self, index: usize) -> PathBuf {
        let (before, after, digits) = (&self.before, &self.after, self.digits);
        self.folder.join(format!("{before}{index:0digits$}{after}"))
    }
}

/// Width of a `%0Nd`: 0 for an empty text, `None` where it is not of that form.
fn parse_padding(text: &str) -> Option<usize> {
    if text.is_empty() {
        return Some(0);
    }
    let digits = text.strip_prefix('0')?;
    let plain = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    let width = digits.parse().ok().filter(|_| plain)?;
    (1..=WIDEST_PADDING).contains(&width).then_some(width)
}

fn unknown_format(path: &Path, reason: &str) -> ExportError {
    ExportError::UnknownFormat {
        path: path.to_owned(),
        reason: reason.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    fn pattern(text: &str) -> Result<FramePattern, ExportError> {
        FramePattern::parse(Path::new(text))
    }

    #[test]
    fn extensions_name_the_format_in_any_case() {
        assert_eq!(
            Format::from_path(Path::new("a/b.gif")).unwrap(),
            Format::Gif
        );
        assert_eq!(Format::from_path(Path::new("b.PNG")).unwrap(), Format::Png);
        assert_eq!(Format::from_path(Path::new("b.Glb")).unwrap(), Format::Glb);
        let video = Format::from_path(Path::new("b.MP4")).unwrap();
        assert_eq!(video, Format::Video(VideoKind::Mp4));
        for text in ["a.avi", "a", "a.gif.bak", "frame-%04d.gif", "x-%d.jpg"] {
            let message = Format::from_path(Path::new(text)).unwrap_err().to_string();
            assert!(
                message.contains(text) && message.contains(".gif, .png"),
                "{message}"
            );
        }
    }

    #[test]
    fn folders_and_patterns_are_sequences() {
        let path = |text: &str, k| match Format::from_path(Path::new(text)).unwrap() {
            Format::PngSequence(p) => p.path(k).to_string_lossy().into_owned(),
            other => panic!("{other:?}"),
        };
        assert_eq!(path("shots/", 7), "shots/frame-0007.png");
        assert_eq!(path("a/f%03d.png", 12345), "a/f12345.png");
        assert_eq!(path("%d.png", 3), "./3.png");
        assert_eq!(path("100%%-%02d.png", 3), "./100%-03.png");
        let folder = tempfile::tempdir().unwrap();
        let inside = path(folder.path().to_str().unwrap(), 0);
        assert!(inside.ends_with("frame-0000.png"), "{inside}");
    }

    #[test]
    fn faulty_patterns_are_refused_with_a_reason() {
        for (text, reason) in [
            ("f####.png", "%04d instead of #"),
            ("f%s.png", "followed by d"),
            ("f%4d.png", "%d or"),
            ("f%0d.png", "%d or"),
            ("f%099d.png", "%d or"),
            ("f%d-%d.png", "more than one"),
            ("f%%.png", "no frame number"),
            ("f%", "followed by d"),
        ] {
            let message = pattern(text).unwrap_err().to_string();
            assert!(message.contains(reason), "{text}: {message}");
        }
        for (text, reason) in [
            ("%s%s%n.gif", "followed by d"),
            ("f%%.gif", "no frame number"),
            ("f#.y4m", "%04d instead of #"),
            ("f%04d.gif", "takes no frame number"),
        ] {
            let message = Format::from_path(Path::new(text)).unwrap_err().to_string();
            assert!(message.contains(reason), "{text}: {message}");
        }
    }
}
