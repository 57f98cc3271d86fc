//! Nets of quadrilaterals that can only be solved as a whole.

use crate::draws::Draws;
use std::fmt::Write;

/// A direction of a bar: along the rows or the columns of the net.
#[derive(Clone, Copy)]
enum Way {
    Along,
    Across,
}

/// `k` × `k` cells with nodes a little off a grid. The bars across the rows are driven at both ends of every row, so that no
/// cell can be solved before another: 2 k² unknown angles in one block.
pub fn net(k: usize) -> String {
    let mut text = "duration = 1\n[inputs]\ns = \"0.2*t\"\n[loops]\n".to_owned();
    let mut guess = "[guess]\n".to_owned();
    let nodes = nodes(k);
    for i in 0..k {
        for j in 0..k {
            let around = [
                (Way::Along, i, j, 1.0),
                (Way::Across, i + 1, j, 1.0),
                (Way::Along, i, j + 1, -1.0),
                (Way::Across, i, j, -1.0),
            ];
            let sides = around.map(|(way, i, j, sign)| {
                let (length, direction) = bar(&nodes, way, i, j);
                let name = angle(way, [i, j], k, direction, &mut guess);
                format!("Rz({name}) Tx({:?}) Rz(-{name})", sign * length)
            });
            writeln!(text, "c{i}_{j} = \"{}\"", sides.join(" ")).unwrap();
        }
    }
    text + &guess
}

/// Where the nodes stand, `nodes[i][j]`.
fn nodes(k: usize) -> Vec<Vec<[f64; 2]>> {
    let mut draws = Draws(12345);
    let mut node = |i: usize, j: usize| [i, j].map(|c| c as f64 + 0.15 * draws.number());
    let mut row = |i: usize| (0..=k).map(|j| node(i, j)).collect();
    (0..=k).map(&mut row).collect()
}

/// Length and direction of a bar at the start.
fn bar(nodes: &[Vec<[f64; 2]>], way: Way, i: usize, j: usize) -> (f64, f64) {
    let from = nodes[i][j];
    let to = match way {
        Way::Along => nodes[i + 1][j],
        Way::Across => nodes[i][j + 1],
    };
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    (x.hypot(y), y.atan2(x))
}

/// The bar's angle: an unknown with its start value, or at an end of a row a formula of the drive.
fn angle(way: Way, [i, j]: [usize; 2], k: usize, direction: f64, guess: &mut String) -> String {
    match way {
        Way::Across if i == 0 || i == k => {
            let rate = 0.01 + 0.001 * ((i + 3 * j) % 5) as f64;
            format!("({direction:?} + {rate:?}*s)")
        }
        Way::Across | Way::Along => {
            let name = format!(
                "{}{i}_{j}",
                if matches!(way, Way::Along) { "h" } else { "v" }
            );
            let line = format!("{name} = {direction:?}\n");
            // A bar between two cells is met twice.
            if !guess.contains(&line) {
                guess.push_str(&line);
            }
            name
        }
    }
}
