//! Files on disk: complete or not there at all, whatever fails.

use crate::frames;
use crate::frames::{flat, run, shaded, sink};
use image::RgbaImage;
use mechanim::export::error::PipelineError;
use mechanim::export::format::FramePattern;
use mechanim::export::frame_pipeline::write_frames;
use mechanim::export::png::{Effort, PngSettings, SequenceSink, StillSink};
use mechanim::export::sampled_frames::draw_samples;
use mechanim::export::{ExportError, Output, PendingFile, Stream};
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

fn opaque(size: [u32; 2], effort: Effort) -> PngSettings {
    PngSettings {
        size,
        effort,
        alpha: false,
        dpi: None,
        texts: Vec::new(),
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// A target whose disk is full after `left` bytes.
struct FullDisk {
    inner: PendingFile,
    left: usize,
}

impl Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let taken = self.inner.write(&bytes[..bytes.len().min(self.left)])?;
        self.left -= taken;
        Ok(taken)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl Output for FullDisk {
    fn name(&self) -> &str {
        Output::name(&self.inner)
    }
    fn commit(self: Box<Self>) -> Result<(), ExportError> {
        self.inner.commit()
    }
}

#[derive(Debug, thiserror::Error)]
#[error("no pose")]
struct NoPose;

type Draw<'a> = Box<dyn FnMut(usize, &mut RgbaImage) -> Result<(), NoPose> + Send + 'a>;

#[test]
fn a_file_appears_only_when_committed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    std::fs::write(&path, "old").unwrap();
    let mut target = PendingFile::create(&path).unwrap();
    target.write_all(b"half").unwrap();
    target.flush().unwrap();
    drop(target);
    assert_eq!(
        (names(folder.path()), std::fs::read(&path).unwrap()),
        (vec!["a.gif".to_owned()], b"old".to_vec())
    );
    let mut target = PendingFile::create(&path).unwrap();
    target.write_all(b"whole").unwrap();
    target.commit().unwrap();
    assert_eq!(
        (names(folder.path()).len(), std::fs::read(&path).unwrap()),
        (1, b"whole".to_vec())
    );
}

#[cfg(unix)]
#[test]
fn links_devices_and_permissions_are_respected() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("plain"), "").unwrap();
    symlink(at("plain"), at("link")).unwrap();
    let put = |path: &Path| {
        let mut target = PendingFile::create(path).unwrap();
        target.write_all(b"new").unwrap();
        target.commit().unwrap();
    };
    put(&at("link"));
    assert!(std::fs::symlink_metadata(at("link")).unwrap().is_symlink());
    assert_eq!(std::fs::read(at("plain")).unwrap(), b"new");
    put(Path::new("/dev/null"));
    assert!(
        std::fs::metadata("/dev/null")
            .unwrap()
            .file_type()
            .is_char_device()
    );
    // What an ordinary new file gets, not a temporary file's 0600.
    std::fs::write(at("ordinary"), "").unwrap();
    put(&at("ours"));
    let mode = |name: &str| std::fs::metadata(at(name)).unwrap().permissions().mode();
    assert_eq!(mode("ours"), mode("ordinary"));
    std::fs::set_permissions(at("ours"), std::fs::Permissions::from_mode(0o444)).unwrap();
    assert!(matches!(
        PendingFile::create(&at("ours")),
        Err(ExportError::ReadOnly(_))
    ));
}

#[test]
fn impossible_places_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: &Path| PendingFile::create(path).err().unwrap().to_string();
    let text = message(&folder.path().join("no/such/a.gif"));
    assert!(
        text.contains("a.gif")
            && text.contains(&format!(
                "{} does not exist",
                folder.path().join("no/such").display()
            ))
    );
    assert!(message(folder.path()).contains("it is a folder"));
    std::fs::write(folder.path().join("file"), "").unwrap();
    let text = message(&folder.path().join("file/a.gif"));
    assert!(
        text.contains("file/a.gif") && !text.contains(".part"),
        "{text}"
    );
}

#[test]
fn a_full_disk_leaves_no_file_wherever_it_fills() {
    let folder = tempfile::tempdir().unwrap();
    for left in [0, 5, 700, 800, 3000, 8000] {
        let inner = PendingFile::create(&folder.path().join("a.gif")).unwrap();
        let output = Box::new(FullDisk { inner, left });
        let settings = frames::settings(&shaded(0), 25.0, 30, 100);
        let palette = std::sync::Arc::new(frames::palette(shaded, 30));
        let outcome = match mechanim::export::gif::GifSink::new(output, settings, palette) {
            Err(error) => Err(PipelineError::Export(error)),
            Ok(sink) => run(2, 30, shaded, Box::new(sink)),
        };
        let error = outcome.unwrap_err().to_string();
        assert!(
            error.contains("a.gif") && error.contains("no storage space"),
            "{error}"
        );
        assert_eq!(names(folder.path()), Vec::<String>::new());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_that_is_full_is_reported() {
    let mut target = PendingFile::create(Path::new("/dev/full")).unwrap();
    target.write_all(&[0; 100]).unwrap();
    assert!(matches!(target.commit(), Err(ExportError::Write { .. })));
}

#[test]
fn a_frame_that_cannot_be_drawn_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = Box::new(PendingFile::create(&folder.path().join("a.gif")).unwrap());
    let worker = || -> Draw {
        Box::new(|k, image| {
            image.copy_from_slice(flat(k).as_raw());
            if k == 17 { Err(NoPose) } else { Ok(()) }
        })
    };
    let workers = vec![worker(), worker()];
    let sink = sink(output, flat, 40, 100);
    let error = write_frames(
        workers,
        40,
        Vec::new(),
        sink,
        &|_, _| {},
        &AtomicBool::new(false),
    )
    .unwrap_err();
    assert!(
        matches!(error, PipelineError::Draw { frame: 17, .. }),
        "{error}"
    );
    assert!(names(folder.path()).is_empty());
}

#[test]
fn cancelling_stops_soon_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (cancel, drawn) = (AtomicBool::new(false), AtomicUsize::new(0));
    let worker = || -> Draw<'_> {
        Box::new(|k, image| {
            drawn.fetch_add(1, Ordering::Relaxed);
            image.copy_from_slice(flat(k).as_raw());
            Ok(())
        })
    };
    let stop_at = |done, _| cancel.store(done >= 10, Ordering::Relaxed);
    let output = Box::new(PendingFile::create(&folder.path().join("a.gif")).unwrap());
    let outcome = write_frames(
        vec![worker(), worker()],
        1000,
        Vec::new(),
        sink(output, flat, 1000, 100),
        &stop_at,
        &cancel,
    );
    assert!(matches!(outcome, Err(PipelineError::Cancelled)));
    assert!(names(folder.path()).is_empty());
    // The window of two workers, no more.
    assert!(
        drawn.load(Ordering::Relaxed) <= 10 + 6,
        "{}",
        drawn.load(Ordering::Relaxed)
    );

    cancel.store(false, Ordering::Relaxed);
    let pattern = FramePattern::parse(&folder.path().join("shots/f%d.png")).unwrap();
    let sequence = Box::new(SequenceSink::new(pattern, opaque([20, 14], Effort::Fast)).unwrap());
    assert!(folder.path().join("shots").is_dir());
    let outcome = write_frames(
        vec![worker()],
        1000,
        Vec::new(),
        sequence,
        &stop_at,
        &cancel,
    );
    assert!(matches!(outcome, Err(PipelineError::Cancelled)));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_sequence_is_lossless_numbered_and_keeps_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("f-001.png"), "old").unwrap();
    std::fs::write(folder.path().join("notes.txt"), "").unwrap();
    let open = || {
        let pattern = FramePattern::parse(&folder.path().join("f-%03d.png")).unwrap();
        SequenceSink::new(pattern, opaque([96, 72], Effort::Fast)).unwrap()
    };
    // A run that breaks off takes its own new files away again, and only those.
    drop(open());
    let cancel = AtomicBool::new(false);
    let worker: Draw = Box::new(|k, image| {
        image.copy_from_slice(shaded(k).as_raw());
        if k == 3 { Err(NoPose) } else { Ok(()) }
    });
    write_frames(
        vec![worker],
        5,
        Vec::new(),
        Box::new(open()),
        &|_, _| {},
        &cancel,
    )
    .unwrap_err();
    assert_eq!(names(folder.path()), ["f-001.png", "notes.txt"]);
    let summary = run(3, 5, shaded, Box::new(open())).unwrap();
    assert_eq!(
        names(folder.path()),
        [
            "f-000.png",
            "f-001.png",
            "f-002.png",
            "f-003.png",
            "f-004.png",
            "notes.txt"
        ]
    );
    let bytes = |k: usize| std::fs::read(folder.path().join(format!("f-{k:03}.png"))).unwrap();
    assert_eq!(
        summary.bytes,
        (0..5).map(|k| bytes(k).len() as u64).sum::<u64>()
    );
    for k in 0..5 {
        let decoded = image::load_from_memory(&bytes(k)).unwrap();
        assert_eq!(decoded.color(), image::ColorType::Rgb8);
        assert_eq!(decoded.to_rgba8(), shaded(k));
    }
}

#[test]
fn a_sequence_needs_the_folder_above_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let pattern = FramePattern::parse(&folder.path().join("no/such/f%d.png")).unwrap();
    let error = SequenceSink::new(pattern, opaque([4, 4], Effort::Fast))
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("no does not exist"), "{error}");
}

#[test]
fn a_still_takes_exactly_one_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let open = || {
        let output = Box::new(PendingFile::create(&path).unwrap());
        Box::new(StillSink::new(output, opaque([96, 72], Effort::Balanced)).unwrap())
    };
    assert!(matches!(
        run(1, 2, shaded, open()),
        Err(PipelineError::Export(ExportError::FrameCount {
            got: 2,
            ..
        }))
    ));
    assert!(matches!(
        run(1, 0, shaded, open()),
        Err(PipelineError::Export(ExportError::FrameCount {
            got: 0,
            ..
        }))
    ));
    assert!(!path.exists());
    run(1, 1, shaded, open()).unwrap();
    let first = std::fs::read(&path).unwrap();
    assert_eq!(
        image::load_from_memory(&first).unwrap().to_rgba8(),
        shaded(0)
    );
    run(1, 1, shaded, open()).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), first);
}

#[test]
fn a_broken_pipe_is_recognised() {
    struct Broken;
    impl Write for Broken {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::BrokenPipe.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let output = Box::new(Stream::new("standard output", Broken));
    let sink = StillSink::new(output, opaque([20, 14], Effort::Balanced)).unwrap();
    match run(1, 1, flat, Box::new(sink)).unwrap_err() {
        PipelineError::Export(error) => {
            assert!(error.is_broken_pipe() && error.to_string().contains("standard output"))
        }
        other => panic!("{other}"),
    }
}

#[test]
fn samples_come_in_order_and_are_not_drawn_again() {
    let drawn = AtomicUsize::new(0);
    let worker = || -> Draw<'_> {
        Box::new(|k, image| {
            drawn.fetch_add(1, Ordering::Relaxed);
            image.copy_from_slice(flat(k).as_raw());
            Ok(())
        })
    };
    let mut workers = vec![worker(), worker(), worker()];
    let cancel = AtomicBool::new(false);
    let samples = draw_samples(&mut workers, &[0, 7, 3, 19], [20, 14], &cancel).unwrap();
    let order: Vec<usize> = samples.iter().map(|s| s.0).collect();
    assert_eq!(order, [0, 7, 3, 19]);
    assert!(samples.iter().all(|(k, image)| *image == flat(*k)));
    let sink = sink(Box::new(Stream::new("memory", Vec::new())), flat, 20, 100);
    write_frames(workers, 20, samples, sink, &|_, _| {}, &cancel).unwrap();
    assert_eq!(drawn.load(Ordering::Relaxed), 20);
    let nobody: Vec<Draw> = Vec::new();
    let sink = frames::sink(Box::new(Stream::new("memory", Vec::new())), flat, 20, 100);
    assert!(matches!(
        write_frames(nobody, 20, Vec::new(), sink, &|_, _| {}, &cancel),
        Err(PipelineError::NoWorkers)
    ));
}

#[test]
fn a_panicking_worker_is_not_waited_for() {
    let outcome = std::panic::catch_unwind(|| {
        let worker: Draw = Box::new(|_, _| panic!("planted"));
        let sink = sink(Box::new(Stream::new("memory", Vec::new())), flat, 20, 100);
        write_frames(
            vec![worker],
            20,
            Vec::new(),
            sink,
            &|_, _| {},
            &AtomicBool::new(false),
        )
        .is_ok()
    });
    assert!(outcome.is_err());
}
