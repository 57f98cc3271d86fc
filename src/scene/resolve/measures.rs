//! Formulas of a study's measures: reductions along tracks are taken out of them and compiled on their own.

use super::super::formula::compile::{Value, compile, constant};
use super::super::formula::expression::{MeasureWord, Node, NodeKind};
use super::super::formula::kinds::to_radians;
use super::super::reader::{FormulaText, Spanned};
use super::outputs::{kind_of, trace_slot};
use super::parsed::expression;
use super::study::Surroundings;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::mechanism::Kind;
use crate::model::study::{Measure, Rate, Reducer, Reduction, Track, Variable};

/// What the formulas of measures may refer to.
pub struct Scope<'a> {
    pub around: &'a Surroundings<'a>,
    pub tracks: &'a [Track],
    pub variables: &'a [Variable],
}

/// A measure whose reductions are taken out and whose formula is not compiled yet.
struct Draft {
    name: String,
    node: Node,
    kind: Kind,
}

/// Collects measures.
pub struct MeasureBuilder<'a> {
    scope: Scope<'a>,
    rates: Vec<Rate>,
    reductions: Vec<Reduction>,
    kinds: Vec<Kind>,
    drafts: Vec<Draft>,
    is_whole: bool,
}

impl<'a> MeasureBuilder<'a> {
    /// Starts without measures.
    pub fn new(scope: Scope<'a>) -> Self {
        Self {
            scope,
            rates: Vec::new(),
            reductions: Vec::new(),
            kinds: Vec::new(),
            drafts: Vec::new(),
            is_whole: true,
        }
    }

    /// What a measure measures.
    pub fn kind(&self, measure: usize) -> Kind {
        self.drafts[measure].kind
    }

    /// A measure of the file.
    pub fn measure(
        &mut self,
        name: &Spanned<String>,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) {
        if self.drafts.iter().any(|d| d.name == name.value) {
            let message = format!("there are two measures named `{}`", name.value);
            diagnostics.push(Diagnostic::error(message).at(name.span.clone()));
        }
        self.unnamed(&name.value, text, diagnostics);
    }

    /// A formula that stands for itself: the measure it names, or a new one called `name`.
    pub fn unnamed(
        &mut self,
        name: &str,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<usize> {
        let mut node = match expression(text, diagnostics) {
            Some(node) => node,
            None => {
                self.is_whole = false;
                return None;
            }
        };
        if let NodeKind::Name(used) = &node.kind
            && let Some(known) = self.drafts.iter().position(|d| d.name == *used)
        {
            return Some(known);
        }
        if let Err(diagnostic) = self.extract(&mut node) {
            diagnostics.push(diagnostic);
            self.is_whole = false;
            return None;
        }
        let names = self.scope.around.names;
        let kind = kind_of(&node, names, &|used| self.kind_of_name(used));
        self.drafts.push(Draft {
            name: name.to_owned(),
            node,
            kind,
        });
        Some(self.drafts.len() - 1)
    }

    fn kind_of_name(&self, used: &str) -> Option<Kind> {
        if let Some(index) = used.strip_prefix('#') {
            return self.kinds.get(index.parse::<usize>().ok()?).copied();
        }
        let earlier = self.drafts.iter().find(|d| d.name == used);
        earlier.map(|d| d.kind)
    }

    /// Replaces every reduction below `node` by a name that stands for it.
    fn extract(&mut self, node: &mut Node) -> Result<(), Diagnostic> {
        match &mut node.kind {
            NodeKind::Number(_) | NodeKind::Radians(_) | NodeKind::Name(_) => Ok(()),
            NodeKind::Negate(inner) => self.extract(inner),
            NodeKind::Binary(_, a, b) => {
                self.extract(a)?;
                self.extract(b)
            }
            NodeKind::Call(_, args) => args.iter_mut().try_for_each(|arg| self.extract(arg)),
            NodeKind::Measure(word, args) => {
                let index = self.reduction(*word, args, &node.span)?;
                node.kind = NodeKind::Name(format!("#{index}"));
                Ok(())
            }
        }
    }

    fn reduction(
        &mut self,
        word: MeasureWord,
        args: &[Node],
        span: &Span,
    ) -> Result<usize, Diagnostic> {
        let mut first = 1;
        let names = self.scope.around.names;
        let reducer = match word {
            MeasureWord::Rate => {
                return Err(
                    Diagnostic::error("a rate has a value at every pose of a track")
                        .at(span.clone())
                        .hint("write it inside a reduction: max_over(track, rate(y, u))"),
                );
            }
            MeasureWord::First => Reducer::First,
            MeasureWord::Last => Reducer::Last,
            MeasureWord::SumOver => Reducer::Sum,
            MeasureWord::MeanOver => Reducer::Mean,
            MeasureWord::MaxOver => Reducer::Largest,
            MeasureWord::MinOver => Reducer::Smallest,
            MeasureWord::Bow => Reducer::Bow,
            MeasureWord::NormOver => {
                first = 2;
                let power = constant(&args[1], &|n, s| names.constant(n, s))?;
                if power < 1.0 {
                    return Err(Diagnostic::error("the power of a norm is at least 1")
                        .at(args[1].span.clone()));
                }
                Reducer::Norm(power)
            }
        };
        let track = self.track(&args[0])?;
        let formulas: Vec<_> = args[first..].to_vec();
        let mut arguments = Vec::new();
        let mut kind = Kind::Number;
        for mut node in formulas {
            self.extract_rates(&mut node)?;
            let outputs = self.scope.around.outputs;
            let output = |n: &str| outputs.iter().find(|o| o.name == n).map(|o| o.kind);
            kind = kind_of(&node, names, &output);
            let is_angle = |n: &str| names.is_angle(n) || output(n) == Some(Kind::Angle);
            let radians = self.scope.around.unit.radians;
            let node = to_radians(node, Some(kind), radians, &is_angle);
            arguments.push(compile(&node, &|n, s| self.at_pose(n, s))?);
        }
        self.kinds.push(kind);
        self.reductions.push(Reduction {
            track,
            reducer,
            arguments,
        });
        Ok(self.reductions.len() - 1)
    }

    fn track(&self, node: &Node) -> Result<usize, Diagnostic> {
        let known = || self.scope.tracks.iter().map(|t| t.name.as_str());
        let NodeKind::Name(name) = &node.kind else {
            return Err(
                Diagnostic::error("the first argument is the name of a track")
                    .at(node.span.clone()),
            );
        };
        known().position(|n| n == name).ok_or_else(|| {
            let names: Vec<&str> = known().collect();
            Diagnostic::error(format!("there is no track `{name}`"))
                .at(node.span.clone())
                .suggest(name, known())
                .hint(format!("tracks: {}", names.join(", ")))
        })
    }

    /// Replaces every derivative below `node` by a name that stands for it.
    fn extract_rates(&mut self, node: &mut Node) -> Result<(), Diagnostic> {
        match &mut node.kind {
            NodeKind::Number(_) | NodeKind::Radians(_) | NodeKind::Name(_) => Ok(()),
            NodeKind::Negate(inner) => self.extract_rates(inner),
            NodeKind::Binary(_, a, b) => {
                self.extract_rates(a)?;
                self.extract_rates(b)
            }
            NodeKind::Call(_, args) => args.iter_mut().try_for_each(|a| self.extract_rates(a)),
            NodeKind::Measure(MeasureWord::Rate, args) => {
                let index = self.rate(&args[0], &args[1])?;
                node.kind = NodeKind::Name(format!("@{index}"));
                Ok(())
            }
            NodeKind::Measure(..) => {
                let message = "a reduction cannot stand inside another";
                Err(Diagnostic::error(message).at(node.span.clone()))
            }
        }
    }

    fn rate(&mut self, of: &Node, by: &Node) -> Result<usize, Diagnostic> {
        let wanted = |node: &Node, what: &str| {
            Diagnostic::error(format!("a rate is taken {what}")).at(node.span.clone())
        };
        let (NodeKind::Name(quantity), NodeKind::Name(input)) = (&of.kind, &by.kind) else {
            return Err(wanted(of, "of one name by another: rate(y, u)"));
        };
        let slot = match self.at_pose(quantity, &of.span)? {
            Value::Slot(slot) => slot,
            Value::Constant(_) => {
                return Err(wanted(of, "of something that moves"));
            }
        };
        let inputs = &self.scope.around.names.inputs;
        let Some(input) = inputs.iter().position(|i| i.name == *input) else {
            return Err(wanted(by, "by an input of the scene")
                .suggest(input, inputs.iter().map(|i| i.name.as_str())));
        };
        let rate = Rate { slot, input };
        if let Some(known) = self.rates.iter().position(|r| *r == rate) {
            return Ok(known);
        }
        self.rates.push(rate);
        Ok(self.rates.len() - 1)
    }

    /// What a name stands for at one pose.
    fn at_pose(&self, used: &str, span: &Span) -> Result<Value, Diagnostic> {
        let Surroundings {
            names,
            traces,
            outputs,
            ..
        } = self.scope.around;
        let coordinates = names.unknowns.len() + names.inputs.len();
        let after_outputs = coordinates + 3 * traces.len() + outputs.len();
        if let Some(index) = used.strip_prefix('@') {
            let index: usize = index.parse().map_err(|_| Diagnostic::inherited())?;
            return Ok(Value::Slot(after_outputs + index));
        }
        if let Some(slot) = trace_slot(used, traces) {
            return Ok(Value::Slot(coordinates + slot));
        }
        if let Some(output) = outputs.iter().position(|o| o.name == used) {
            return Ok(Value::Slot(coordinates + 3 * traces.len() + output));
        }
        names.coordinate(used, span).map_err(|d| {
            let names = outputs.iter().map(|o| o.name.as_str());
            d.suggest(used, names)
        })
    }

    /// The rates, reductions and compiled measures; `None` if anything was wrong (and said).
    pub fn finish(
        mut self,
        diagnostics: &mut Diagnostics,
    ) -> Option<(Vec<Rate>, Vec<Reduction>, Vec<Measure>)> {
        let variables = self.scope.variables.len();
        let first_measure = variables + self.reductions.len();
        let drafts = std::mem::take(&mut self.drafts);
        let names = self.scope.around.names;
        let mut measures: Vec<Measure> = Vec::new();
        for draft in drafts {
            let lookup = |used: &str, span: &Span| {
                if let Some(index) = used.strip_prefix('#') {
                    let index: usize = index.parse().map_err(|_| Diagnostic::inherited())?;
                    return Ok(Value::Slot(variables + index));
                }
                if let Some(index) = measures.iter().position(|m| m.name == used) {
                    return Ok(Value::Slot(first_measure + index));
                }
                let mut variables = self.scope.variables.iter();
                if let Some(index) = variables.position(|v| v.name == used) {
                    return Ok(Value::Slot(index));
                }
                names.constant(used, span).map_err(|d| {
                    d.suggest(used, measures.iter().map(|m| m.name.as_str()))
                        .hint("what moves has no one value here: reduce it along a track")
                })
            };
            let kind = draft.kind;
            let is_angle = |n: &str| {
                let reduced = n.strip_prefix('#').and_then(|i| i.parse::<usize>().ok());
                names.is_angle(n)
                    || reduced.and_then(|i| self.kinds.get(i)) == Some(&Kind::Angle)
                    || measures
                        .iter()
                        .any(|m| m.name == n && m.kind == Kind::Angle)
            };
            let radians = self.scope.around.unit.radians;
            let node = to_radians(draft.node, Some(kind), radians, &is_angle);
            match compile(&node, &lookup) {
                Ok(expression) => measures.push(Measure {
                    name: draft.name,
                    expression,
                    kind,
                }),
                Err(diagnostic) => {
                    diagnostics.push(diagnostic);
                    self.is_whole = false;
                }
            }
        }
        self.is_whole
            .then_some((self.rates, self.reductions, measures))
    }
}
