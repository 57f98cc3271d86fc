//! Pictures of Newton's iterates: as many frames as the table has rows, and each one differs while the steps are seen.

use crate::program::Workspace;

#[test]
fn a_frame_for_every_iterate_with_the_earlier_ones_as_ghosts() {
    let w = Workspace::new();
    let scene = ["slider-crank", "--input", "phi=0.5", "--trace-iterations"];
    let table = w.run(&[&["solve"], &scene[..], &["--out", "-"]].concat());
    let rows = table.exits(0).text().lines().count() - 1;
    let size = ["--size", "96x72", "--out"];
    let film = [&["render"], &scene[..], &size, &["film.gif"]].concat();
    w.run(&film).exits(0);
    let still = [&["render"], &scene[..], &size, &["still.png"]].concat();
    w.run(&still).exits(0);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let bytes = w.read("film.gif");
    let mut reader = options.read_info(bytes.as_slice()).unwrap();
    let (mut frames, mut seconds) = (0, 0);
    while let Some(frame) = reader.read_next_frame().unwrap() {
        frames += 1;
        seconds += usize::from(frame.delay) / 100;
    }
    // The last step is below a sample of the picture: equal frames are one, shown as long as both.
    assert!(
        frames >= rows - 1 && seconds == rows && rows >= 4,
        "{frames} frames, {seconds} s, {rows} iterates"
    );
    let plain = [
        "render",
        "slider-crank",
        "--input",
        "phi=0.5",
        "--size",
        "96x72",
        "--out",
    ];
    w.run(&[&plain[..], &["plain.png"]].concat()).exits(0);
    assert_ne!(
        w.read("still.png"),
        w.read("plain.png"),
        "the still shows ghosts"
    );
    let clash = [&["render"], &scene[..], &["--at", "1", "--out", "x.png"]].concat();
    w.run(&clash).exits(2);
}
