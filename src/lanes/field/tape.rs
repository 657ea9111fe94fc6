//! A field f(x, y, z) as a list of operations, each on results of earlier ones.
//!
//! The tape is written once and evaluated in any arithmetic: numbers, lanes,
//! intervals, numbers with gradients, polynomials along a ray. Constants are kept as exact
//! rationals, as written.

use num_rational::BigRational;

/// The place of an operation and its result on the tape.
pub type Place = usize;

/// Functions of one value; angles are in radians, logarithms natural.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unary {
    Negative,
    SquareRoot,
    Absolute,
    Exponential,
    Logarithm,
    Sine,
    Cosine,
    Tangent,
    ArcSine,
    ArcCosine,
    ArcTangent,
    HyperbolicSine,
    HyperbolicCosine,
    HyperbolicTangent,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binary {
    Sum,
    Difference,
    Product,
    Quotient,
    Minimum,
    Maximum,
    /// Angle of the point (b, a), radians in (−π, π].
    ArcTangent2,
    /// aᵇ for a > 0 and an exponent that is no whole number.
    Power,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operation {
    /// x, y or z: 0, 1, 2.
    Coordinate(usize),
    Constant(usize),
    Unary(Unary, Place),
    Binary(Binary, Place, Place),
    /// An earlier result to a whole power; negative ones divide.
    WholePower(Place, i32),
}

/// An arithmetic in which a tape can be evaluated.
pub trait Algebra {
    type Value: Clone;
    fn coordinate(&self, axis: usize) -> Self::Value;
    fn constant(&self, index: usize, exact: &BigRational) -> Self::Value;
    fn unary(&self, function: Unary, a: &Self::Value) -> Self::Value;
    fn binary(&self, function: Binary, a: &Self::Value, b: &Self::Value) -> Self::Value;
    fn whole_power(&self, a: &Self::Value, n: i32) -> Self::Value;
}

/// Operations in an order in which each follows those it needs; the last one is the field.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tape {
    constants: Vec<BigRational>,
    operations: Vec<Operation>,
}

impl Tape {
    /// Adds an operation unless it is there already, and returns its place.
    pub fn push(&mut self, operation: Operation) -> Place {
        let known = self.operations.iter().position(|o| *o == operation);
        known.unwrap_or_else(|| {
            self.operations.push(operation);
            self.operations.len() - 1
        })
    }

    /// Adds a constant unless it is there already, and returns its place.
    pub fn push_constant(&mut self, value: BigRational) -> Place {
        let known = self.constants.iter().position(|c| *c == value);
        let index = known.unwrap_or_else(|| {
            self.constants.push(value);
            self.constants.len() - 1
        });
        self.push(Operation::Constant(index))
    }

    pub fn operations(&self) -> &[Operation] {
        &self.operations
    }

    pub fn constants(&self) -> &[BigRational] {
        &self.constants
    }

    /// The field in an arithmetic; `None` for an empty tape. `results` is scratch space.
    #[inline(always)]
    pub fn evaluate<A: Algebra>(
        &self,
        algebra: &A,
        results: &mut Vec<A::Value>,
    ) -> Option<A::Value> {
        results.clear();
        for operation in &self.operations {
            let value = match *operation {
                Operation::Coordinate(axis) => algebra.coordinate(axis),
                Operation::Constant(index) => algebra.constant(index, &self.constants[index]),
                Operation::Unary(function, a) => algebra.unary(function, &results[a]),
                Operation::Binary(function, a, b) => {
                    algebra.binary(function, &results[a], &results[b])
                }
                Operation::WholePower(a, n) => algebra.whole_power(&results[a], n),
            };
            results.push(value);
        }
        results.pop()
    }
}
