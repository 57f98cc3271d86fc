//! Matrices of chains as in a lecture: the product of elementary transforms, its sixteen entries with symbols, and
//! their numbers at a pose.

pub mod product;
mod style;
pub mod symbol;

use crate::diag::xml_text;
use crate::math::Pose;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::notation::{Notation, WrittenChain, WrittenFactor};
use product::{SymbolMatrix, symbolic_product};
use serde_json::{Value, json};
use style::MatrixStyle;

/// Name of the document.
const SCHEMA: &str = "mechanim-matrices/1";

/// Largest width of a matrix as a grid; the entries of a wider one are listed.
const GRID: usize = 100;

/// A chain and its product.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownChain<'a> {
    /// As written.
    pub chain: &'a WrittenChain,
    /// The product with symbols, unless it is too long to read.
    pub symbolic: Option<SymbolMatrix>,
    /// The product at the pose.
    pub numeric: Pose,
    /// Each factor at the pose.
    pub factors: Vec<Pose>,
}

/// Chains at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownChains<'a> {
    mechanism: &'a Mechanism,
    time: f64,
    coordinates: &'a [f64],
    chains: Vec<ShownChain<'a>>,
}

impl<'a> ShownChains<'a> {
    /// Chains at the given coordinates (unknowns, then inputs).
    pub fn new(
        mechanism: &'a Mechanism,
        notation: &Notation,
        chains: &[&'a WrittenChain],
        (time, coordinates): (f64, &'a [f64]),
    ) -> Self {
        let values = notation.values(coordinates);
        let shown = |chain: &&'a WrittenChain| ShownChain {
            chain,
            symbolic: symbolic_product(chain),
            numeric: chain.pose(&values),
            factors: chain.factors.iter().map(|f| f.pose(&values)).collect(),
        };
        Self {
            mechanism,
            time,
            coordinates,
            chains: chains.iter().map(shown).collect(),
        }
    }

    /// For a terminal.
    pub fn text(&self) -> String {
        let mut out = format!("{}\n{}\n", self.mechanism.title, self.instant_line());
        for shown in &self.chains {
            let chain = shown.chain;
            out.push_str(&format!("\n{}\n", chain_line(chain)));
            if factor_line(chain) != chain.text {
                out.push_str(&format!("  = {}\n", factor_line(chain)));
            }
            match &shown.symbolic {
                Some(matrix) => {
                    out.push('\n');
                    out.push_str(&entry_grid(&symbol_entries(matrix, MatrixStyle::Text)));
                }
                None => out.push_str("\n  its entries are too long to be written out\n"),
            }
            out.push('\n');
            out.push_str(&entry_grid(&number_entries(
                &shown.numeric,
                MatrixStyle::Text,
            )));
        }
        out
    }

    /// For a document with the package amsmath.
    pub fn latex(&self) -> String {
        let mut out = format!("% {}, {}\n", self.mechanism.title, self.instant_line());
        for shown in &self.chains {
            let name = MatrixStyle::Latex.name(&shown.chain.name);
            let product = written_factors(shown.chain, MatrixStyle::Latex).join("\\,");
            out.push_str(&format!("\\begin{{align*}}\n{name} &= {product}\\\\\n"));
            if let Some(matrix) = &shown.symbolic {
                out.push_str(&format!(
                    "&= {}\\\\\n",
                    latex_matrix(&symbol_entries(matrix, MatrixStyle::Latex))
                ));
            }
            let numbers = latex_matrix(&number_entries(&shown.numeric, MatrixStyle::Latex));
            out.push_str(&format!("&= {numbers}\n\\end{{align*}}\n"));
        }
        out
    }

    /// A self-contained page.
    pub fn html(&self) -> String {
        let title = xml_text(&self.mechanism.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
             <style>body {{ font-family: sans-serif; margin: 2em }} math {{ margin: 0.6em 0 }}</style>\n\
             <h1>{title}</h1>\n<p>{}</p>\n",
            xml_text(&self.instant_line())
        );
        for shown in &self.chains {
            let style = MatrixStyle::MathMl;
            let name = style.name(&shown.chain.name);
            let product = written_factors(shown.chain, style).join("<mo>&#x2062;</mo>");
            out.push_str(&format!("<h2>{}</h2>\n", xml_text(&shown.chain.name)));
            out.push_str(&mathml_block(&format!("{name}<mo>=</mo>{product}")));
            if let Some(matrix) = &shown.symbolic {
                out.push_str(&mathml_block(&format!(
                    "<mo>=</mo>{}",
                    mathml_matrix(&symbol_entries(matrix, style))
                )));
            }
            let numbers = mathml_matrix(&number_entries(&shown.numeric, style));
            out.push_str(&mathml_block(&format!("<mo>=</mo>{numbers}")));
        }
        out.push_str("</html>\n");
        out
    }

    /// For programs: rows of matrices; angles in radians.
    pub fn json(&self) -> Value {
        let chains = self.chains.iter().map(|shown| {
            let factors = shown.chain.factors.iter().zip(&shown.factors);
            let factors: Vec<Value> = factors
                .map(|(factor, pose)| json!({"written": factor.written(), "matrix": matrix_rows(pose)}))
                .collect();
            let symbolic = shown
                .symbolic
                .as_ref()
                .map(|m| symbol_entries(m, MatrixStyle::Text));
            json!({
                "name": shown.chain.name,
                "text": shown.chain.text,
                "factors": factors,
                "symbolic": symbolic,
                "numeric": matrix_rows(&shown.numeric),
            })
        });
        json!({
            "schema": SCHEMA,
            "title": self.mechanism.title,
            "time": self.time,
            "coordinates": self.named_values().map(|(name, value, unit)| json!({"name": name, "value": value, "unit": unit})).collect::<Vec<_>>(),
            "chains": chains.collect::<Vec<_>>(),
        })
    }

    /// Names of the coordinates, their values in the scene's units, and these.
    fn named_values(&self) -> impl Iterator<Item = (&str, f64, &str)> {
        let mechanism = self.mechanism;
        let names = mechanism.unknowns.iter().chain(&mechanism.inputs);
        names.zip(self.coordinates).map(move |(c, value)| {
            let unit = if c.kind == Kind::Number {
                ""
            } else {
                mechanism.unit_name(c.kind)
            };
            (c.name.as_str(), value * mechanism.file_units(c.kind), unit)
        })
    }

    fn instant_line(&self) -> String {
        let values = self.named_values().map(|(name, value, unit)| {
            let text = format!("{name} = {} {unit}", MatrixStyle::Text.number(value));
            text.trim_end().to_owned()
        });
        let values: Vec<String> = values.collect();
        format!("t = {} s: {}", self.time, values.join(", "))
    }
}

fn chain_line(chain: &WrittenChain) -> String {
    match chain.text.is_empty() {
        true => chain.name.clone(),
        false => format!("{} = {}", chain.name, chain.text),
    }
}

/// All factors as typed.
fn factor_line(chain: &WrittenChain) -> String {
    let factors: Vec<String> = chain.factors.iter().map(WrittenFactor::written).collect();
    factors.join(" ")
}

/// All factors in a style.
fn written_factors(chain: &WrittenChain, style: MatrixStyle) -> Vec<String> {
    let written = |factor: &WrittenFactor| {
        let whole = factor.written();
        let letters: String = whole.chars().take_while(|c| *c != '(').collect();
        let (motion, axis) = letters.split_at(1);
        let sum = style.terms(&factor.terms, &factor.text);
        match style {
            MatrixStyle::Latex => format!("{motion}_{{{axis}}}\\!\\left({sum}\\right)"),
            _ => format!("<msub><mi>{motion}</mi><mi>{axis}</mi></msub><mo>(</mo>{sum}<mo>)</mo>"),
        }
    };
    chain.factors.iter().map(written).collect()
}

/// All sixteen entries.
fn symbol_entries(matrix: &SymbolMatrix, style: MatrixStyle) -> Vec<Vec<String>> {
    let rows = matrix
        .entries
        .iter()
        .map(|row| row.iter().map(|e| style.sum(e)).collect());
    rows.chain([last_row(style)]).collect()
}

fn number_entries(pose: &Pose, style: MatrixStyle) -> Vec<Vec<String>> {
    let rows = matrix_rows(pose)
        .into_iter()
        .map(|row| row.map(|v| style.number(v)).to_vec());
    rows.collect()
}

fn last_row(style: MatrixStyle) -> Vec<String> {
    [0.0, 0.0, 0.0, 1.0].map(|v| style.number(v)).to_vec()
}

fn matrix_rows(pose: &Pose) -> [[f64; 4]; 4] {
    let row = |k: usize| {
        let r = pose.rotation.row(k);
        [r.x, r.y, r.z, pose.translation[k]]
    };
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

/// Entries in columns, or listed if they are too wide.
fn entry_grid(entries: &[Vec<String>]) -> String {
    let width = |k: usize| {
        entries
            .iter()
            .map(|row| row[k].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..4).map(width).collect();
    let mut out = String::new();
    if widths.iter().sum::<usize>() + 11 > GRID {
        for (i, row) in entries.iter().enumerate() {
            for (k, entry) in row.iter().enumerate() {
                out.push_str(&format!("  [{},{}] = {entry}\n", i + 1, k + 1));
            }
        }
        return out;
    }
    for row in entries {
        let cells = row
            .iter()
            .zip(&widths)
            .map(|(entry, wide)| format!("{entry:>wide$}"));
        out.push_str(&format!(
            "  [ {} ]\n",
            cells.collect::<Vec<_>>().join("   ")
        ));
    }
    out
}

fn latex_matrix(entries: &[Vec<String>]) -> String {
    let rows: Vec<String> = entries.iter().map(|row| row.join(" & ")).collect();
    format!(
        "\\begin{{pmatrix}}\n{}\n\\end{{pmatrix}}",
        rows.join("\\\\\n")
    )
}

fn mathml_matrix(entries: &[Vec<String>]) -> String {
    let cell = |entry: &String| format!("<mtd><mrow>{entry}</mrow></mtd>");
    let row =
        |row: &Vec<String>| format!("<mtr>{}</mtr>", row.iter().map(cell).collect::<String>());
    let rows: String = entries.iter().map(row).collect();
    format!("<mrow><mo>(</mo><mtable>{rows}</mtable><mo>)</mo></mrow>")
}

fn mathml_block(inner: &str) -> String {
    format!("<math display=\"block\"><mrow>{inner}</mrow></math>\n")
}
