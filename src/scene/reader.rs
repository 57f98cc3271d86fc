//! Typed reading of TOML tables: every value has its position, and reading continues after errors.

use super::keys::Keys;
use super::values::{FormulaText, formula_of, formulas_of, kind_of, parse_colour};
use crate::diag::{Diagnostic, Diagnostics, Span, name_hint, shown_lines, shown_text};
use crate::sorting::sort_by_key;
use toml::de::{DeTable, DeValue};

/// A value and its position in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its place.
    pub span: Span,
}

/// A name and its formula.
pub type NamedFormula = (Spanned<String>, FormulaText);

/// A table being read; unknown keys are rejected.
pub struct TableReader<'t, 'd> {
    table: &'t DeTable<'t>,
    text: &'t str,
    place: String,
    keys: &'static Keys,
    /// Receives the errors.
    pub diagnostics: &'d mut Diagnostics,
    /// The table's place.
    pub span: Span,
}

impl<'t, 'd> TableReader<'t, 'd> {
    /// A key that is in no list of keys counts as absent, so that undocumented keys cannot be read.
    fn get(&mut self, key: &'static str) -> Option<(&'t DeValue<'t>, Span)> {
        self.keys.find(key)?;
        let (_, value) = self
            .table
            .iter()
            .find(|(k, _)| k.get_ref().as_ref() == key)?;
        Some((value.get_ref(), value.span()))
    }

    fn wrong_value(&mut self, key: &str, wanted: &str, value: &DeValue, span: Span) {
        let found = kind_of(value);
        self.diagnostics
            .push(Diagnostic::error(format!("`{key}` must be {wanted}, found {found}")).at(span));
    }

    /// A text in which escape sequences and control characters are spelled out, so that it can be displayed anywhere.
    pub fn string(&mut self, key: &'static str) -> Option<Spanned<String>> {
        self.raw_string(key).map(|text| Spanned {
            value: shown_text(&text.value).into_owned(),
            ..text
        })
    }

    /// The same for a text that may have several lines.
    pub fn lines(&mut self, key: &'static str) -> Option<Spanned<String>> {
        self.raw_string(key).map(|text| Spanned {
            value: shown_lines(&text.value).into_owned(),
            ..text
        })
    }

    /// The raw text, which is not displayed as it is.
    pub fn raw_string(&mut self, key: &'static str) -> Option<Spanned<String>> {
        let (value, span) = self.get(key)?;
        match value {
            DeValue::String(s) => Some(Spanned {
                value: s.to_string(),
                span,
            }),
            other => {
                self.wrong_value(key, "a text", other, span);
                None
            }
        }
    }

    /// `true` or `false`.
    pub fn boolean(&mut self, key: &'static str) -> Option<bool> {
        let (value, span) = self.get(key)?;
        match value {
            DeValue::Boolean(b) => Some(*b),
            other => {
                self.wrong_value(key, "true or false", other, span);
                None
            }
        }
    }

    /// A number or a formula in quotes.
    pub fn formula(&mut self, key: &'static str) -> Option<FormulaText> {
        let (value, span) = self.get(key)?;
        let formula = formula_of(value, span.clone(), self.text);
        if formula.is_none() {
            self.wrong_value(key, "a number or a formula in quotes", value, span);
        }
        formula
    }

    /// A list of numbers or formulas.
    pub fn formulas(&mut self, key: &'static str) -> Option<Spanned<Vec<FormulaText>>> {
        let (value, span) = self.get(key)?;
        let list = formulas_of(value, self.text);
        match list {
            Some(value) => Some(Spanned { value, span }),
            None => {
                self.wrong_value(key, "a list of numbers or formulas", value, span);
                None
            }
        }
    }

    /// Whether a key holds a list.
    pub fn holds_list(&self, key: &str) -> bool {
        let value = self.table.get(key);
        value.is_some_and(|value| value.get_ref().is_array())
    }

    /// A number or formula, or a list of them.
    pub fn formula_or_formulas(&mut self, key: &'static str) -> Option<Vec<FormulaText>> {
        if self.holds_list(key) {
            return self.formulas(key).map(|list| list.value);
        }
        self.formula(key).map(|one| vec![one])
    }

    /// A table from names to a number or formula, or to a list of two: start and end.
    pub fn named_ranges(&mut self, key: &'static str) -> Vec<(Spanned<String>, [FormulaText; 2])> {
        let mut list = Vec::new();
        for (name, value, span) in self.named(key) {
            let one = formula_of(value, span.clone(), self.text);
            let ends = one.map(|one| [one.clone(), one]);
            let ends =
                ends.or_else(|| <[FormulaText; 2]>::try_from(formulas_of(value, self.text)?).ok());
            match ends {
                Some(ends) => list.push((name, ends)),
                None => self.wrong_value(
                    &name.value,
                    "a number, a formula or a list of two",
                    value,
                    span,
                ),
            }
        }
        list
    }

    /// Exactly `N` numbers or formulas.
    pub fn vector<const N: usize>(&mut self, key: &'static str) -> Option<[FormulaText; N]> {
        let list = self.formulas(key)?;
        let found = list.value.len();
        match <[FormulaText; N]>::try_from(list.value) {
            Ok(vector) => Some(vector),
            Err(_) => {
                self.diagnostics.push(
                    Diagnostic::error(format!("`{key}` must have {N} components, found {found}"))
                        .at(list.span),
                );
                None
            }
        }
    }

    /// A list of lists of numbers or formulas, each of length `N`.
    pub fn rows<const N: usize>(
        &mut self,
        key: &'static str,
    ) -> Option<Spanned<Vec<[FormulaText; N]>>> {
        let (value, span) = self.get(key)?;
        let rows = value.as_array().and_then(|rows| {
            rows.iter()
                .map(|row| {
                    formulas_of(row.get_ref(), self.text)
                        .and_then(|r| <[FormulaText; N]>::try_from(r).ok())
                })
                .collect::<Option<Vec<_>>>()
        });
        match rows {
            Some(value) => Some(Spanned { value, span }),
            None => {
                self.wrong_value(
                    key,
                    &format!("a list of lists of {N} numbers or formulas"),
                    value,
                    span,
                );
                None
            }
        }
    }

    /// A list of texts.
    pub fn strings(&mut self, key: &'static str) -> Option<Vec<Spanned<String>>> {
        let (value, span) = self.get(key)?;
        let list = value.as_array().and_then(|items| {
            items
                .iter()
                .map(|i| {
                    i.get_ref().as_str().map(|s| Spanned {
                        value: shown_text(s).into_owned(),
                        span: i.span(),
                    })
                })
                .collect::<Option<Vec<_>>>()
        });
        if list.is_none() {
            self.wrong_value(key, "a list of texts", value, span);
        }
        list
    }

    /// `#rrggbb`.
    pub fn colour(&mut self, key: &'static str) -> Option<[u8; 3]> {
        let text = self.string(key)?;
        let colour = parse_colour(&text.value);
        if colour.is_none() {
            self.diagnostics.push(
                Diagnostic::error(format!("`{}` is not a colour", text.value))
                    .at(text.span)
                    .hint("write `#rrggbb`, for example `#c2452d`"),
            );
        }
        colour
    }

    /// A table whose keys are names of the user's choice, in the order of the file.
    pub fn named(&mut self, key: &'static str) -> Vec<TableEntry<'t>> {
        let Some((value, span)) = self.get(key) else {
            return Vec::new();
        };
        let Some(table) = value.as_table() else {
            self.wrong_value(key, "a table", value, span);
            return Vec::new();
        };
        let mut entries: Vec<_> = table
            .iter()
            .map(|(k, v)| {
                (
                    Spanned {
                        value: shown_text(k.get_ref()).into_owned(),
                        span: k.span(),
                    },
                    v.get_ref(),
                    v.span(),
                )
            })
            .collect();
        sort_by_key(&mut entries, |(k, _, _)| k.span.start);
        entries
    }

    /// A table from names to formulas. A name with a dot, which TOML reads as a table, is joined again.
    pub fn named_formulas(&mut self, key: &'static str) -> Vec<(Spanned<String>, FormulaText)> {
        let entries = self.named(key);
        self.formulas_of(entries)
    }

    /// The same for entries that have already been removed from the table.
    pub fn formulas_of(
        &mut self,
        entries: Vec<TableEntry<'t>>,
    ) -> Vec<(Spanned<String>, FormulaText)> {
        let mut list = Vec::new();
        for (name, value, span) in entries.into_iter().flat_map(undotted_entries) {
            match formula_of(value, span.clone(), self.text) {
                Some(formula) => list.push((name, formula)),
                None => {
                    let key = name.value.clone();
                    self.wrong_value(&key, "a number or a formula in quotes", value, span.clone());
                    // The name is kept, so that its uses are not reported as well.
                    let unread = FormulaText {
                        text: String::new(),
                        offset: span.start,
                        span,
                        is_unread: true,
                    };
                    list.push((name, unread));
                }
            }
        }
        list
    }

    /// Reads an inner table with `read`; `None` if it is absent.
    pub fn table<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut TableReader<'t, '_>) -> T,
    ) -> Option<T> {
        let (value, span) = self.get(key)?;
        let Some(table) = value.as_table() else {
            self.wrong_value(key, "a table", value, span);
            return None;
        };
        let keys = self.keys.inner(key);
        let (text, place) = (self.text, format!("[{key}]"));
        let found = FoundValue { table, text, span };
        Some(read_table(found, keys, place, self.diagnostics, read))
    }

    /// Reads a list of tables with `read`.
    pub fn tables<T>(
        &mut self,
        key: &'static str,
        mut read: impl FnMut(&mut TableReader<'t, '_>) -> T,
    ) -> Vec<T> {
        let Some((value, span)) = self.get(key) else {
            return Vec::new();
        };
        let Some(items) = value.as_array() else {
            self.wrong_value(key, "a list of tables", value, span);
            return Vec::new();
        };
        let mut list = Vec::new();
        for item in items.iter() {
            match item.get_ref().as_table() {
                Some(table) => {
                    let keys = self.keys.inner(key);
                    let (text, span) = (self.text, item.span());
                    let found = FoundValue { table, text, span };
                    let place = format!("[[{key}]]");
                    list.push(read_table(found, keys, place, self.diagnostics, &mut read));
                }
                None => self.wrong_value(key, "a list of tables", item.get_ref(), item.span()),
            }
        }
        list
    }

    /// Reports a missing key.
    pub fn missing(&mut self, key: &str) {
        let message = format!("{} needs `{key}`", self.place);
        let span = first_line(self.text, self.span.clone());
        let diagnostic = Diagnostic::error(message).at(span);
        self.diagnostics.push(match self.keys.find(key) {
            Some(known) => diagnostic.hint(format!("`{key}`: {}", known.says)),
            None => diagnostic,
        });
    }

    /// True if a section was misspelled or is not a table: its names are then unknown, and references to them must not
    /// be reported as well.
    pub fn lacks_sections(&self, sections: &[&str]) -> bool {
        self.table.iter().any(|(key, value)| {
            let (key, value) = (key.get_ref().as_ref(), value.get_ref());
            let is_section = value.is_table() || value.is_array();
            (is_section && self.keys.find(key).is_none())
                || (!is_section && sections.contains(&key))
        })
    }

    /// Reports keys that the table may not have.
    fn finish(self) {
        for (key, _) in self.table.iter() {
            let name = key.get_ref().as_ref();
            if self.keys.find(name).is_none() {
                self.diagnostics.push(
                    Diagnostic::error(format!("unknown key `{name}` in {}", self.place))
                        .at(key.span())
                        .hint(name_hint(name, self.keys.names())),
                );
            }
        }
    }
}

/// A table being read, and where it is.
pub struct FoundValue<'t> {
    /// The table.
    pub table: &'t DeTable<'t>,
    /// The text of the whole file.
    pub text: &'t str,
    /// Its place in it.
    pub span: Span,
}

/// Reads a table with these keys; `place` names it in messages.
pub fn read_table<'t, T>(
    found: FoundValue<'t>,
    keys: &'static Keys,
    place: String,
    diagnostics: &mut Diagnostics,
    read: impl FnOnce(&mut TableReader<'t, '_>) -> T,
) -> T {
    let mut reader = TableReader {
        table: found.table,
        text: found.text,
        place,
        keys,
        diagnostics,
        span: found.span,
    };
    let value = read(&mut reader);
    reader.finish();
    value
}

/// Reads a required key and reports it if it is absent (not if it was present but wrong, which has been reported).
pub fn required_value<'t, 'd, T>(
    r: &mut TableReader<'t, 'd>,
    key: &'static str,
    read: impl FnOnce(&mut TableReader<'t, 'd>, &'static str) -> Option<T>,
) -> Option<T> {
    let before = r.diagnostics.count();
    let value = read(r, key);
    if value.is_none() && r.diagnostics.count() == before {
        r.missing(key);
    }
    value
}

type TableEntry<'t> = (Spanned<String>, &'t DeValue<'t>, Span);

/// The entries of a dotted key; an entry that is not a table is returned unchanged.
fn undotted_entries((name, value, span): TableEntry) -> Vec<TableEntry> {
    let Some(table) = value.as_table().filter(|table| !table.is_empty()) else {
        return vec![(name, value, span)];
    };
    let mut inner: Vec<TableEntry> = table
        .iter()
        .map(|(key, value)| {
            let full = Spanned {
                value: format!("{}.{}", name.value, key.get_ref()),
                span: key.span(),
            };
            (full, value.get_ref(), value.span())
        })
        .flat_map(undotted_entries)
        .collect();
    sort_by_key(&mut inner, |(key, _, _)| key.span.start);
    inner
}

/// The part of `span` on its first line.
fn first_line(text: &str, span: Span) -> Span {
    let end = text[span.clone()]
        .find('\n')
        .map_or(span.end, |n| span.start + n);
    span.start..end
}
