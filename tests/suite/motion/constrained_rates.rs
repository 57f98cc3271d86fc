//! Derivatives where equations are redundant: those that exist have their values, for inputs that cannot move alone there are none.

use crate::program::Workspace;

/// A scene, and its derivative at the samples: `None` where there is none.
struct Row {
    label: &'static str,
    scene: &'static str,
    known: fn(f64) -> Option<f64>,
}

const ROWS: [Row; 7] = [
    Row {
        label: "an equation twice",
        scene: "[inputs]\nphi = \"t\"\n[equations]\ne1 = \"x - phi\"\ne2 = \"2*x - 2*phi\"\n[outputs]\nv = \"d(x, phi)\"\n",
        known: |_| Some(1.0),
    },
    Row {
        label: "a redundant bar",
        scene: "[inputs]\nphi = \"1 + 0.3*t\"\n[loops]\nA = \"Rz(phi) Tx(3) Rz(a) Tx(7) Rz(b) Tx(-3) Rz(-psi) Tx(-7)\"\n\
                [equations]\ncoupling = \"psi - phi\"\n[guess]\na = -1\npsi = 1\n[outputs]\nv = \"d(a, phi)\"\n",
        known: |_| Some(-1.0),
    },
    Row {
        label: "two inputs that move together",
        scene: "[inputs]\nphi = \"1 + t\"\npsi = \"1 + t\"\n[loops]\n\
                A = \"Rz(phi) Tx(30) Rz(a) Tx(70) Rz(b) Tx(-30) Rz(-psi) Tx(-70)\"\n[guess]\na = -1\n[outputs]\nv = \"d(a, phi)\"\n",
        known: |_| None,
    },
    Row {
        label: "the same by time",
        scene: "[inputs]\nphi = \"1 + t\"\npsi = \"1 + t\"\n[loops]\n\
                A = \"Rz(phi) Tx(30) Rz(a) Tx(70) Rz(b) Tx(-30) Rz(-psi) Tx(-70)\"\n[guess]\na = -1\n[outputs]\nv = \"d(a, t)\"\n",
        known: |_| Some(-1.0),
    },
    Row {
        label: "an equation between inputs",
        scene: "[inputs]\nphi = \"t\"\npsi = \"t^2\"\n[equations]\ne = \"x - phi*psi\"\nf = \"psi - phi^2\"\n[outputs]\nv = \"d(x, t, 2)\"\n",
        known: |t| Some(6.0 * t),
    },
    Row {
        label: "the same by an input",
        scene: "[inputs]\nphi = \"1 + t\"\npsi = \"(1 + t)^2\"\n[equations]\ne = \"x - phi*psi\"\nf = \"psi - phi^2\"\n[outputs]\nv = \"d(x, phi)\"\n",
        known: |_| None,
    },
    Row {
        label: "inputs at rest",
        scene: "[inputs]\nphi = \"1 + 0*t\"\npsi = \"1 + 0*t\"\n[loops]\n\
                A = \"Rz(phi) Tx(30) Rz(a) Tx(70) Rz(b) Tx(-30) Rz(-psi) Tx(-70)\"\n[guess]\na = -1\n[outputs]\nv = \"d(a, t)\"\n",
        known: |_| Some(0.0),
    },
];

#[test]
fn derivatives_of_redundant_equations_are_true_or_empty() {
    let folder = Workspace::new();
    for Row {
        label,
        scene,
        known,
    } in &ROWS
    {
        folder.write("rates.toml", format!("duration = 1\n{scene}"));
        let run = folder.run(&["solve", "rates.toml", "--samples", "5", "--out", "r.csv"]);
        assert_eq!(run.code, 0, "{label}\n{}", run.text());
        let table = String::from_utf8(folder.read("r.csv")).unwrap();
        let mut lines = table
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let header = lines.next().unwrap();
        let place = |name: &str| header.iter().position(|head| *head == name).unwrap();
        let (time, rate) = (place("time"), place("v"));
        for cells in lines {
            let wanted = known(cells[time].parse().unwrap());
            match (cells[rate].parse::<f64>().ok(), wanted) {
                (None, None) => {}
                (Some(found), Some(wanted)) => {
                    assert!((found - wanted).abs() < 1e-9, "{label}: {found} {wanted}");
                }
                other => panic!("{label}: {other:?} in {cells:?}"),
            }
        }
        // Every other verb with rates of any order.
        for more in [
            &[
                "solve",
                "rates.toml",
                "--events",
                "--order",
                "3",
                "--out",
                "-",
            ][..],
            &["check", "rates.toml"],
        ] {
            // Decimals between the samples may break an equation between inputs.
            let run = folder.run(more);
            assert!(run.code < 2, "{label} {more:?}\n{}", run.stderr);
        }
    }
}
