//! Gaps between objects that bounding boxes do not show: parallel faces, and round walls about one
//! axis or centre.

use glam::DMat3;

use crate::math::affine::{Affine, ROUNDED};
use crate::shape::ShapeKind;

fn linear(map: &Affine) -> DMat3 {
    let [x, y, z] = map.columns();
    DMat3::from_cols(x, y, z)
}

/// The smallest positive distance between two parallel faces, or two round walls of one kind that share
/// their axis or centre; infinite where there are none. Faces count wherever they lie in their planes.
pub fn gap(a: (ShapeKind, &Affine), b: (ShapeKind, &Affine)) -> f64 {
    let inverse = linear(a.1).inverse();
    // b's canonical coordinates in a's.
    let (between, shift) = (
        inverse * linear(b.1),
        inverse * (b.1.translation() - a.1.translation()),
    );
    let mut smallest = f64::INFINITY;
    let mut take = |local: f64, axis: usize| {
        // What composed maps may round is contact.
        let scale = 1.0 + shift.abs().max_element() + between.row(axis).abs().max_element();
        if local.abs() > ROUNDED * scale {
            smallest = smallest.min(local.abs() / inverse.row(axis).length());
        }
    };
    for (axis, places) in a.0.faces() {
        let row = between.row(*axis).to_array();
        for (other, others) in b.0.faces() {
            let size: f64 = row.iter().map(|x| x.abs()).sum();
            if row[*other].abs() < size * (1.0 - ROUNDED) {
                continue;
            }
            for p in *places {
                for q in *others {
                    take(row[*other] * q + shift[*axis] - p, *axis);
                }
            }
        }
    }
    if let Some(count) = a.0.round().filter(|count| b.0.round() == Some(*count)) {
        let columns = [between.x_axis, between.y_axis, between.z_axis];
        let lengths = columns.map(|column| column.length());
        let alike = (0..count).all(|i| {
            let even = (lengths[i] - lengths[0]).abs() <= ROUNDED * lengths[0];
            let square =
                (0..i).all(|j| columns[i].dot(columns[j]).abs() <= ROUNDED * lengths[0].powi(2));
            even && square && shift[i].abs() <= ROUNDED * (1.0 + lengths[0])
        });
        // The axis itself is kept.
        let upright =
            count == 3 || columns[2].x.abs().max(columns[2].y.abs()) <= ROUNDED * lengths[2];
        if alike && upright {
            (0..count).for_each(|axis| take(lengths[0] - 1.0, axis));
        }
    }
    smallest
}
