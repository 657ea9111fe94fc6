//! Where an object is seen closest.

use glam::DVec3;

use super::Site;

/// A lower bound on the distance of a point, `from`, from the object's surface, scene units; 0 for
/// implicit surfaces whose box it is in. Exact for planes and balls, and for boxes along the axes.
pub fn nearest(site: &Site, from: DVec3) -> f64 {
    let outside = site.bounds.map_or(0.0, |b| {
        (b.low - from).max(from - b.high).max(DVec3::ZERO).length()
    });
    let local = site.inverse.point(from);
    outside
        .max(beside(site, local))
        .max(to_surface(site, local))
}

/// The distance of a canonical point from the farthest of the three slabs between opposite faces of the
/// canonical box.
fn beside(site: &Site, from: DVec3) -> f64 {
    let Some([low, high]) = site.corners else {
        return 0.0;
    };
    let apart = (from - high).max(low - from).to_array();
    let slabs = apart.iter().zip(rows(site));
    slabs
        .map(|(apart, row)| apart / row.length())
        .fold(0.0, f64::max)
}

/// The distance of a canonical point from the nearest of the planes and round walls that the surface is made of,
/// wherever these end.
fn to_surface(site: &Site, from: DVec3) -> f64 {
    let Some(kind) = site.kind else {
        return 0.0;
    };
    let rows = rows(site);
    let faces = kind.faces().iter().flat_map(|(axis, places)| {
        let distance = move |place: &f64| (from[*axis] - place).abs() / rows[*axis].length();
        places.iter().map(distance)
    });
    let wall = kind.round().map(|count| {
        let axes = &from.to_array()[..count];
        let from_axis = axes.iter().map(|x| x * x).sum::<f64>().sqrt();
        (from_axis - 1.0).abs() / largest_stretch(&rows[..count])
    });
    faces.chain(wall).fold(f64::INFINITY, f64::min)
}

/// The linear part of the map to canonical coordinates, by row.
fn rows(site: &Site) -> [DVec3; 3] {
    site.inverse.rows.map(|row| DVec3::from_slice(&row[..3]))
}

/// An upper bound on what a matrix A of these rows multiplies a length by: the square root of the
/// largest row sum of |A Aᵀ|, which no eigenvalue exceeds; exact for perpendicular rows.
fn largest_stretch(rows: &[DVec3]) -> f64 {
    let row_sum = |a: &DVec3| rows.iter().map(|b| a.dot(*b).abs()).sum::<f64>();
    rows.iter().map(row_sum).fold(0.0, f64::max).sqrt()
}
