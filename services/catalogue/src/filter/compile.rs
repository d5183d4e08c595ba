//! From tokens to SQL, by recursive descent.

use std::collections::BTreeSet;

use super::lexer::{Number, Token, tokens};
use super::{Bind, Column, Compiled, FilterError, Join, Kind, OFFSET};

/// Deeper nesting is refused, so that no filter exhausts the stack.
const MOST_DEPTH: usize = 64;
/// Most values of one filter; SQLite could bind far more.
const MOST_VALUES: usize = 256;

/// Compiles a filter. `lookup` returns a column by its name; `names` are the names to suggest.
pub(crate) fn compile(
    text: &str,
    lookup: &dyn Fn(&str) -> Option<Column>,
    names: &[String],
) -> Result<Compiled, FilterError> {
    let tokens = tokens(text)?;
    let mut parser = Parser {
        tokens,
        next: 0,
        end: text.chars().count(),
        lookup,
        names,
        depth: 0,
        binds: Vec::new(),
        joins: BTreeSet::new(),
        asked: Vec::new(),
    };
    let sql = parser.either()?;
    if parser.next < parser.tokens.len() {
        return Err(parser.wrong("`and`, `or` or the end was expected"));
    }
    Ok(Compiled {
        sql,
        binds: parser.binds,
        joins: parser.joins,
        asked: parser.asked,
    })
}

struct Parser<'a> {
    tokens: Vec<(usize, Token)>,
    next: usize,
    end: usize,
    lookup: &'a dyn Fn(&str) -> Option<Column>,
    names: &'a [String],
    depth: usize,
    binds: Vec<Bind>,
    joins: BTreeSet<Join>,
    asked: Vec<Column>,
}

impl Parser<'_> {
    fn either(&mut self) -> Result<String, FilterError> {
        let mut sql = self.both()?;
        while self.keyword("or") {
            sql = format!("({sql} OR {})", self.both()?);
        }
        Ok(sql)
    }

    fn both(&mut self) -> Result<String, FilterError> {
        let mut sql = self.negation()?;
        while self.keyword("and") {
            sql = format!("({sql} AND {})", self.negation()?);
        }
        Ok(sql)
    }

    fn negation(&mut self) -> Result<String, FilterError> {
        self.depth += 1;
        if self.depth > MOST_DEPTH {
            return Err(self.wrong(&format!("nested more than {MOST_DEPTH} deep")));
        }
        let sql = if self.keyword("not") {
            format!("(NOT {})", self.negation()?)
        } else if self.sign("(") {
            let inner = self.either()?;
            self.expect(")")?;
            inner
        } else {
            self.comparison()?
        };
        self.depth -= 1;
        Ok(sql)
    }

    fn comparison(&mut self) -> Result<String, FilterError> {
        let position = self.position();
        let Some(Token::Word(name)) = self.peek().cloned() else {
            return Err(self.wrong("the name of a column was expected"));
        };
        self.next += 1;
        let column = (self.lookup)(&name).ok_or_else(|| FilterError {
            position,
            message: format!("unknown column `{name}`"),
            did_you_mean: spec::nearest(&name, self.names),
        })?;
        self.binds.extend(column.binds.iter().cloned());
        self.joins.extend(column.join.clone());
        if column.found.is_some() && !self.asked.contains(&column) {
            self.asked.push(column.clone());
        }
        let sql = &column.sql;
        // Two-valued: what is missing compares as false. Where nothing is missing an index can be used.
        let known = |condition: String| {
            if column.always {
                format!("({condition})")
            } else {
                format!("coalesce({condition}, 0)")
            }
        };
        if self.keyword("is") {
            let negated = if self.keyword("not") { " NOT" } else { "" };
            if !self.keyword("null") {
                return Err(self.wrong("`null` was expected"));
            }
            return Ok(format!("({sql} IS{negated} NULL)"));
        }
        if self.keyword("between") {
            self.ordered(&column)?;
            let low = self.value(&column)?;
            if !self.keyword("and") {
                return Err(self.wrong("`and` was expected between the two bounds"));
            }
            let high = self.value(&column)?;
            let is_empty = match (&low, &high) {
                (Bind::Number(low), Bind::Number(high)) => low > high,
                (Bind::Whole(low), Bind::Whole(high)) => low > high,
                _ => false,
            };
            if is_empty {
                return Err(self.wrong("the lower bound is above the upper bound"));
            }
            self.bind(low)?;
            self.bind(high)?;
            return Ok(known(format!("{sql} BETWEEN ? AND ?")));
        }
        let negated = self.keyword("not");
        if self.keyword("in") {
            let places = self.list(&column)?;
            return Ok(if negated {
                format!("(NOT {})", known(format!("{sql} IN ({places})")))
            } else {
                known(format!("{sql} IN ({places})"))
            });
        }
        if negated {
            return Err(self.wrong("`in` was expected after `not`"));
        }
        for (sign, operator) in [
            ("==", "="),
            ("=", "="),
            ("!=", "!="),
            ("<=", "<="),
            (">=", ">="),
            ("<", "<"),
            (">", ">"),
        ] {
            if self.sign(sign) {
                if !matches!(operator, "=" | "!=") {
                    self.ordered(&column)?;
                }
                let value = self.value(&column)?;
                self.bind(value)?;
                return Ok(known(format!("{sql} {operator} ?")));
            }
        }
        if column.kind == Kind::Bool {
            Ok(known(sql.clone()))
        } else {
            Err(self.wrong("a comparison was expected"))
        }
    }

    fn list(&mut self, column: &Column) -> Result<String, FilterError> {
        self.expect("(")?;
        let mut places = String::new();
        loop {
            let value = self.value(column)?;
            self.bind(value)?;
            places.push('?');
            if !self.sign(",") {
                break;
            }
            places.push_str(", ");
        }
        self.expect(")")?;
        Ok(places)
    }

    fn ordered(&self, column: &Column) -> Result<(), FilterError> {
        if column.kind.is_number() {
            Ok(())
        } else {
            Err(self.wrong("only numbers have an order"))
        }
    }

    fn value(&mut self, column: &Column) -> Result<Bind, FilterError> {
        let truth = |word: &str| match word.to_ascii_lowercase().as_str() {
            "true" => Some(1.0),
            "false" => Some(0.0),
            _ => None,
        };
        let value = match (self.peek(), column.kind) {
            (Some(Token::Number(number)), kind) if kind.is_number() => match bound(*number, kind) {
                Some(value) => value,
                None => {
                    return Err(
                        self.wrong(&format!("`{}` has a fraction, the column has none", number.value))
                    );
                }
            },
            (Some(Token::Text(text)), Kind::Text) => Bind::Text(text.clone()),
            (Some(Token::Word(word)), Kind::Bool) if truth(word).is_some() => {
                Bind::Number(truth(word).unwrap_or(0.0))
            }
            (_, Kind::Number | Kind::Whole | Kind::Large) => return Err(self.wrong("a number was expected")),
            (_, Kind::Text) => return Err(self.wrong("a text in quotes was expected")),
            (_, Kind::Bool) => return Err(self.wrong("`true` or `false` was expected")),
        };
        self.next += 1;
        Ok(value)
    }

    fn bind(&mut self, value: Bind) -> Result<(), FilterError> {
        if self.binds.len() == MOST_VALUES {
            return Err(self.wrong(&format!("more than {MOST_VALUES} values")));
        }
        self.binds.push(value);
        Ok(())
    }

    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.next).map(|(_, token)| token)
    }

    fn keyword(&mut self, keyword: &str) -> bool {
        let found = matches!(self.peek(), Some(Token::Word(word)) if word.eq_ignore_ascii_case(keyword));
        self.next += usize::from(found);
        found
    }

    fn sign(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Some(Token::Sign(found)) if *found == sign);
        self.next += usize::from(found);
        found
    }

    fn expect(&mut self, sign: &str) -> Result<(), FilterError> {
        if self.sign(sign) {
            Ok(())
        } else {
            Err(self.wrong(&format!("`{sign}` was expected")))
        }
    }

    fn position(&self) -> usize {
        self.tokens
            .get(self.next)
            .map_or(self.end, |(position, _)| *position)
    }

    fn wrong(&self, message: &str) -> FilterError {
        FilterError {
            position: self.position(),
            message: message.to_owned(),
            did_you_mean: None,
        }
    }
}

/// A number as it compares with a column; none where a column of large numbers cannot be compared with it.
fn bound(number: Number, kind: Kind) -> Option<Bind> {
    let whole = |number: i128| i64::try_from(number).ok().map(Bind::Whole);
    match (kind, number.whole) {
        (Kind::Large, None) => None,
        // Beyond all large numbers on one side.
        (Kind::Large, Some(exact)) => {
            whole(exact - OFFSET).or(Some(Bind::Number(f64::INFINITY.copysign(number.value))))
        }
        (Kind::Whole, Some(exact)) => whole(exact).or(Some(Bind::Number(number.value))),
        _ => Some(Bind::Number(number.value)),
    }
}

#[cfg(test)]
mod tests;
