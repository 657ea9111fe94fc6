//! One path of a render, followed again.

use crate::integrate::chunk::{Request, Requests, Workspace};
use crate::integrate::develop::Spectrometer;
use crate::integrate::dispatch::Runs;
use crate::integrate::model::Model;
use crate::integrate::replay::Replayed;
use crate::math::instructions::Instructions;
use crate::math::lanes::Scalar;
use crate::plan::{Plan, Tables};
use crate::spectrum::grid::{CELLS, WavelengthGrid};

/// Takes one sample and records its path; the bits are those of a render with the same plan.
pub fn replay(plan: &Plan, level: Instructions, request: Request) -> Replayed {
    match (&plan.tables, plan.choices.wavelengths) {
        (Tables::Single(scene), 4) => one::<f32, 4>(scene, &plan.grid, level, request),
        (Tables::Single(scene), _) => one::<f32, 8>(scene, &plan.grid, level, request),
        (Tables::Double(scene), 4) => one::<f64, 4>(scene, &plan.grid, level, request),
        (Tables::Double(scene), _) => one::<f64, 8>(scene, &plan.grid, level, request),
    }
}

fn one<T: Runs<C>, const C: usize>(
    scene: &(Model<T>, Spectrometer<T>),
    grid: &WavelengthGrid,
    level: Instructions,
    request: Request,
) -> Replayed {
    let mut workspace = Workspace::<T, C>::default();
    workspace.trace = Some(Vec::new());
    let mut requests = Requests::default();
    requests.push(request.x, request.y, request.sample, request.sample + 1);
    T::chunk(level, scene, &requests, &mut workspace);
    let rows = &workspace.rows;
    let wavelengths = (0..C).map(|j| {
        let cell = (j * (CELLS / C)) as f64 + f64::from(rows.row[0]) + rows.fraction[0].to_f64();
        grid.wavelength(cell / CELLS as f64)
    });
    Replayed {
        wavelengths: wavelengths.collect(),
        hero: rows.hero[0] as usize,
        vertices: workspace.trace.take().unwrap_or_default(),
        tristimulus: workspace.tristimulus[0].map(Scalar::to_f64),
    }
}
