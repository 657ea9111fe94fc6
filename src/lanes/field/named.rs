//! Surfaces that have names.

use super::expression::{Expression, ExpressionError, Parameter, parse};

/// A named surface: its field (negative inside), its parameters, its usual clip box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedSurface {
    pub name: &'static str,
    pub expression: &'static str,
    /// Parameters with their usual values, as decimals.
    pub parameters: &'static [(&'static str, &'static str)],
    /// Half the side of the usual clip box, a cube about the origin.
    pub half_width: f64,
    /// Author and year.
    pub source: &'static str,
}

pub const SURFACES: &[NamedSurface] = &[
    NamedSurface {
        name: "heart",
        expression: "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3",
        parameters: &[],
        half_width: 1.5,
        source: "Taubin 1993",
    },
    NamedSurface {
        name: "mitchell",
        expression: "4*(x^4 + (y^2 + z^2)^2) + 17*x^2*(y^2 + z^2) - 20*(x^2 + y^2 + z^2) + 17",
        parameters: &[],
        half_width: 3.0,
        source: "Mitchell 1990",
    },
    NamedSurface {
        name: "torus",
        expression: "(x^2 + y^2 + z^2 + major^2 - minor^2)^2 - 4*major^2*(x^2 + y^2)",
        parameters: &[("major", "1"), ("minor", "0.25")],
        half_width: 2.0,
        source: "around the z axis; classical",
    },
    NamedSurface {
        name: "goursat",
        expression: "a*(x^4 + y^4 + z^4) - b*(x^2 + y^2 + z^2) + c",
        parameters: &[("a", "5"), ("b", "25"), ("c", "59")],
        half_width: 3.0,
        source: "Goursat 1887, quartics with the symmetry of the cube",
    },
    NamedSurface {
        name: "cassini",
        expression: "((x - a)^2 + y^2 + z^2)*((x + a)^2 + y^2 + z^2) - b^4",
        parameters: &[("a", "1"), ("b", "1")],
        half_width: 2.0,
        source: "Cassini's oval (1693) turned about the x axis; a = b is Bernoulli's lemniscate",
    },
    NamedSurface {
        name: "steiner",
        expression: "x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z",
        parameters: &[],
        half_width: 1.0,
        source: "Steiner 1844, the Roman surface",
    },
    NamedSurface {
        name: "barth6",
        expression: "4*(T^2*x^2 - y^2)*(T^2*y^2 - z^2)*(T^2*z^2 - x^2) \
                     - (1 + 2*T)*(x^2 + y^2 + z^2 - 1)^2",
        // The golden ratio rounded to f64, so that the field is an exact polynomial over the
        // rationals; its nodes open or close by about 1e-16.
        parameters: &[("T", "1.6180339887498949025257388711906969547271728515625")],
        half_width: 2.0,
        source: "Barth 1996, sextic with 65 nodes",
    },
    NamedSurface {
        name: "kummer",
        expression: "x^4 + y^4 + z^4 - x^2 - y^2 - z^2 - x^2*y^2 - y^2*z^2 - z^2*x^2 + 1",
        parameters: &[],
        half_width: 2.0,
        source: "Kummer 1864, quartic with 16 nodes",
    },
    NamedSurface {
        name: "chmutov",
        expression: "(32*x^6 - 48*x^4 + 18*x^2 - 1) + (32*y^6 - 48*y^4 + 18*y^2 - 1) \
                     + (32*z^6 - 48*z^4 + 18*z^2 - 1) + c",
        parameters: &[("c", "1")],
        half_width: 1.5,
        source: "Chmutov 1992, sums of Chebyshev polynomials, here T6",
    },
    NamedSurface {
        name: "decocube",
        expression: "((x^2 + y^2 - a)^2 + (z^2 - 1)^2)*((y^2 + z^2 - a)^2 + (x^2 - 1)^2)\
                     *((z^2 + x^2 - a)^2 + (y^2 - 1)^2) - b",
        parameters: &[("a", "0.640625"), ("b", "0.01953125")],
        half_width: 2.0,
        source: "known from the collections of ray tracers and surface viewers; circles of radius √a on the faces of a cube",
    },
];

pub fn find(name: &str) -> Option<&'static NamedSurface> {
    SURFACES.iter().find(|surface| surface.name == name)
}

impl NamedSurface {
    /// The field with some parameters set; the others keep their usual values.
    ///
    /// # Errors
    /// [`ExpressionError`] where these values leave no field that depends on the place.
    pub fn field(&self, set: &[Parameter]) -> Result<Expression, ExpressionError> {
        let usual = self.parameters.iter().filter_map(|(name, text)| {
            Some(Parameter {
                name: (*name).to_owned(),
                value: super::expression::rational(text)?,
            })
        });
        // The first of a name counts.
        let all: Vec<Parameter> = set.iter().cloned().chain(usual).collect();
        parse(self.expression, &all)
    }
}
