//! Affine transforms as 3×4 matrices of f64.

use glam::DVec3;

/// Largest relative error of an entry that products of rounded maps leave: rounded rotations are off by
/// a few 2⁻⁵³ an entry and composed from at most a few dozen.
pub const ROUNDED: f64 = 1e-13;

/// x ↦ M x + t, with the columns of M and t as vectors; the f64 entries are exact by definition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Rows of the 3×4 matrix (m_i0, m_i1, m_i2, t_i).
    pub rows: [[f64; 4]; 3],
}

impl Affine {
    pub const IDENTITY: Self = Self {
        rows: [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ],
    };

    pub fn scale(s: DVec3) -> Self {
        let mut map = Self::IDENTITY;
        (0..3).for_each(|i| map.rows[i][i] = s[i]);
        map
    }

    pub fn translate(t: DVec3) -> Self {
        let mut map = Self::IDENTITY;
        (0..3).for_each(|i| map.rows[i][3] = t[i]);
        map
    }

    /// `self` after `first`: x ↦ self(first(x)). Each entry is one dot product of f64 (the zero
    /// and one entries of elementary transforms make it exact where it can be).
    pub fn after(&self, first: &Self) -> Self {
        let mut rows = [[0.0; 4]; 3];
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = self.rows[i][0] * first.rows[0][j]
                    + self.rows[i][1] * first.rows[1][j]
                    + self.rows[i][2] * first.rows[2][j];
            }
            row[3] += self.rows[i][3];
        }
        Self { rows }
    }

    pub fn point(&self, p: DVec3) -> DVec3 {
        self.vector(p) + self.translation()
    }

    /// Image of a vector (no translation).
    pub fn vector(&self, v: DVec3) -> DVec3 {
        let r = &self.rows;
        DVec3::new(
            r[0][0] * v.x + r[0][1] * v.y + r[0][2] * v.z,
            r[1][0] * v.x + r[1][1] * v.y + r[1][2] * v.z,
            r[2][0] * v.x + r[2][1] * v.y + r[2][2] * v.z,
        )
    }

    /// The magnitudes of the entries.
    pub fn abs(&self) -> Self {
        let rows = self.rows.map(|row| row.map(f64::abs));
        Self { rows }
    }

    pub fn columns(&self) -> [DVec3; 3] {
        let r = &self.rows;
        std::array::from_fn(|j| DVec3::new(r[0][j], r[1][j], r[2][j]))
    }

    pub fn translation(&self) -> DVec3 {
        let r = &self.rows;
        DVec3::new(r[0][3], r[1][3], r[2][3])
    }

    /// Whether the linear part is a rotation or reflection times a scale, up to [`ROUNDED`].
    pub fn is_similarity(&self) -> bool {
        let [a, _, c] = self.columns();
        self.is_right_circular() && same_length(a, c)
    }

    /// Whether the map takes the canonical cylinder to a right circular one, up to [`ROUNDED`].
    pub fn is_right_circular(&self) -> bool {
        let [a, b, c] = self.columns();
        same_length(a, b) && perpendicular(a, b) && perpendicular(b, c) && perpendicular(c, a)
    }
}

/// Whether two vectors are perpendicular up to [`ROUNDED`].
pub fn perpendicular(a: DVec3, b: DVec3) -> bool {
    a.dot(b).abs() <= ROUNDED * a.length() * b.length()
}

fn same_length(a: DVec3, b: DVec3) -> bool {
    (a.length() - b.length()).abs() <= ROUNDED * a.length()
}
