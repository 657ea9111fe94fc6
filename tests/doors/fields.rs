//! Fields of implicit surfaces.

use etalon_lanes::field::evaluate::{Field, Scratch};
use etalon_lanes::field::tape::Tape;
use etalon_lanes::math::instructions::{Instructions, Precision};
use etalon_lanes::math::lanes::Lanes;
use etalon_lanes::math::vec3::Vec3;

use crate::columns::{Columns, Kernel};

/// A field's values and the three components of its gradient, by columns of coordinates.
pub fn values_and_gradients(
    set: Instructions,
    precision: Precision,
    tape: &Tape,
    points: [&[f64]; 3],
) -> [Vec<f64>; 4] {
    let job = Columns {
        kernel: Evaluation(tape),
        input: points,
    };
    set.run_in(precision, job)
}

struct Evaluation<'a>(&'a Tape);

impl Kernel<3, 4> for Evaluation<'_> {
    #[inline(always)]
    fn apply<L: Lanes>(&self, l: L, [x, y, z]: [L::Real; 3]) -> [L::Real; 4] {
        let field = Field::<L::Scalar>::new(self.0);
        let p = Vec3::new(x, y, z);
        let [value] = field.values(l, [p], &mut Scratch::default());
        let gradient = field.with_gradient(l, p).1;
        [value, gradient.x, gradient.y, gradient.z]
    }
}
