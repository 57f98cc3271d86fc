//! Formulas as they stand in a scene, read by recursive descent. No names are looked up here.

/// A formula as typed. Numbers stay decimal texts: nothing is rounded while reading.
#[derive(Clone, Debug)]
pub enum Node {
    Number(String),
    /// `30deg`.
    Degrees(String),
    /// `0.5rad`.
    Radians(String),
    Pi,
    Name(String),
    Negative(Box<Node>),
    Binary(char, Box<Node>, Box<Node>),
    Call(String, Vec<Node>),
    /// A part in the file's unit of angle.
    FileUnit(Box<Node>),
}

impl Node {
    /// Calls `visit` with every name.
    pub fn visit_names(&self, visit: &mut dyn FnMut(&str)) {
        match self {
            Self::Name(name) => visit(name),
            Self::Negative(inner) | Self::FileUnit(inner) => inner.visit_names(visit),
            Self::Binary(_, a, b) => {
                a.visit_names(visit);
                b.visit_names(visit);
            }
            Self::Call(_, all) => all.iter().for_each(|a| a.visit_names(visit)),
            Self::Number(_) | Self::Degrees(_) | Self::Radians(_) | Self::Pi => {}
        }
    }
}

/// Reads a whole formula.
pub fn parse(text: &str) -> Node {
    let mut reader = Reader::new(text);
    let node = reader.sum();
    assert!(
        reader.rest().is_empty(),
        "`{}` is left of `{text}`",
        reader.rest()
    );
    node
}

/// What is left of a text.
pub struct Reader<'a> {
    rest: &'a str,
}

impl<'a> Reader<'a> {
    pub fn new(text: &'a str) -> Self {
        Self {
            rest: text.trim_start(),
        }
    }

    pub fn rest(&self) -> &'a str {
        self.rest
    }

    /// Takes `length` bytes and the spaces behind them.
    fn take(&mut self, length: usize) -> &'a str {
        let (taken, rest) = self.rest.split_at(length);
        self.rest = rest.trim_start();
        taken
    }

    /// Takes one of `signs` if it comes next.
    pub fn sign(&mut self, signs: &[char]) -> Option<char> {
        let found = self.rest.chars().next().filter(|c| signs.contains(c))?;
        self.take(found.len_utf8());
        Some(found)
    }

    pub fn must(&mut self, sign: char) {
        assert!(
            self.sign(&[sign]).is_some(),
            "no `{sign}` before `{}`",
            self.rest
        );
    }

    /// Takes a name if one comes next.
    pub fn name(&mut self) -> Option<&'a str> {
        let first = self.rest.chars().next()?;
        if !(first.is_alphabetic() || first == '_') {
            return None;
        }
        let within = |c: char| c.is_alphanumeric() || ['_', '.', '\''].contains(&c);
        let end = self.rest.find(|c| !within(c)).unwrap_or(self.rest.len());
        Some(self.take(end))
    }

    pub fn sum(&mut self) -> Node {
        let mut left = self.product();
        while let Some(sign) = self.sign(&['+', '-', '−']) {
            let sign = if sign == '−' { '-' } else { sign };
            left = Node::Binary(sign, Box::new(left), Box::new(self.product()));
        }
        left
    }

    /// Formulas between a parenthesis that is taken already and its end.
    pub fn arguments(&mut self) -> Vec<Node> {
        let mut all = vec![self.sum()];
        while self.sign(&[',']).is_some() {
            all.push(self.sum());
        }
        self.must(')');
        all
    }

    fn product(&mut self) -> Node {
        let mut left = self.factor();
        while let Some(sign) = self.sign(&['*', '/', '·', '×']) {
            let sign = if sign == '/' { '/' } else { '*' };
            left = Node::Binary(sign, Box::new(left), Box::new(self.factor()));
        }
        left
    }

    /// A sign binds weaker than a power: -2^2 is -4.
    fn factor(&mut self) -> Node {
        match self.sign(&['+', '-', '−']) {
            Some('+') => self.factor(),
            Some(_) => Node::Negative(Box::new(self.factor())),
            None => {
                let base = self.parse_atom();
                match self.sign(&['^']) {
                    Some(_) => Node::Binary('^', Box::new(base), Box::new(self.factor())),
                    None => base,
                }
            }
        }
    }

    fn parse_atom(&mut self) -> Node {
        if self.sign(&['(']).is_some() {
            let inner = self.sum();
            self.must(')');
            return inner;
        }
        match self.name() {
            Some("pi" | "π") => Node::Pi,
            Some(name) if self.sign(&['(']).is_some() => {
                Node::Call(name.to_owned(), self.arguments())
            }
            Some(name) => Node::Name(name.to_owned()),
            None => self.number(),
        }
    }

    fn number(&mut self) -> Node {
        let bytes = self.rest.as_bytes();
        let digits = |from: usize| {
            let digit = |b: &&u8| b.is_ascii_digit() || **b == b'.';
            from + bytes[from..].iter().take_while(digit).count()
        };
        let mut end = digits(0);
        assert!(end > 0, "no number before `{}`", self.rest);
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            end = digits(end + 1 + sign);
        }
        let unit = &self.rest[end..];
        // The unit belongs to the number where it follows at once, and is a whole word.
        let named = |unit_name: &str| {
            let behind = unit.strip_prefix(unit_name);
            behind.is_some_and(|b| !b.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        };
        let (is_degrees, is_radians) = (named("deg"), named("rad"));
        let digits = self.take(end).to_owned();
        if is_degrees || is_radians {
            self.take(3);
        }
        match (is_degrees, is_radians) {
            (true, _) => Node::Degrees(digits),
            (_, true) => Node::Radians(digits),
            _ => Node::Number(digits),
        }
    }
}
