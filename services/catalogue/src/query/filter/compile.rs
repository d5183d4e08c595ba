//! From tokens to SQL, by recursive descent.

use std::collections::BTreeSet;

use columnar::{Condition, Sign, Test, Value};
use serde_json::json;

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
        recorded: Vec::new(),
    };
    let clause = parser.either()?;
    if parser.next < parser.tokens.len() {
        return Err(parser.wrong("`and`, `or` or the end was expected"));
    }
    Ok(Compiled {
        sql: clause.sql,
        binds: parser.binds,
        joins: parser.joins,
        recorded: parser.recorded,
        condition: clause.condition,
    })
}

/// A condition as SQL and for the replica.
struct Clause {
    sql: String,
    condition: Option<Condition>,
}

impl Clause {
    fn combine(self, word: &str, other: Self, all: impl FnOnce(Vec<Condition>) -> Condition) -> Self {
        let pair = self.condition.zip(other.condition);
        Self {
            sql: format!("({} {word} {})", self.sql, other.sql),
            condition: pair.map(|(one, other)| all(vec![one, other])),
        }
    }

    fn not(self) -> Self {
        Self {
            sql: format!("(NOT {})", self.sql),
            condition: self.condition.map(|one| Condition::Not(Box::new(one))),
        }
    }
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
    recorded: Vec<Column>,
}

impl Parser<'_> {
    fn either(&mut self) -> Result<Clause, FilterError> {
        let mut clause = self.both()?;
        while self.keyword("or") {
            clause = clause.combine("OR", self.both()?, Condition::Any);
        }
        Ok(clause)
    }

    fn both(&mut self) -> Result<Clause, FilterError> {
        let mut clause = self.negation()?;
        while self.keyword("and") {
            clause = clause.combine("AND", self.negation()?, Condition::All);
        }
        Ok(clause)
    }

    fn negation(&mut self) -> Result<Clause, FilterError> {
        self.depth += 1;
        if self.depth > MOST_DEPTH {
            return Err(self.wrong(&format!("nested more than {MOST_DEPTH} deep")));
        }
        let clause = if self.keyword("not") {
            self.negation()?.not()
        } else if self.sign("(") {
            let inner = self.either()?;
            self.expect(")")?;
            inner
        } else {
            self.comparison()?
        };
        self.depth -= 1;
        Ok(clause)
    }

    fn comparison(&mut self) -> Result<Clause, FilterError> {
        let position = self.position();
        let Some(Token::Word(name)) = self.peek().cloned() else {
            return Err(self.wrong("the name of a column was expected"));
        };
        self.next += 1;
        let column = (self.lookup)(&name).ok_or_else(|| FilterError {
            position: Some(position),
            parameter: None,
            message: format!("unknown column `{name}`"),
            did_you_mean: spec::nearest(&name, self.names),
        })?;
        let column = match self.compared_kind() {
            Some(kind) => column.typed(kind),
            None => column,
        };
        self.binds.extend(column.binds.iter().cloned());
        self.joins.extend(column.join.clone());
        if column.found.is_some() && !self.recorded.contains(&column) {
            self.recorded.push(column.clone());
        }
        if self.keyword("is") {
            let negated = self.keyword("not");
            if !self.keyword("null") {
                return Err(self.wrong("`null` was expected"));
            }
            let clause = tested(&column, format!("({} IS NULL)", column.sql), Test::IsMissing);
            return Ok(match negated {
                true => Clause {
                    sql: format!("({} IS NOT NULL)", column.sql),
                    ..clause.not()
                },
                false => clause,
            });
        }
        if self.keyword("between") {
            return self.between(&column);
        }
        let negated = self.keyword("not");
        if self.keyword("in") {
            let clause = self.list(&column)?;
            return Ok(if negated { clause.not() } else { clause });
        }
        if negated {
            return Err(self.wrong("`in` was expected after `not`"));
        }
        for (text, operator, sign) in SIGNS {
            if self.sign(text) {
                if !matches!(operator, "=" | "!=") {
                    self.ordered(&column)?;
                }
                let value = self.value(&column)?;
                self.bind(&column, value.clone())?;
                let sql = known(&column, format!("{} {operator} {}", column.sql, column.place));
                return Ok(tested(&column, sql, Test::Is(sign, of_bind(value))));
            }
        }
        if column.kind == Kind::Bool {
            let test = Test::Is(Sign::Unequal, Value::Whole(0));
            Ok(tested(&column, known(&column, column.sql.clone()), test))
        } else {
            Err(self.wrong("a comparison was expected"))
        }
    }

    fn between(&mut self, column: &Column) -> Result<Clause, FilterError> {
        self.ordered(column)?;
        let low = self.value(column)?;
        if !self.keyword("and") {
            return Err(self.wrong("`and` was expected between the two bounds"));
        }
        let high = self.value(column)?;
        let is_empty = match (&low, &high) {
            (Bind::Number(low), Bind::Number(high)) => low > high,
            (Bind::Whole(low), Bind::Whole(high)) => low > high,
            _ => false,
        };
        if is_empty {
            return Err(self.wrong("the lower bound is above the upper bound"));
        }
        self.bind(column, low.clone())?;
        self.bind(column, high.clone())?;
        let place = column.place;
        let sql = known(column, format!("{} BETWEEN {place} AND {place}", column.sql));
        Ok(tested(column, sql, Test::Between(of_bind(low), of_bind(high))))
    }

    fn list(&mut self, column: &Column) -> Result<Clause, FilterError> {
        self.expect("(")?;
        let (mut places, mut values) = (String::new(), Vec::new());
        loop {
            let value = self.value(column)?;
            self.bind(column, value.clone())?;
            values.push(of_bind(value));
            places.push_str(column.place);
            if !self.sign(",") {
                break;
            }
            places.push_str(", ");
        }
        self.expect(")")?;
        let sql = known(column, format!("{} IN ({places})", column.sql));
        Ok(tested(column, sql, Test::In(values)))
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
            (Some(Token::Number(number)), kind) if kind.is_number() => {
                match bound(*number, exact_kind(column)) {
                    Some(value) => value,
                    None => {
                        return Err(
                            self.wrong(&format!("`{}` has a fraction, the column has none", number.value))
                        );
                    }
                }
            }
            (Some(Token::Text(text)), Kind::Text) => Bind::Text(text.clone()),
            (Some(Token::Word(word)), Kind::Bool) if truth(word).is_some() => {
                Bind::Number(truth(word).unwrap_or(0.0))
            }
            (_, Kind::Number | Kind::Whole | Kind::Large) => return Err(self.wrong("a number was expected")),
            (_, Kind::Text | Kind::Label) => return Err(self.wrong("a text in quotes was expected")),
            (_, Kind::Bool) => return Err(self.wrong("`true` or `false` was expected")),
        };
        self.next += 1;
        Ok(value)
    }

    fn bind(&mut self, column: &Column, value: Bind) -> Result<(), FilterError> {
        if self.binds.len() == MOST_VALUES {
            return Err(self.wrong(&format!("more than {MOST_VALUES} values")));
        }
        self.binds.push(match value {
            Bind::Number(number) if column.compares_json() => Bind::Text(json!(number).to_string()),
            Bind::Whole(number) if column.compares_json() => Bind::Text(number.to_string()),
            value => value,
        });
        Ok(())
    }

    /// The type of the first compared value, for columns of several types; `None` for `is null`. A column alone is a
    /// truth value.
    fn compared_kind(&self) -> Option<Kind> {
        // `not in (` comes before the value.
        const MOST_TOKENS: usize = 4;
        for (_, token) in self.tokens.iter().skip(self.next).take(MOST_TOKENS) {
            match token {
                Token::Number(_) => return Some(Kind::Number),
                Token::Text(_) => return Some(Kind::Text),
                Token::Word(word) => match word.to_ascii_lowercase().as_str() {
                    "is" => return None,
                    "not" | "in" | "between" => {}
                    _ => return Some(Kind::Bool),
                },
                Token::Sign(")") => return Some(Kind::Bool),
                Token::Sign(_) => {}
            }
        }
        Some(Kind::Bool)
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
            position: Some(self.position()),
            parameter: None,
            message: message.to_owned(),
            did_you_mean: None,
        }
    }
}

/// Operators as written, in SQL and for the replica; longer ones precede their prefixes.
const SIGNS: [(&str, &str, Sign); 7] = [
    ("==", "=", Sign::Equal),
    ("=", "=", Sign::Equal),
    ("!=", "!=", Sign::Unequal),
    ("<=", "<=", Sign::AtMost),
    (">=", ">=", Sign::AtLeast),
    ("<", "<", Sign::Below),
    (">", ">", Sign::Above),
];

/// Two-valued logic: a missing value compares as false. Without missing values, an index can be used.
fn known(column: &Column, condition: String) -> String {
    if column.always {
        format!("({condition})")
    } else {
        format!("coalesce({condition}, 0)")
    }
}

fn tested(column: &Column, sql: String, test: Test) -> Clause {
    let name = column.replica_name.clone();
    Clause {
        sql,
        condition: name.map(|name| Condition::Test(name, test)),
    }
}

fn of_bind(bind: Bind) -> Value {
    match bind {
        Bind::Number(number) => Value::Number(number),
        Bind::Whole(number) => Value::Whole(number),
        Bind::Text(text) => Value::Text(text),
    }
}

/// The kind of a bound number: labels keep all digits of whole numbers.
fn exact_kind(column: &Column) -> Kind {
    if column.compares_json() {
        Kind::Whole
    } else {
        column.kind
    }
}

/// A number in the form of a column; `None` if it is out of range for a column of large numbers.
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
