//! Gradients of tapes by automatic differentiation, forward (Griewank and Walther 2008, ch. 3).
//!
//! Any arithmetic that can evaluate a tape and tell a sign can carry the three derivatives along.
//! A derivative that is zero by construction is not carried at all, so that it costs nothing and
//! never meets the infinite slope of some function at a constant.

use num_rational::BigRational;

use super::tape::{Algebra, Binary, Unary};

/// What an arithmetic needs besides, for derivatives.
pub trait Differentiable: Algebra {
    /// A number that is exact in f64.
    fn number(&self, x: f64) -> Self::Value;
    /// `below` where s < 0, `above` elsewhere.
    fn where_negative(
        &self,
        s: &Self::Value,
        below: &Self::Value,
        above: &Self::Value,
    ) -> Self::Value;
}

/// Values with their derivatives along x, y and z.
pub struct Gradients<'a, A>(pub &'a A);

/// A value and its derivatives; `None` is zero wherever the point is.
#[derive(Debug, Clone, PartialEq)]
pub struct WithGradient<V> {
    pub value: V,
    pub gradient: [Option<V>; 3],
}

/// Three values by index, inlined as the standard library's maps are not sure to be.
#[inline(always)]
fn three<R>(f: impl Fn(usize) -> R) -> [R; 3] {
    [f(0), f(1), f(2)]
}

impl<A: Differentiable> Gradients<'_, A> {
    methods! {
        fn product(&self, a: &A::Value, b: &A::Value) -> A::Value =
            self.0.binary(Binary::Product, a, b);
        fn quotient(&self, a: &A::Value, b: &A::Value) -> A::Value =
            self.0.binary(Binary::Quotient, a, b);
        fn sum(&self, a: &A::Value, b: &A::Value) -> A::Value = self.0.binary(Binary::Sum, a, b);
        fn difference(&self, a: &A::Value, b: &A::Value) -> A::Value =
            self.0.binary(Binary::Difference, a, b);
        fn negative(&self, a: &A::Value) -> A::Value = self.0.unary(Unary::Negative, a);
        fn root(&self, a: &A::Value) -> A::Value = self.0.unary(Unary::SquareRoot, a);
    }

    /// The slope of f at a, where f(a) = `value` (all but the sign of |a|).
    #[inline(always)]
    fn slope(&self, function: Unary, a: &A::Value, value: &A::Value) -> A::Value {
        let one = || self.0.number(1.0);
        let reciprocal = |x: &A::Value| self.quotient(&one(), x);
        let square = |x: &A::Value| self.product(x, x);
        let below_unit = || self.root(&self.difference(&one(), &square(a)));
        match function {
            Unary::Negative => self.0.number(-1.0),
            Unary::SquareRoot => reciprocal(&self.sum(value, value)),
            Unary::Absolute => self.0.where_negative(a, &self.0.number(-1.0), &one()),
            Unary::Exponential => value.clone(),
            Unary::Logarithm => reciprocal(a),
            Unary::Sine => self.0.unary(Unary::Cosine, a),
            Unary::Cosine => self.negative(&self.0.unary(Unary::Sine, a)),
            Unary::Tangent => self.sum(&one(), &square(value)),
            Unary::ArcSine => reciprocal(&below_unit()),
            Unary::ArcCosine => self.negative(&reciprocal(&below_unit())),
            Unary::ArcTangent => reciprocal(&self.sum(&one(), &square(a))),
            Unary::HyperbolicSine => self.0.unary(Unary::HyperbolicCosine, a),
            Unary::HyperbolicCosine => self.0.unary(Unary::HyperbolicSine, a),
            Unary::HyperbolicTangent => self.difference(&one(), &square(value)),
        }
    }

    /// p·da, where it is there.
    #[expect(
        clippy::manual_map,
        reason = "what calculates in lanes must be inlined, and map is not sure to be"
    )]
    #[inline(always)]
    fn all(
        &self,
        a: &WithGradient<A::Value>,
        p: impl Fn(&A::Value) -> A::Value,
    ) -> [Option<A::Value>; 3] {
        three(inlined!(|i: usize| match &a.gradient[i] {
            Some(da) => Some(p(da)),
            None => None,
        }))
    }

    /// p·da + q·db, each only where it is there.
    #[inline(always)]
    fn combined(
        &self,
        a: &WithGradient<A::Value>,
        b: &WithGradient<A::Value>,
        p: impl Fn(&A::Value) -> A::Value,
        q: impl Fn(&A::Value) -> A::Value,
    ) -> [Option<A::Value>; 3] {
        three(inlined!(
            |i: usize| match (&a.gradient[i], &b.gradient[i]) {
                (None, None) => None,
                (Some(da), None) => Some(p(da)),
                (None, Some(db)) => Some(q(db)),
                (Some(da), Some(db)) => Some(self.sum(&p(da), &q(db))),
            }
        ))
    }

    #[inline(always)]
    fn chosen(
        &self,
        s: &A::Value,
        below: &WithGradient<A::Value>,
        above: &WithGradient<A::Value>,
    ) -> [Option<A::Value>; 3] {
        three(inlined!(|i: usize| {
            let (below, above) = (&below.gradient[i], &above.gradient[i]);
            let zero = || self.0.number(0.0);
            (below.is_some() || above.is_some()).then(|| {
                let part = |x: &Option<A::Value>| x.clone().unwrap_or_else(zero);
                self.0.where_negative(s, &part(below), &part(above))
            })
        }))
    }
}

impl<A: Differentiable> Algebra for Gradients<'_, A> {
    type Value = WithGradient<A::Value>;

    #[inline(always)]
    fn coordinate(&self, axis: usize) -> Self::Value {
        let gradient = three(inlined!(|i: usize| (i == axis).then(|| self.0.number(1.0))));
        WithGradient {
            value: self.0.coordinate(axis),
            gradient,
        }
    }

    #[inline(always)]
    fn constant(&self, index: usize, exact: &BigRational) -> Self::Value {
        WithGradient {
            value: self.0.constant(index, exact),
            gradient: [None, None, None],
        }
    }

    #[inline(always)]
    fn unary(&self, function: Unary, a: &Self::Value) -> Self::Value {
        let value = self.0.unary(function, &a.value);
        let gradient = if function == Unary::Negative {
            self.all(a, inlined!(|d: &A::Value| self.negative(d)))
        } else if a.gradient.iter().all(Option::is_none) {
            [None, None, None]
        } else {
            let slope = self.slope(function, &a.value, &value);
            self.all(a, inlined!(|d: &A::Value| self.product(&slope, d)))
        };
        WithGradient { value, gradient }
    }

    #[inline(always)]
    fn binary(&self, function: Binary, a: &Self::Value, b: &Self::Value) -> Self::Value {
        let (x, y) = (&a.value, &b.value);
        let value = self.0.binary(function, x, y);
        // p·da + q·db, with p and q given as functions of da and db.
        macro_rules! combined {
            (|$da:ident| $p:expr, |$db:ident| $q:expr) => {{
                let p = inlined!(|$da: &A::Value| $p);
                self.combined(a, b, p, inlined!(|$db: &A::Value| $q))
            }};
        }
        let gradient = match function {
            Binary::Sum => combined!(|da| da.clone(), |db| db.clone()),
            Binary::Difference => combined!(|da| da.clone(), |db| self.negative(db)),
            Binary::Product => combined!(|da| self.product(da, y), |db| self.product(db, x)),
            Binary::Quotient => combined!(|da| self.quotient(da, y), |db| self
                .negative(&self.quotient(&self.product(&value, db), y))),
            Binary::Minimum => self.chosen(&self.difference(x, y), a, b),
            Binary::Maximum => self.chosen(&self.difference(x, y), b, a),
            // a is the ordinate: d atan2(a, b) = (b da − a db)/(a² + b²).
            Binary::ArcTangent2 => {
                let square = self.sum(&self.product(x, x), &self.product(y, y));
                combined!(|da| self.quotient(&self.product(y, da), &square), |db| self
                    .negative(&self.quotient(&self.product(x, db), &square)))
            }
            // d aᵇ = aᵇ (b/a da + ln a db).
            Binary::Power => {
                let part = inlined!(|d: &A::Value| self.product(&value, d));
                combined!(|da| part(&self.quotient(&self.product(y, da), x)), |db| {
                    part(&self.product(&self.0.unary(Unary::Logarithm, x), db))
                })
            }
        };
        WithGradient { value, gradient }
    }

    #[inline(always)]
    fn whole_power(&self, a: &Self::Value, n: i32) -> Self::Value {
        let value = self.0.whole_power(&a.value, n);
        let below = match n {
            2 => a.value.clone(),
            _ => self.0.whole_power(&a.value, n - 1),
        };
        let slope = self.product(&self.0.number(f64::from(n)), &below);
        let gradient = self.all(a, inlined!(|d: &A::Value| self.product(&slope, d)));
        WithGradient { value, gradient }
    }
}
