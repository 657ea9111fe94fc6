//! Affine transforms as 3×4 matrices of f64.

use glam::DVec3;

/// x ↦ M x + t, with the columns of M and t as vectors; the f64 entries are exact by definition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Rows of the 3×4 matrix (m_i0, m_i1, m_i2, t_i).
    pub rows: [[f64; 4]; 3],
}

impl Affine {
    /// The identity.
    pub const IDENTITY: Self = Self {
        rows: [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ],
    };

    /// Scaling along the axes.
    pub fn scale(s: DVec3) -> Self {
        Self {
            rows: [
                [s.x, 0.0, 0.0, 0.0],
                [0.0, s.y, 0.0, 0.0],
                [0.0, 0.0, s.z, 0.0],
            ],
        }
    }

    /// Translation.
    pub fn translate(t: DVec3) -> Self {
        Self {
            rows: [
                [1.0, 0.0, 0.0, t.x],
                [0.0, 1.0, 0.0, t.y],
                [0.0, 0.0, 1.0, t.z],
            ],
        }
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

    /// Image of a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.vector(p) + DVec3::new(self.rows[0][3], self.rows[1][3], self.rows[2][3])
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
}
