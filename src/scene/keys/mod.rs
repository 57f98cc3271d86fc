//! The keys of every table in a file and the values they take: one list, shared by the reader, its "did you mean", the
//! schema for editors and the documents.

mod bodies;
pub mod linkage;
mod machine_parts;
pub mod results;
mod shapes;
pub mod tables;
pub mod view;

/// The keys of one table.
#[derive(Debug)]
pub struct Keys {
    /// What the table is called in messages and in the schema.
    pub name: &'static str,
    /// In the order in which the documents list them.
    pub list: &'static [Key],
    /// Keys of which a table must have exactly one; empty if any may appear.
    pub one_of: &'static [&'static str],
}

/// One key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As typed.
    pub name: &'static str,
    /// What it holds.
    pub holds: Holds,
    /// A required key.
    pub is_required: bool,
    /// The smallest number of items of a list.
    pub least: usize,
    /// Has a meaning only beside this key.
    pub needs: Option<&'static str>,
    /// Must not stand beside this key.
    pub excludes: Option<&'static str>,
    /// What it means, and what holds without it: for hints, the schema and the documents.
    pub says: &'static str,
}

/// What a key holds.
#[derive(Clone, Copy, Debug)]
pub enum Holds {
    /// A text.
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// This many texts.
    Texts(usize),
    /// `true` or `false`.
    Flag,
    /// A number, or a formula in quotes.
    Formula,
    /// A text that is a chain of transforms, or the name of one.
    Chain,
    /// A list of this many of them; zero means any number.
    Formulas(usize),
    /// A list of lists of this length.
    Rows(usize),
    /// `#rrggbb`.
    Colour,
    /// A table.
    Table(&'static Keys),
    /// A list of tables.
    Tables(&'static Keys),
    /// A table whose keys are names of the user's choice, each with one of these.
    Named(&'static [Holds]),
    /// One of these.
    Any(&'static [Holds]),
}

/// Names with a number or a formula each.
pub(crate) const FORMULAS_BY_NAME: Holds = Holds::Named(&[Holds::Formula]);

impl Key {
    /// An optional key.
    pub const fn new(name: &'static str, holds: Holds, says: &'static str) -> Self {
        Self {
            name,
            holds,
            is_required: false,
            least: 0,
            needs: None,
            excludes: None,
            says,
        }
    }

    /// A required key.
    pub const fn required(self) -> Self {
        Self {
            is_required: true,
            ..self
        }
    }

    /// A list of at least this many items.
    pub const fn at_least(self, least: usize) -> Self {
        Self { least, ..self }
    }

    /// Only beside the key `other`.
    pub const fn beside(self, other: &'static str) -> Self {
        Self {
            needs: Some(other),
            ..self
        }
    }

    /// Never beside the key `other`.
    pub const fn without(self, other: &'static str) -> Self {
        Self {
            excludes: Some(other),
            ..self
        }
    }
}

impl Keys {
    /// A table with any of these keys.
    pub const fn new(name: &'static str, list: &'static [Key]) -> Self {
        Self {
            name,
            list,
            one_of: &[],
        }
    }

    /// A table with exactly one of `one_of` among its keys.
    pub const fn with_one_of(
        name: &'static str,
        list: &'static [Key],
        one_of: &'static [&'static str],
    ) -> Self {
        Self { name, list, one_of }
    }

    /// The key of that name.
    pub fn find(&self, name: &str) -> Option<&'static Key> {
        self.list.iter().find(|key| key.name == name)
    }

    /// All names.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.list.iter().map(|key| key.name)
    }

    /// The keys of the table, or of each table of the list, at `name`; none if it is anything else.
    pub fn inner(&self, name: &str) -> &'static Keys {
        match self.find(name).map(|key| key.holds) {
            Some(Holds::Table(keys) | Holds::Tables(keys)) => keys,
            _ => &NONE,
        }
    }
}

/// The names in a list of pairs of names and values.
const fn words<T: Copy, const N: usize>(named: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut k = 0;
    while k < N {
        words[k] = named[k].0;
        k += 1;
    }
    words
}

/// A table without keys.
pub static NONE: Keys = Keys::new("nothing", &[]);
