//! Excursions between samples of whatever is driven: lengths of bars, frames of contacts, terms of equations, formulas in joints,
//! of small parts beside large ones. None of these motions has a pose everywhere.

use crate::draws::Draws;
use crate::program::Workspace;

/// Units of angles, inputs, the mechanism, start values.
type Driven<'a> = (&'a str, &'a str, &'a str, &'a str);

/// The reason why it does not close stands before each.
const DRIVEN: [Driven; 15] = [
    // The bar shrinks to zero where 30 are needed.
    (
        "deg",
        "phi = \"22.5*t\"",
        "[chains]\nP = \"T(x,y,0)\"\n[bars]\na = { from = [0, 0], to = \"P\", length = \"60-30*(1-cos(16*phi))\" }\n\
         b = { from = \"P\", to = [90, 0], length = 60 }",
        "x = 45\ny = 40",
    ),
    // 110 from the origin, which is held by 60 and 40.
    (
        "rad",
        "phi = \"0.392699*t\"",
        "[chains]\nP = \"T(x,y,0)\"\n[bars]\na = { from = \"Tx(80+30*(1-cos(16*phi))/2)\", to = \"P\", length = 60 }\n\
         b = { from = \"P\", to = [0, 0], length = 40 }",
        "x = 35\ny = 15",
    ),
    // Centres at least 60 apart, radii of 40 together.
    (
        "rad",
        "phi = \"0.39*t\"",
        "[chains]\ncam = \"Ty(30*(1-cos(2*pi*phi/0.39))/2)\"\nroller = \"Ty(-30) Tx(x)\"\n[contacts.c]\n\
         first = { sphere = { radius = 20 }, frame = \"cam\" }\nsecond = { sphere = { radius = 20 }, frame = \"roller\" }",
        "x = 100",
    ),
    // r is 110, the reach 100.
    (
        "rad",
        "phi = \"0.39*t\"",
        "[loops]\nA = \"Rz(0.5) Tx(r) Rz(mu) Tx(60) Rz(nu) Tx(-40) Rz(-theta)\"\n[equations]\n\
         e = \"r-80-15*(1-cos(2*pi*phi/0.39))\"",
        "mu = 2.8\nr = 80",
    ),
    (
        "rad",
        "phi = \"0.39*t\"",
        "[loops]\nA = \"Rz(0.5) Tx(r) Rz(mu) Tx(60) Rz(nu) Tx(-40) Rz(-theta)\"\n[equations]\n\
         e = \"r-80-40*exp(-((phi-0.2)/0.01)^2)\"",
        "mu = 2.8\nr = 80",
    ),
    // Squares of -0.5, -3 and -0.23.
    (
        "rad",
        "p = \"2*pi/16*t\"",
        "[equations]\ne = \"y^2-0.5-cos(16*p)\"",
        "y = 1",
    ),
    (
        "rad",
        "p = \"0.39*t\"",
        "[equations]\ne = \"r^2-1+2*(1-cos(2*pi*p/0.39))\"",
        "r = 1",
    ),
    (
        "rad",
        "p = \"6.2832*t\"",
        "[equations]\ne = \"y^2-(0.937-1.1715*exp(-((p-1.13981)/0.163299)^2))\"",
        "y = 1",
    ),
    // 110 for a reach of 100, beside a mechanism ten times as large.
    (
        "deg",
        "phi = \"22.5*t\"\npsi = \"20*t\"",
        "[loops]\nA = \"Tx(80+30*(1-cos(16*phi))/2) Rz(mu) Tx(60) Rz(nu) Tx(-40) Rz(-theta)\"\n\
         B = \"Rz(psi) Tx(300) Rz(w) Tx(1000) Rz(v) Tx(-xx)\"",
        "mu = 160\nxx = 1300",
    ),
    // 100.5 for a reach of 100, beside one a hundred times as large; 160 beside 4e6.
    (
        "deg",
        "s = \"exp(-((t-0.3)*10)^2)\"\npsi = \"20*t\"",
        "[loops]\nA = \"Tx(99.5) Tx(s) Rz(mu) Tx(60) Rz(nu) Tx(-40) Rz(-theta)\"\n\
         B = \"Rz(psi) Tx(3000) Rz(w) Tx(10000) Rz(v) Tx(-xx)\"",
        "mu = 160\nxx = 13000",
    ),
    (
        "deg",
        "s = \"50*(1-cos(360*4*t))\"\npsi = \"20*t\"",
        "[loops]\nA = \"Rz(60) Tx(60+s) Rz(mu) Tx(60) Rz(nu) Tx(-60) Rz(-theta) Tx(-110)\"\n\
         B = \"Rz(psi) Tx(2e6) Rz(w) Tx(4e6) Rz(v) Tx(-xx)\"",
        "theta = 120\nxx = 6e6",
    ),
    // A plain number times a large length.
    (
        "deg",
        "s = \"(1-cos(360*4*t))/2\"",
        "[loops]\nA = \"Rz(60) Tx(6000+10000*s) Rz(mu) Tx(6000) Rz(nu) Tx(-6000) Rz(-theta) Tx(-11000)\"",
        "theta = 120",
    ),
    (
        "deg",
        "s = \"exp(-((t-0.3)*10)^2)\"",
        "[chains]\nP = \"T(x,y,0)\"\n[bars]\na = { from = [0, 0], to = \"P\", length = \"6000-4000*s\" }\n\
         b = { from = \"P\", to = [9000, 0], length = 6000 }",
        "x = 4500\ny = 4000",
    ),
    // 140 degrees, and 84.3 at most; with a jump that is never met.
    (
        "deg",
        "phi = \"22.5*t\"",
        "[loops]\nA = \"Rz(60+40*(1-cos(16*phi))+0.1*floor(phi/7000)) Tx(60) Rz(mu) Tx(60) Rz(nu) Tx(-60) Rz(-theta) Tx(-110)\"",
        "theta = 120",
    ),
    (
        "deg",
        "phi = \"4e-3*(1-cos(360*4*t))/2\"",
        "[loops]\nA = \"Rz(60+1e4*phi) Tx(60) Rz(mu) Tx(60) Rz(nu) Tx(-60) Rz(-theta) Tx(-110)\"",
        "theta = 120",
    ),
];

#[test]
fn whatever_is_driven_is_followed_between_samples() {
    let folder = Workspace::new();
    for (angle, inputs, mechanism, guess) in DRIVEN {
        let text = format!(
            "units = {{ length = \"mm\", angle = \"{angle}\" }}\nduration = 1\n[inputs]\n{inputs}\n{mechanism}\n[guess]\n{guess}\n"
        );
        folder.write("driven.toml", &text);
        for samples in ["2", "3", "5", "9", "21"] {
            let run = folder.run(&["check", "driven.toml", "--samples", samples]);
            let said = format!("{text} at {samples}: {} {}", run.code, run.stderr);
            assert!([1, 4].contains(&run.code), "{said}");
        }
    }
}

/// Before and behind a jump, at any distance.
#[test]
fn excursions_beside_a_jump_are_followed() {
    let folder = Workspace::new();
    let mut draws = Draws(14);
    for _ in 0..40 {
        let width = 10f64.powf(-1.5 - 5.0 * draws.share());
        let side = if draws.share() < 0.5 { -1.0 } else { 1.0 };
        let middle = 0.5 + side * width * 6.0 * draws.share();
        let size = 0.01 + draws.share();
        let phi = format!("50+60*exp(-((t-{middle})/{width})^2)+{size}*floor(t+0.5)");
        let text = format!(
            "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n[inputs]\nphi = \"{phi}\"\n\
             [loops]\nA = \"Rz(phi) Tx(60) Rz(mu) Tx(60) Rz(nu) Tx(-60) Rz(-theta) Tx(-110)\"\n[guess]\ntheta = 120\n"
        );
        folder.write("jump.toml", text);
        for samples in ["2", "3", "5", "21"] {
            let run = folder.run(&["check", "jump.toml", "--samples", samples]);
            let said = format!("{phi} at {samples}: {} {}", run.code, run.stderr);
            assert!([1, 4].contains(&run.code), "{said}");
        }
    }
}
