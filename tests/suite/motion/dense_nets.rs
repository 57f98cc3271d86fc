//! Nets that can only be solved as a whole: one block of hundreds of unknowns, proved, and interrupted while it is set up.

use crate::driven::{Driven, even_times, solve};
use crate::nets::net;
use crate::program;
use crate::program::Workspace;
use crate::reference::scenes::written;
use std::time::Duration;

#[test]
fn a_net_is_one_block_and_every_pose_is_proved() {
    // Below and above the size from which matrices are eliminated sparsely.
    for k in [4, 7, 22] {
        let model = written(&net(k));
        let system = model.system().unwrap();
        let sizes: Vec<usize> = system.blocks().iter().map(|b| b.unknowns.len()).collect();
        assert_eq!(sizes, [2 * k * k]);
        let trajectory = solve(&model, &even_times(&model, 3)).unwrap();
        assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
        for pose in trajectory.poses() {
            assert!(pose.closure_error < 1e-13, "{k}: {:e}", pose.closure_error);
            // Driven bars turn by a constant and a drive, there and back: consistent.
            let bounds = pose.certificate.bounds();
            let [error_bound, _] = bounds.unwrap_or_else(|| panic!("{k}: {:?}", pose.certificate));
            assert!(error_bound < 1e-9, "{k}: {error_bound:e}");
        }
        // The start is the net as it was drawn.
        let first = trajectory.poses().next().unwrap();
        let mut pairs = first.unknowns.iter().zip(&model.actuation.guess);
        assert!(pairs.all(|(found, drawn)| (found - drawn).abs() < 1e-11));
    }
}

#[cfg(unix)]
#[test]
fn the_set_up_of_a_large_net_can_be_interrupted() {
    let folder = Workspace::new();
    folder.write("net.toml", net(50));
    let mut command = folder.command(&["solve", "net.toml", "--out", "rows.csv"]);
    let child = command.spawn().unwrap();
    std::thread::sleep(Duration::from_millis(400));
    program::interrupt(&child);
    let run = program::finish(child);
    assert_eq!(run.code, 130, "{}", run.stderr);
    assert_eq!(folder.files(), ["net.toml"]);
}
