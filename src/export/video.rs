//! Compressed video and animated WebP by the program `ffmpeg`, which takes raw frames from a pipe and writes the file beside its place.

use super::error::ExportError;
use super::format::VideoKind;
use super::raw::{Chroma, RawKind, RawSink};
use super::target::{Output, PendingFile, register_writer};
use super::{ExportSummary, FrameCoder, FrameSink};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// The encoder, searched for on the system's path.
const ENCODER: &str = "ffmpeg";

/// How often the state of the encoder is polled.
const LOOK: Duration = Duration::from_millis(2);

/// Maximum bytes of its error messages that are kept.
const MOST_WORDS: u64 = 1 << 12;

/// Frames arrive as 4:4:4 with limited range and the colours of BT.709, and are converted to what players expect: 4:2:0
/// with even sides, for which an odd side loses its last row.
const FILTERS: &str = "crop=trunc(iw/2)*2:trunc(ih/2)*2:0:0,format=yuv420p,\
    setparams=range=tv:colorspace=bt709:color_primaries=bt709:color_trc=bt709";

/// The same as RGB, as pictures have it: nothing is lost after the frames have arrived.
const FILTERS_OF_PICTURES: &str = "setparams=range=tv:colorspace=bt709,\
    scale=in_color_matrix=bt709:in_range=tv,format=bgra";

/// Filters, then codec, quality (drawn edges stay clean) and container.
fn arguments(kind: VideoKind) -> (&'static str, Vec<&'static str>) {
    let (filters, text) = match kind {
        VideoKind::Mp4 => (FILTERS, "-c:v libx264 -crf 16 -movflags +faststart -f mp4"),
        VideoKind::Webm => (FILTERS, "-c:v libvpx-vp9 -crf 24 -b:v 0 -row-mt 1 -f webm"),
        VideoKind::Webp => (
            FILTERS_OF_PICTURES,
            "-c:v libwebp_anim -lossless 1 -loop 0 -f webp",
        ),
    };
    (filters, text.split(' ').collect())
}

/// A video under construction: bytes go to the encoder, and its file is moved to its place when it has succeeded.
pub struct VideoFile {
    name: String,
    encoder: Arc<Mutex<Child>>,
    input: Option<BufWriter<ChildStdin>>,
    words: Option<JoinHandle<String>>,
    target: Option<PendingFile>,
}

impl VideoFile {
    /// Starts the encoder of a video at `path`.
    ///
    /// Errors: as [`PendingFile::create`]; a device or a pipe; there is no encoder.
    pub fn create(path: &Path, kind: VideoKind) -> Result<Self, ExportError> {
        let target = PendingFile::create(path)?;
        let Some(temporary) = target.temporary() else {
            return Err(ExportError::NoSeek(path.to_owned()));
        };
        let mut command = Command::new(ENCODER);
        command.args(["-hide_banner", "-nostdin", "-loglevel", "error", "-y"]);
        let (filters, codec) = arguments(kind);
        command.args(["-f", "yuv4mpegpipe", "-i", "pipe:0", "-an", "-vf", filters]);
        command.args(["-fflags", "+bitexact", "-flags:v", "+bitexact"]);
        command.args(codec);
        // The path is passed as a file name, whatever it looks like.
        command.arg(in_protocol(temporary));
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        stay_apart(&mut command);
        let mut encoder = command.spawn().map_err(|source| ExportError::NoEncoder {
            path: path.to_owned(),
            program: ENCODER,
            source,
        })?;
        let input = encoder.stdin.take().map(BufWriter::new);
        let words = encoder.stderr.take().map(|stderr| {
            std::thread::spawn(move || {
                let mut text = Vec::new();
                let mut rest = stderr;
                // Output beyond the limit is still read, so that the encoder is not blocked.
                let _ = rest.by_ref().take(MOST_WORDS).read_to_end(&mut text);
                let _ = io::copy(&mut rest, &mut io::sink());
                String::from_utf8_lossy(&text).trim().to_owned()
            })
        });
        let encoder = Arc::new(Mutex::new(encoder));
        register_writer(&encoder);
        Ok(Self {
            name: path.display().to_string(),
            input,
            encoder,
            words,
            target: Some(target),
        })
    }

    fn child(&self) -> MutexGuard<'_, Child> {
        self.encoder.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends the input and waits for the encoder.
    fn ended(&mut self) -> io::Result<(ExitStatus, String)> {
        let flushed = self.input.take().map_or(Ok(()), |mut input| input.flush());
        let status = loop {
            // It can be cancelled between the checks.
            match self.child().try_wait()? {
                Some(status) => break status,
                None => std::thread::sleep(LOOK),
            }
        };
        let words = self.words.take().and_then(|words| words.join().ok());
        let words = words.unwrap_or_default();
        if status.success() {
            flushed?;
        }
        Ok((status, words))
    }

    /// The encoder's message where it accepts no more data.
    fn complaint(&mut self, source: io::Error) -> io::Error {
        match self.ended() {
            Ok((status, words)) => failure(status, &words),
            Err(_) => source,
        }
    }
}

/// The encoder's failure in its own words.
fn failure(status: ExitStatus, words: &str) -> io::Error {
    let words = match words {
        "" => "it says nothing",
        words => words,
    };
    io::Error::other(format!("{ENCODER} ended with {status}: {words}"))
}

/// A path that cannot be mistaken for an option or another protocol.
fn in_protocol(path: &Path) -> std::ffi::OsString {
    let mut name = std::ffi::OsString::from("file:");
    name.push(path);
    name
}

/// Ctrl-C is handled by this program, which ends the encoder cleanly.
#[cfg(unix)]
fn stay_apart(command: &mut Command) {
    use std::os::unix::process::CommandExt;
    command.process_group(0);
}

#[cfg(not(unix))]
fn stay_apart(_: &mut Command) {}

impl Write for VideoFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(input) = &mut self.input else {
            return Err(io::ErrorKind::NotConnected.into());
        };
        input.write(bytes).map_err(|e| self.complaint(e))
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.input.as_mut().map_or(Ok(()), Write::flush);
        flushed.map_err(|e| self.complaint(e))
    }
}

impl Output for VideoFile {
    fn name(&self) -> &str {
        &self.name
    }

    fn commit(mut self: Box<Self>) -> Result<(), ExportError> {
        let ended = self.ended();
        let (status, words) = ended.map_err(|e| ExportError::write(&self.name, e))?;
        if !status.success() {
            return Err(ExportError::write(&self.name, failure(status, &words)));
        }
        self.target.take().map_or(Ok(()), PendingFile::commit)
    }
}

impl Drop for VideoFile {
    fn drop(&mut self) {
        // Dropped without a commit, it gives up; an encoder that has ended is already gone.
        self.input = None;
        let mut encoder = self.child();
        let _ = encoder.kill();
        let _ = encoder.wait();
    }
}

/// Frames into a video.
pub struct VideoSink {
    frames: RawSink,
    path: PathBuf,
}

impl VideoSink {
    /// Begins a video of `fps` frames a second.
    ///
    /// Errors: those of [`VideoFile::create`]; a failed write.
    pub fn new(file: VideoFile, fps: f64, size: [u32; 2]) -> Result<Self, ExportError> {
        let path = PathBuf::from(&file.name);
        let kind = RawKind::Y4m {
            fps,
            chroma: Chroma::Full,
        };
        Ok(Self {
            frames: RawSink::new(Box::new(file), kind, size)?,
            path,
        })
    }
}

impl FrameSink for VideoSink {
    fn size(&self) -> [u32; 2] {
        self.frames.size()
    }

    fn coder(&self) -> Box<dyn FrameCoder> {
        self.frames.coder()
    }

    fn write(&mut self, index: usize, coded: &[u8]) -> Result<(), ExportError> {
        self.frames.write(index, coded)
    }

    fn finish(self: Box<Self>) -> Result<ExportSummary, ExportError> {
        let summary = Box::new(self.frames).finish()?;
        // Bytes of the file, not those sent through the pipe.
        let bytes = std::fs::metadata(&self.path).map_or(summary.bytes, |about| about.len());
        Ok(ExportSummary { bytes, ..summary })
    }
}
