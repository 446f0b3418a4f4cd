//! Expressions of macro statements: parsed and evaluated in one pass.
//!
//! Precedence: functions, then `* / MOD AND`, then `+ - OR XOR`, then comparisons, of which each pair of brackets may
//! hold one; its value is 1 or 0. A vacant variable counts as zero in an operation, stays vacant on its own, and is
//! not equal to zero.

use super::code::CodeCursor;
use super::function::{AngleRange, Function, Operator};
use super::variables::{Value, Variables};
use arcfeed_nc::alarm::Fault;
use arcfeed_nc::macro_alarm::MacroAlarm;

/// Maximum nesting of brackets.
const BRACKETS_MAX: u8 = 5;
/// Largest variable number.
const VARIABLE_MAX: f64 = 99_999.0;

/// Parses and evaluates macro expressions.
#[derive(Clone, Copy, Debug)]
pub struct Evaluator<'v> {
    variables: &'v Variables,
    angles: AngleRange,
    /// Decimals that ROUND keeps.
    decimals: i32,
    brackets: u8,
}

type Operators = [(&'static [u8], Operator)];

const PRODUCTS: &Operators =
    &[(b"*", Operator::Multiply), (b"/", Operator::Divide), (b"MOD", Operator::Modulo), (b"AND", Operator::And)];
const SUMS: &Operators =
    &[(b"+", Operator::Add), (b"-", Operator::Subtract), (b"OR", Operator::Or), (b"XOR", Operator::Xor)];

impl<'v> Evaluator<'v> {
    /// Evaluator for macro statements, in which ROUND gives whole numbers.
    pub fn new(variables: &'v Variables, angles: AngleRange) -> Self {
        Evaluator { variables, angles, decimals: 0, brackets: 0 }
    }

    /// Evaluator for the value of an NC word, in which ROUND keeps this number of decimals: those of the address's
    /// least increment.
    pub fn rounding_to(self, decimals: i32) -> Self {
        Evaluator { decimals, ..self }
    }

    /// Number of decimals that ROUND keeps.
    pub fn decimals_kept(&self) -> i32 {
        self.decimals
    }

    /// Evaluates an expression, as after `=`.
    ///
    /// # Errors
    /// The macro alarms of expressions, at their column.
    pub fn expression(mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        self.comparison(cursor)
    }

    /// Evaluates an expression in brackets.
    ///
    /// # Errors
    /// As [`Evaluator::expression`].
    pub fn bracketed(mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        self.brackets(cursor)
    }

    /// Evaluates a factor, as after an address: a number, a variable or an expression in brackets, with or without a
    /// sign.
    ///
    /// # Errors
    /// As [`Evaluator::expression`].
    pub fn factor(mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        self.signed(cursor)
    }

    /// Evaluates the number of a variable, after its `#`.
    ///
    /// # Errors
    /// As [`Evaluator::expression`].
    pub fn variable_number(mut self, cursor: &mut CodeCursor<'_>) -> Result<u32, Fault> {
        self.number_of_variable(cursor)
    }

    fn comparison(&mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        let left = self.sum(cursor)?;
        const COMPARISONS: [&[u8]; 6] = [b"EQ", b"NE", b"GT", b"GE", b"LT", b"LE"];
        let Some(comparison) = COMPARISONS.iter().find(|name| cursor.accept(name)) else { return Ok(left) };
        let right = self.sum(cursor)?;
        let (x, y) = (left.unwrap_or(0.0), right.unwrap_or(0.0));
        let is_equal = left.is_some() == right.is_some() && x == y;
        let holds = match *comparison {
            b"EQ" => is_equal,
            b"NE" => !is_equal,
            b"GT" => x > y,
            b"GE" => x >= y,
            b"LT" => x < y,
            _ => x <= y,
        };
        Ok(Some(f64::from(u8::from(holds))))
    }

    fn sum(&mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        self.chain(cursor, SUMS, |this, cursor| this.chain(cursor, PRODUCTS, Self::signed))
    }

    fn chain(
        &mut self,
        cursor: &mut CodeCursor<'_>,
        operators: &Operators,
        operand: impl Fn(&mut Self, &mut CodeCursor<'_>) -> Result<Value, Fault>,
    ) -> Result<Value, Fault> {
        let mut left = operand(self, cursor)?;
        loop {
            let column = cursor.column();
            let Some((_, operator)) = operators.iter().find(|(name, _)| cursor.accept(name)) else { return Ok(left) };
            let right = operand(self, cursor)?;
            let result = operator.apply(left.unwrap_or(0.0), right.unwrap_or(0.0));
            left = Some(result.map_err(|alarm| Fault::in_macro(alarm, column))?);
        }
    }

    fn signed(&mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        match cursor.peek() {
            // The sign of a number belongs to the number.
            Some(b'-') if !matches!(cursor.rest().get(1), Some(b'0'..=b'9' | b'.')) => {
                cursor.skip(1);
                Ok(self.primary(cursor)?.map(|value| -value))
            }
            Some(b'+') if !matches!(cursor.rest().get(1), Some(b'0'..=b'9' | b'.')) => {
                cursor.skip(1);
                self.primary(cursor)
            }
            _ => self.primary(cursor),
        }
    }

    fn primary(&mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        match cursor.peek() {
            Some(b'#') => {
                let column = cursor.column();
                cursor.skip(1);
                let number = self.number_of_variable(cursor)?;
                self.variables.read(number).map_err(|cause| Fault { cause, column })
            }
            Some(b'[') => self.brackets(cursor),
            Some(b'A'..=b'Z') => self.function(cursor).map(Some),
            Some(b'0'..=b'9' | b'.' | b'-' | b'+') => cursor.number().map(|number| Some(number.to_f64())),
            _ => Err(cursor.fault(MacroAlarm::ExpressionFormat)),
        }
    }

    fn number_of_variable(&mut self, cursor: &mut CodeCursor<'_>) -> Result<u32, Fault> {
        let column = cursor.column();
        if cursor.peek() == Some(b'[') {
            let value = libm::round(self.brackets(cursor)?.unwrap_or(0.0));
            if !(0.0..=VARIABLE_MAX).contains(&value) {
                return Err(Fault::in_macro(MacroAlarm::VariableNumber, column));
            }
            return Ok(value as u32);
        }
        cursor.digits()?.ok_or(Fault::in_macro(MacroAlarm::ExpressionFormat, column))
    }

    fn open(&mut self, cursor: &mut CodeCursor<'_>) -> Result<(), Fault> {
        if self.brackets == BRACKETS_MAX {
            return Err(cursor.fault(MacroAlarm::BracketNesting));
        }
        if !cursor.accept(b"[") {
            return Err(cursor.fault(MacroAlarm::ExpressionFormat));
        }
        self.brackets += 1;
        Ok(())
    }

    fn close(&mut self, cursor: &mut CodeCursor<'_>) -> Result<(), Fault> {
        if !cursor.accept(b"]") {
            return Err(cursor.fault(MacroAlarm::ExpressionFormat));
        }
        self.brackets -= 1;
        Ok(())
    }

    fn brackets(&mut self, cursor: &mut CodeCursor<'_>) -> Result<Value, Fault> {
        self.open(cursor)?;
        let value = self.comparison(cursor)?;
        self.close(cursor)?;
        Ok(value)
    }

    fn function(&mut self, cursor: &mut CodeCursor<'_>) -> Result<f64, Fault> {
        let column = cursor.column();
        let name = cursor.letters();
        let function = Function::named(name).ok_or(Fault::in_macro(MacroAlarm::ImproperFunction, column))?;
        let fault = |alarm| Fault::in_macro(alarm, column);
        cursor.skip(name.len());
        self.open(cursor)?;
        let first = self.comparison(cursor)?.unwrap_or(0.0);
        if cursor.accept(b",") {
            let second = self.comparison(cursor)?.unwrap_or(0.0);
            self.close(cursor)?;
            return function.apply_two(first, second, self.angles).map_err(fault);
        }
        self.close(cursor)?;
        if function == Function::Atan && cursor.rest().starts_with(b"/[") {
            cursor.skip(1);
            let second = self.brackets(cursor)?.unwrap_or(0.0);
            return function.apply_two(first, second, self.angles).map_err(fault);
        }
        if function == Function::Round {
            return Ok(rounded(first, self.decimals));
        }
        function.apply(first, self.angles).map_err(fault)
    }
}

/// Rounds half away from zero at this decimal.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = libm::pow(10.0, f64::from(decimals));
    libm::round(value * scale) / scale
}

/// The nearest whole number of a value; `None` if it lies outside the range.
pub(super) fn whole(value: Value, range: core::ops::RangeInclusive<u32>) -> Option<u32> {
    let rounded = libm::round(value?);
    let fits = (f64::from(*range.start())..=f64::from(*range.end())).contains(&rounded);
    fits.then_some(rounded as u32)
}

#[cfg(test)]
mod tests {
    use super::super::code::MacroCode;
    use super::super::variables::Context;
    use super::*;
    use arcfeed_nc::modal::Modal;
    use arcfeed_units::{LengthUnit, Micros};

    fn variables() -> Variables {
        let context = Context::new(&Modal::at_power_on(LengthUnit::Mm), Micros(0));
        let mut variables = Variables::new(context);
        for (number, value) in [(2, 2.0), (3, 3.0), (5, 0.0)] {
            variables.write(number, Some(value)).unwrap();
        }
        variables
    }

    fn evaluate(text: &str) -> Result<Value, Fault> {
        let (code, variables) = (MacroCode::new(text.as_bytes()), variables());
        let mut cursor = code.cursor();
        let value = Evaluator::new(&variables, AngleRange::Positive).expression(&mut cursor)?;
        if cursor.peek().is_none() { Ok(value) } else { Err(cursor.fault(MacroAlarm::ExpressionFormat)) }
    }

    #[test]
    fn operators_bind_as_on_the_control() {
        for (text, value) in [
            ("1+2*3", 7.0),
            ("[1+2]*3", 9.0),
            ("2-3-4", -5.0),
            ("12/2/3", 2.0),
            ("#2+#3*SIN[90]", 5.0),
            ("-#3+1", -2.0),
            ("#[#2+1]", 3.0),
            ("7MOD4+1", 4.0),
            ("6AND3OR8", 10.0),
            ("5XOR1", 4.0),
            ("ATAN[1]/[-1]", 135.0),
            ("ATAN[-1,-1]", 225.0),
            ("4/[1+1]", 2.0),
            ("POW[2,10]", 1024.0),
            ("ROUND[2.5]", 3.0),
            ("[[#2EQ2]AND[#3GT2]]", 1.0),
        ] {
            assert_eq!(evaluate(text), Ok(Some(value)), "{text}");
        }
    }

    #[test]
    fn a_vacant_variable_is_zero_in_a_sum_and_vacant_alone() {
        assert_eq!(evaluate("#1"), Ok(None));
        assert_eq!(evaluate("[#1]"), Ok(None));
        for (text, value) in [("#1*5", 0.0), ("#1+#1", 0.0)] {
            assert_eq!(evaluate(text), Ok(Some(value)), "{text}");
        }
        // The table of conditions in the operator's manual: vacant and zero.
        let table = [("#1EQ#0", 1.0), ("#1NE0", 1.0), ("#1GE#0", 1.0), ("#1GT0", 0.0), ("#1EQ0", 0.0), ("#1LE0", 1.0)];
        let zero = [("#5EQ#0", 0.0), ("#5NE0", 0.0), ("#5GE#0", 1.0), ("#5GT0", 0.0), ("#5EQ0", 1.0), ("#5NE#0", 1.0)];
        for (text, value) in table.into_iter().chain(zero) {
            assert_eq!(evaluate(text), Ok(Some(value)), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_an_alarm_at_its_column() {
        for (text, alarm, column) in [
            ("1/#5", MacroAlarm::DivisionByZero, 2),
            ("2+#34", MacroAlarm::VariableNumber, 3),
            ("[1+2", MacroAlarm::ExpressionFormat, 5),
            ("1+", MacroAlarm::ExpressionFormat, 3),
            ("##1", MacroAlarm::ExpressionFormat, 2),
            ("FOO[1]", MacroAlarm::ImproperFunction, 1),
            ("SQRT[-1]", MacroAlarm::IllegalArgument, 1),
            ("#[-1]", MacroAlarm::VariableNumber, 2),
            ("[[[[[[1]]]]]]", MacroAlarm::BracketNesting, 6),
            ("1 EQ 1 EQ 1", MacroAlarm::ExpressionFormat, 8),
        ] {
            assert_eq!(evaluate(text), Err(Fault::in_macro(alarm, column)), "{text}");
        }
        assert_eq!(evaluate("[[[[[1]]]]]"), Ok(Some(1.0)));
    }
}
