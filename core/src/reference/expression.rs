//! Light-path expressions: which paths count (Heckbert 1990, as Bastos 1999, §4.2 uses them).
//!
//! A path is written from the light to the eye: `L`, one letter a surface, `D` where its Lambertian part
//! reflects and `S` where its specular lobe does, then `E`. A solid of glass
//! that light goes through is an `S` too, a pane is no letter. An expression is a regular expression over
//! these letters: `LDE`, `L(D|S)*SE`, `LE|LD{2}E`. Paths are traced from the eye, so what is compiled is the
//! expression read backwards, by derivatives (Brzozowski 1964), into a table of states.

use std::{fmt, str::FromStr};

/// States of a compiled expression at most.
pub const MOST_STATES: usize = 32;

/// Times that `{n}` may repeat.
const MOST_REPEATS: u32 = 16;

/// Characters of an expression, at most.
const MOST_CHARACTERS: usize = 256;

/// Parentheses within each other, at most.
const MOST_NESTED: usize = 32;

/// Letters of an expression written out, repetitions one by one, at most.
const MOST_LETTERS: usize = 1024;

/// Why a text is no light-path expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExpressionError {
    /// A character that has no place where it stands.
    #[error("light paths \"{text}\": {what} at place {place}")]
    Syntax {
        /// The text.
        text: String,
        /// What is wrong.
        what: String,
        /// Where, counted from 1.
        place: usize,
    },
    /// It needs too many states, or is longer than anything anybody means.
    #[error("light paths \"{0}\": too long; at most {MOST_STATES} states are kept")]
    TooLong(String),
    /// No path is meant.
    #[error("light paths \"{0}\": no path from a light L to the eye E is like that")]
    Nothing(String),
}

/// Where reading stands: what leads on from each state, and what arriving at a light in it counts as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Automaton {
    /// For each state, the states after `D` and after `S`; `None` where nothing can follow.
    pub(super) next: Vec<[Option<u8>; 2]>,
    /// For each state, the output to which light counts that is met in it.
    pub(super) counts_as: Vec<Option<u8>>,
}

impl Automaton {
    /// The terms of the picture: 0 emitted `LE`, 1 direct `LDE`, 2 indirect `L(D|S)+DE`, 3 specular `L(D|S)*SE`.
    pub fn terms() -> Self {
        let to = |d: u8, s: u8| [Some(d), Some(s)];
        Self {
            next: vec![to(1, 3), to(2, 2), to(2, 2), to(3, 3)],
            counts_as: vec![Some(0), Some(1), Some(2), Some(3)],
        }
    }
}

/// Which paths without a specular reflection are meant, by their number of diffuse ones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounces {
    /// Whether `LE`, `LDE`, `LDDE`, … are.
    pub counted: Vec<bool>,
    /// Whether all longer ones are.
    pub rest: bool,
}

impl Bounces {
    /// Whether any of them is in each term: emitted, direct, indirect, specular.
    pub fn terms(&self) -> [bool; 4] {
        let of = |k: usize| self.counted.get(k).copied().unwrap_or(self.rest);
        [of(0), of(1), self.rest || self.counted.iter().skip(2).any(|c| *c), false]
    }
}

/// Bounces told apart, at most: what comes after is dark, but in a room that absorbs less than a twentieth.
const MOST_BOUNCES: usize = 128;

/// A light-path expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expression {
    text: String,
    automaton: Automaton,
}

impl Expression {
    /// The compiled table, whose only output is 0.
    pub fn automaton(&self) -> &Automaton {
        &self.automaton
    }

    /// Whether a path is meant, written from the light to the eye as `LDSE`.
    pub fn holds(&self, path: &str) -> bool {
        let Some(surfaces) = path.strip_prefix('L').and_then(|p| p.strip_suffix('E')) else { return false };
        let end = surfaces.chars().rev().try_fold(0u8, |state, letter| {
            let column = ['D', 'S'].iter().position(|l| *l == letter)?;
            self.automaton.next[state as usize][column]
        });
        end.is_some_and(|state| self.automaton.counts_as[state as usize].is_some())
    }

    /// Which diffuse bounces are meant.
    pub fn bounces(&self) -> Bounces {
        let (mut counted, mut state) = (Vec::new(), 0u8);
        loop {
            let counts = self.automaton.counts_as[state as usize].is_some();
            counted.push(counts);
            match self.automaton.next[state as usize][0] {
                Some(next) if next == state => return Bounces { counted, rest: counts },
                Some(next) if counted.len() < MOST_BOUNCES => state = next,
                _ => return Bounces { counted, rest: false },
            }
        }
    }

    /// How much of each term of [`Automaton::terms`] it means: all of it (true) or none; `None` where that holds
    /// for one of them in part only, so that no weights of the terms show it.
    pub fn of_terms(&self) -> Option<[bool; 4]> {
        let terms = Automaton::terms();
        let mut found = [(false, false); 4];
        let mut open = vec![(0u8, Some(0u8))];
        let mut known = open.clone();
        while let Some((term, own)) = open.pop() {
            if let Some(output) = terms.counts_as[term as usize] {
                let counts = own.is_some_and(|s| self.automaton.counts_as[s as usize].is_some());
                let (all, any) = &mut found[output as usize];
                *(if counts { any } else { all }) = true;
            }
            for letter in 0..2 {
                let Some(next) = terms.next[term as usize][letter] else { continue };
                let pair = (next, own.and_then(|s| self.automaton.next[s as usize][letter]));
                if !known.contains(&pair) {
                    known.push(pair);
                    open.push(pair);
                }
            }
        }
        let whole = found.iter().all(|(missing, met)| !(*missing && *met));
        whole.then(|| found.map(|(_, met)| met))
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        if text.chars().nth(MOST_CHARACTERS).is_some() {
            return Err(ExpressionError::TooLong(format!("{}…", text.chars().take(40).collect::<String>())));
        }
        let mut reader = Reader { text: &text, letters: text.chars().collect(), at: 0, nested: 0 };
        let whole = reader.alternatives()?;
        if reader.at < reader.letters.len() {
            return Err(reader.wrong("an unmatched )"));
        }
        let mut states = vec![whole.backwards().after('E')];
        let (mut next, mut counts_as) = (Vec::new(), Vec::new());
        while next.len() < states.len() {
            let state = states[next.len()].clone();
            counts_as.push(state.after('L').is_empty_path().then_some(0));
            next.push(['D', 'S'].map(|letter| {
                let after = state.after(letter);
                if after == Paths::None {
                    return None;
                }
                let known = states.iter().position(|s| *s == after).unwrap_or_else(|| {
                    states.push(after);
                    states.len() - 1
                });
                Some(known as u8)
            }));
            if states.len() > MOST_STATES {
                return Err(ExpressionError::TooLong(text));
            }
        }
        if counts_as.iter().all(Option::is_none) {
            return Err(ExpressionError::Nothing(text));
        }
        Ok(Self { text, automaton: Automaton { next, counts_as } })
    }
}

/// A set of paths.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Paths {
    None,
    Empty,
    Letter(char),
    Then(Box<Paths>, Box<Paths>),
    Either(Vec<Paths>),
    Repeated(Box<Paths>),
}

impl Paths {
    fn then(self, other: Self) -> Self {
        match (self, other) {
            (Self::None, _) | (_, Self::None) => Self::None,
            (Self::Empty, p) | (p, Self::Empty) => p,
            // To the right, so that equal sets look alike.
            (Self::Then(a, b), p) => a.then(b.then(p)),
            (a, b) => Self::Then(Box::new(a), Box::new(b)),
        }
    }

    fn either(self, other: Self) -> Self {
        let mut all = Vec::new();
        for p in [self, other] {
            match p {
                Self::None => {}
                Self::Either(list) => all.extend(list),
                p => all.push(p),
            }
        }
        all.sort_unstable();
        all.dedup();
        match all.len() {
            0 => Self::None,
            1 => all.remove(0),
            _ => Self::Either(all),
        }
    }

    fn repeated(self) -> Self {
        match self {
            Self::None | Self::Empty => Self::Empty,
            Self::Repeated(p) => Self::Repeated(p),
            p => Self::Repeated(Box::new(p)),
        }
    }

    /// Whether more of the same adds nothing: p* or pp*.
    fn is_repeated(&self) -> bool {
        match self {
            Self::Repeated(_) => true,
            Self::Then(first, rest) => matches!(&**rest, Self::Repeated(p) if p == first),
            _ => false,
        }
    }

    /// Letters in it.
    fn letters(&self) -> usize {
        match self {
            Self::None | Self::Empty => 0,
            Self::Letter(_) => 1,
            Self::Then(a, b) => a.letters() + b.letters(),
            Self::Either(list) => list.iter().map(Self::letters).sum(),
            Self::Repeated(p) => p.letters(),
        }
    }

    fn is_empty_path(&self) -> bool {
        match self {
            Self::None | Self::Letter(_) => false,
            Self::Empty | Self::Repeated(_) => true,
            Self::Then(a, b) => a.is_empty_path() && b.is_empty_path(),
            Self::Either(list) => list.iter().any(Self::is_empty_path),
        }
    }

    fn backwards(self) -> Self {
        match self {
            Self::Then(a, b) => b.backwards().then(a.backwards()),
            Self::Either(list) => list.into_iter().fold(Self::None, |all, p| all.either(p.backwards())),
            Self::Repeated(p) => p.backwards().repeated(),
            other => other,
        }
    }

    /// What may follow a letter: the derivative.
    fn after(&self, letter: char) -> Self {
        match self {
            Self::None | Self::Empty => Self::None,
            Self::Letter(l) if *l == letter => Self::Empty,
            Self::Letter(_) => Self::None,
            Self::Either(list) => list.iter().fold(Self::None, |all, p| all.either(p.after(letter))),
            Self::Repeated(p) => p.after(letter).then(self.clone()),
            Self::Then(a, b) => {
                let first = a.after(letter).then((**b).clone());
                if a.is_empty_path() { first.either(b.after(letter)) } else { first }
            }
        }
    }
}

struct Reader<'a> {
    text: &'a str,
    letters: Vec<char>,
    at: usize,
    nested: usize,
}

impl Reader<'_> {
    fn wrong(&self, what: &str) -> ExpressionError {
        ExpressionError::Syntax { text: self.text.into(), what: what.into(), place: self.at + 1 }
    }

    fn peek(&self) -> Option<char> {
        self.letters.get(self.at).copied()
    }

    fn alternatives(&mut self) -> Result<Paths, ExpressionError> {
        let mut all = self.sequence()?;
        while self.peek() == Some('|') {
            self.at += 1;
            all = all.either(self.sequence()?);
        }
        Ok(all)
    }

    fn sequence(&mut self) -> Result<Paths, ExpressionError> {
        let mut all = Paths::Empty;
        while let Some(letter) = self.peek().filter(|c| !"|)".contains(*c)) {
            self.at += 1;
            let atom = match letter {
                'L' | 'D' | 'S' | 'E' => Paths::Letter(letter),
                '.' => Paths::Letter('D').either(Paths::Letter('S')),
                '(' if self.nested == MOST_NESTED => {
                    self.at -= 1;
                    return Err(self.wrong(&format!("more than {MOST_NESTED} parentheses within each other")));
                }
                '(' => {
                    self.nested += 1;
                    let inner = self.alternatives()?;
                    self.nested -= 1;
                    if self.peek() != Some(')') {
                        return Err(self.wrong("a ( that is never closed"));
                    }
                    self.at += 1;
                    inner
                }
                other => {
                    self.at -= 1;
                    return Err(self.wrong(&format!("'{other}', where L, D, S, E, ., (, | or ) may stand")));
                }
            };
            all = all.then(self.count(atom)?);
        }
        Ok(all)
    }

    /// What follows an atom: `*`, `+`, `?` or `{n}`.
    fn count(&mut self, atom: Paths) -> Result<Paths, ExpressionError> {
        let counted = match self.peek() {
            Some('*') => atom.repeated(),
            Some('+') if atom.is_repeated() => atom,
            Some('+') => {
                self.fits(&atom, 2)?;
                atom.clone().then(atom.repeated())
            }
            Some('?') => atom.either(Paths::Empty),
            Some('{') => {
                let digits: String =
                    self.letters[self.at + 1..].iter().take_while(|c| c.is_ascii_digit()).collect();
                let end = self.at + 1 + digits.len();
                match digits.parse::<u32>() {
                    Ok(n) if n <= MOST_REPEATS && self.letters.get(end) == Some(&'}') => {
                        self.fits(&atom, n)?;
                        self.at = end;
                        (0..n).fold(Paths::Empty, |all, _| all.then(atom.clone()))
                    }
                    _ => {
                        return Err(
                            self.wrong(&format!("a count that is not one of {{0}} to {{{MOST_REPEATS}}}"))
                        );
                    }
                }
            }
            _ => return Ok(atom),
        };
        self.at += 1;
        Ok(counted)
    }
    /// Whether an atom may be written out `times` times.
    fn fits(&self, atom: &Paths, times: u32) -> Result<(), ExpressionError> {
        let fits = atom.letters() * times as usize <= MOST_LETTERS;
        if fits { Ok(()) } else { Err(ExpressionError::TooLong(self.text.into())) }
    }
}
