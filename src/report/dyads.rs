//! A linkage as a sequence of dyads: in words, as the table of its linear system (CSV, Markdown, LaTeX), and as a
//! document.

use super::cells::{aligned_rows, six_digits};
use super::csv::{TableCell, push_row};
use super::rounded::at_most;
use super::sentences::counted_things;
use crate::analysis::dyads::PlanarRow;
use crate::intervals::Kaucher;
use crate::intervals::chain::WHOLE_TURN;
use crate::intervals::dyad::{
    Dyad, conjugate_coefficients, exact_ranges, naive_ranges, printed_ranges,
};
use crate::intervals::formal::solved_numbers;
use crate::intervals::regular::determinant;
use crate::linalg::svd::jacobian_conditioning;
use crate::model::mechanism::Mechanism;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Version of the JSON document.
const SCHEMA: u32 = 1;

/// A sequence of dyads at a pose.
pub struct DyadReport<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// Its points and dyads.
    pub row: &'a PlanarRow,
    /// The pose, in words.
    pub place: String,
    /// Angles between the bars of a dyad for the ranges, radians.
    pub delta: Kaucher,
}

/// The linear system of the velocities.
struct VelocityTable {
    heads: Vec<String>,
    rows: Vec<Vec<f64>>,
    sides: Vec<f64>,
}

impl DyadReport<'_> {
    /// 7; 8, 9
    pub fn dyad_name(&self, dyad: &Dyad) -> String {
        let name = |k: usize| &self.row.names[k];
        format!(
            "{}; {}, {}",
            name(dyad.point),
            name(dyad.ends[0]),
            name(dyad.ends[1])
        )
    }

    fn lever_name(&self) -> String {
        let [a, b] = self.row.chain.lever;
        format!("{}-{}", self.row.names[a], self.row.names[b])
    }

    /// The numbers of points, bars and dyads.
    pub fn headline(&self) -> String {
        let chain = &self.row.chain;
        format!(
            "{}\n  {}\n  {} points, {} of them fixed, {} bars: {} and the lever {}\n",
            self.mechanism.title,
            self.place,
            chain.points.len(),
            chain.fixed.len(),
            self.row.bars.len(),
            counted_things(chain.dyads.len(), "dyad"),
            self.lever_name()
        )
    }

    /// For people.
    pub fn text(&self) -> String {
        let parts = [
            self.headline(),
            self.points_text(),
            self.dyads_text(),
            self.table_text(),
            self.conjugate_text(),
            self.ranges_text(),
        ];
        parts.join("\n")
    }

    fn points_text(&self) -> String {
        let [u, v] = self.row.axes;
        let unit = &self.mechanism.length_unit;
        let heads = ["point", u, v, &format!("v{u}"), &format!("v{v}")].map(str::to_owned);
        let mut rows = vec![heads.to_vec()];
        let chain = &self.row.chain;
        for (k, name) in self.row.names.iter().enumerate() {
            let numbers = chain.points[k].iter().chain(&chain.velocities[k]);
            let cells = numbers.map(|v| six_digits(*v));
            rows.push([name.clone()].into_iter().chain(cells).collect());
        }
        format!("Points [{unit}]\n{}", aligned_rows(&rows))
    }

    fn dyads_text(&self) -> String {
        let heads = [
            "dyad",
            "delta [deg]",
            "i1",
            "i2",
            "i3",
            "i4",
            "conjugate",
            "",
            "",
            "",
        ];
        let mut rows = vec![heads.map(str::to_owned).to_vec()];
        let chain = &self.row.chain;
        let matrices = chain.matrices().unwrap_or_default();
        for (dyad, [first, _]) in chain.dyads.iter().zip(&matrices) {
            let mut row = vec![self.dyad_name(dyad)];
            row.push(format!("{:.4}", chain.angle(dyad) * 180.0 / PI));
            let conjugate = conjugate_coefficients(*first);
            row.extend(first.iter().chain(&conjugate).map(|v| six_digits(*v)));
            rows.push(row);
        }
        format!(
            "Dyads k; a, b: v_k = J2 v_a + J3 v_b with J2 = (i1 i2; i3 i4), J3 = 1 - J2; positions have (i4 -i3; -i2 i1)\n{}",
            aligned_rows(&rows)
        )
    }

    fn velocity_table(&self) -> Option<VelocityTable> {
        let chain = &self.row.chain;
        let (rows, sides) = chain.velocity_system()?;
        let unknowns = chain.unknowns();
        let axes = self.row.axes;
        let heads = unknowns.iter().flat_map(|k| {
            let name = &self.row.names[*k];
            axes.map(|axis| format!("v{name}{axis}"))
        });
        Some(VelocityTable {
            heads: heads.collect(),
            rows,
            sides,
        })
    }

    fn table_text(&self) -> String {
        let Some(table) = self.velocity_table() else {
            return String::new();
        };
        let n = table.sides.len();
        let columns: Vec<f64> = (0..n * n).map(|k| table.rows[k % n][k / n]).collect();
        let singular = jacobian_conditioning(&columns, n, n);
        let off = self.velocity_error(&table);
        format!(
            "System of the velocities: {n} x {n}, columns {}; v{} on the right\n  condition {}, determinant {}, \
             {}\n",
            self.column_order(),
            self.row.names[self.row.chain.given()],
            six_digits(singular.sigma_max / singular.sigma_min),
            six_digits(determinant(&table.rows)),
            off.map_or_else(
                || "singular to rounding: they do not determine the velocities".to_owned(),
                |off| format!("solution off by {} at most", at_most(off))
            ),
        )
    }

    /// Largest difference between the solution of the velocity equations and the velocities of the pose; `None` if they are singular
    /// to rounding.
    fn velocity_error(&self, table: &VelocityTable) -> Option<f64> {
        let solution = solved_numbers(&table.rows, &table.sides)?;
        let chain = &self.row.chain;
        let known = chain.unknowns().into_iter();
        let pairs = solution.iter().zip(known.flat_map(|k| chain.velocities[k]));
        Some(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
    }

    /// Whether the velocity equations determine all velocities.
    pub fn is_determined(&self) -> bool {
        let table = self.velocity_table();
        table.is_none_or(|table| self.velocity_error(&table).is_some())
    }

    /// The points of the columns: 8 7 6 5 4 3 2 1.
    fn column_order(&self) -> String {
        let unknowns = self.row.chain.unknowns();
        let names: Vec<&str> = unknowns
            .iter()
            .map(|k| self.row.names[*k].as_str())
            .collect();
        names.join(" ")
    }

    /// The error of the conjugate system with these signs.
    fn conjugate_error(&self, printed: bool) -> Option<f64> {
        let chain = &self.row.chain;
        let found = chain.conjugate_positions(printed)?;
        let known = chain.unknowns().into_iter().map(|k| chain.points[k]);
        let off = found.iter().zip(known).map(|(a, b)| {
            let [x, y] = [0, 1].map(|i| a[i] - b[i]);
            libm::hypot(x, y)
        });
        Some(off.fold(0.0, f64::max))
    }

    fn conjugate_text(&self) -> String {
        let unit = &self.mechanism.length_unit;
        let shown = |off: Option<f64>| {
            off.map_or_else(
                || "unsolvable".to_owned(),
                |off| format!("off by {off:.1e} {unit}"),
            )
        };
        format!(
            "Positions by the conjugate system\n  (i4 -i3; -i2 i1): {}\n  (i4 i3; i2 i1), as printed, a reflection: {}\n",
            shown(self.conjugate_error(false)),
            shown(self.conjugate_error(true))
        )
    }

    fn coefficient_ranges(&self) -> Option<[[Kaucher; 4]; 2]> {
        Some([
            exact_ranges(WHOLE_TURN, self.delta)?,
            naive_ranges(WHOLE_TURN, self.delta)?,
        ])
    }

    fn ranges_text(&self) -> String {
        let degrees = |v: f64| six_digits(v * 180.0 / PI);
        let head = format!(
            "Ranges of the coefficients, first bar in any direction, delta from {} to {} deg",
            degrees(self.delta.lo),
            degrees(self.delta.hi)
        );
        let Some([exact, naive]) = self.coefficient_ranges() else {
            return format!("{head}\n  none: the bars can be in line\n");
        };
        let shown = |k: Kaucher| match k.lo.is_finite() && k.hi.is_finite() {
            true => format!("[{:.12}, {:.12}]", k.lo, k.hi),
            false => "unbounded".to_owned(),
        };
        let heads = [
            "",
            "exact",
            "interval arithmetic",
            "with tangents, as printed",
        ];
        let printed = shown(printed_ranges(WHOLE_TURN, self.delta));
        let mut rows = vec![heads.map(str::to_owned).to_vec()];
        for (k, name) in ["i1", "i2", "i3", "i4"].into_iter().enumerate() {
            let cells = [
                name.to_owned(),
                shown(exact[k]),
                shown(naive[k]),
                printed.clone(),
            ];
            rows.push(cells.to_vec());
        }
        format!("{head}\n{}", aligned_rows(&rows))
    }

    /// The table with a header, its rows, and the right-hand side last.
    fn table_cells(&self) -> Vec<Vec<TableCell>> {
        let Some(table) = self.velocity_table() else {
            return Vec::new();
        };
        let given = self.row.chain.given();
        let side = format!("v{}", self.row.names[given]);
        let heads = table.heads.into_iter().chain([side]);
        let corner = std::iter::once(TableCell::Empty);
        let mut all = vec![corner.chain(heads.map(TableCell::Text)).collect::<Vec<_>>()];
        for (row, (entries, side)) in table.rows.iter().zip(&table.sides).enumerate() {
            let dyad = &self.row.chain.dyads[row / 2];
            let axis = self.row.axes[row % 2];
            let name = format!("{} {axis}", self.dyad_name(dyad));
            let numbers = entries.iter().chain([side]).copied();
            let name = std::iter::once(TableCell::Text(name));
            all.push(name.chain(numbers.map(TableCell::Number)).collect());
        }
        all
    }

    /// The table as CSV, all digits.
    pub fn csv(&self) -> String {
        let mut text = String::new();
        let rows = self.table_cells().into_iter();
        rows.for_each(|row| push_row(&mut text, row));
        text
    }

    /// The table in six digits, zeros left out.
    fn short_cells(&self) -> Vec<Vec<String>> {
        let short = |cell: TableCell| match cell {
            TableCell::Number(value) if value != 0.0 => six_digits(value),
            TableCell::Whole(value) => value.to_string(),
            TableCell::Text(text) => text,
            TableCell::Number(_) | TableCell::Empty => String::new(),
        };
        let rows = self.table_cells().into_iter();
        rows.map(|row| row.into_iter().map(short).collect())
            .collect()
    }

    /// The table as Markdown.
    pub fn markdown_table(&self) -> String {
        let mut text = String::new();
        for (k, row) in self.short_cells().iter().enumerate() {
            text += &format!("| {} |\n", row.join(" | "));
            if k == 0 {
                text += &format!("|{}\n", "---|".repeat(row.len()));
            }
        }
        text
    }

    /// The table as a LaTeX tabular.
    pub fn latex(&self) -> String {
        let rows = self.short_cells();
        let columns = rows.first().map_or(0, Vec::len);
        let marks = "r".repeat(columns.saturating_sub(2));
        let mut text = format!("\\begin{{tabular}}{{l{marks}|r}}\n");
        for (k, row) in rows.iter().enumerate() {
            text += &format!("{} \\\\\n", row.join(" & "));
            if k == 0 {
                text += "\\hline\n";
            }
        }
        text + "\\end{tabular}\n"
    }

    /// For machines.
    pub fn document(&self) -> Value {
        let chain = &self.row.chain;
        let name = |k: usize| self.row.names[k].as_str();
        let matrices = chain.matrices().unwrap_or_default();
        let dyads = chain
            .dyads
            .iter()
            .zip(&matrices)
            .map(|(dyad, [first, second])| {
                json!({
                    "point": name(dyad.point),
                    "ends": dyad.ends.map(name),
                    "delta": chain.angle(dyad),
                    "J2": first,
                    "J3": second,
                    "conjugate": conjugate_coefficients(*first),
                })
            });
        let points = (0..chain.points.len()).map(|k| {
            json!({
                "name": name(k),
                "fixed": chain.fixed.contains(&k),
                "place": chain.points[k],
                "velocity": chain.velocities[k],
            })
        });
        let ends = |list: [Kaucher; 4]| list.map(|k| [k.lo, k.hi]);
        json!({
            "schema": format!("mechanim-dyads/{SCHEMA}"),
            "title": self.mechanism.title,
            "points": points.collect::<Vec<_>>(),
            "bars": self.row.bars.iter().map(|bar| bar.map(name)).collect::<Vec<_>>(),
            "lever": chain.lever.map(name),
            "row": dyads.collect::<Vec<_>>(),
            "given": name(chain.given()),
            "columns": chain.unknowns().into_iter().map(name).collect::<Vec<_>>(),
            "system": self.velocity_table().map(|t| json!({ "rows": t.rows, "sides": t.sides })),
            "ranges": self.coefficient_ranges().map(|[exact, naive]| json!({
                "delta": [self.delta.lo, self.delta.hi],
                "exact": ends(exact),
                "interval_arithmetic": ends(naive),
            })),
            "conjugate_positions_off": self.conjugate_error(false),
            "printed_signs_off": self.conjugate_error(true),
        })
    }
}
