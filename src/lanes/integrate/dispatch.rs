//! Which copies of the loop are compiled: for each number of wavelengths and each precision, one an
//! instruction set.

use crate::integrate::chunk::{Requests, Workspace, render};
use crate::integrate::develop::Spectrometer;
use crate::integrate::model::Model;
use crate::math::instructions::{Instructions, Job};
use crate::math::lanes::{Lanes, Scalar};
use crate::math::twice::Twice;

/// A scalar in which paths of C wavelengths run, on every instruction set.
pub trait Runs<const C: usize>: Scalar {
    /// Renders a chunk of requested samples on the given instruction set.
    fn chunk(
        instructions: Instructions,
        scene: &(Model<Self>, Spectrometer<Self>),
        requests: &Requests,
        workspace: &mut Workspace<Self, C>,
    );
}

macro_rules! runs {
    ($scalar:ty, $wavelengths:literal) => {
        impl Runs<$wavelengths> for $scalar {
            fn chunk(
                instructions: Instructions,
                scene: &(Model<Self>, Spectrometer<Self>),
                requests: &Requests,
                workspace: &mut Workspace<Self, $wavelengths>,
            ) {
                instructions.run(Chunk {
                    scene,
                    requests,
                    workspace,
                });
            }
        }
    };
}

runs!(f32, 4);
runs!(f32, 8);
runs!(f64, 4);
runs!(f64, 8);

/// A chunk to be rendered.
struct Chunk<'a, T: Scalar, const C: usize> {
    scene: &'a (Model<T>, Spectrometer<T>),
    requests: &'a Requests,
    workspace: &'a mut Workspace<T, C>,
}

impl<T: Scalar, const C: usize> Job<T> for Chunk<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<Scalar = T>>(self, lanes: L) {
        let (model, spectrometer) = self.scene;
        render(lanes, model, spectrometer, self.requests, self.workspace);
    }

    #[inline(always)]
    fn run_amid_registers<L: Lanes<Scalar = T>>(self, lanes: L) {
        self.run(Twice(lanes));
    }
}
